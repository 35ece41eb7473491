#include "tools/operator/assembly_plan.h"

#include <algorithm>
#include <limits>
#include <queue>

namespace coach {
namespace {

constexpr size_t kMaxTriangles = 4000;    // of a part's mesh in the plan
constexpr int kContactSamples = 400;      // points of a surface that look for the place of contact
constexpr double kContactMargin = 0.003;  // m beyond the closest pair that still counts as contact
constexpr double kGap = 0.03;             // m between structures that nothing joins
constexpr double kPixels = 600;           // resolution of the outlines across the whole plan

struct Box {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::max());
  Vector3 high = Vector3::Constant(std::numeric_limits<double>::lowest());
  void Include(const Vector3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

const TriangleMesh& MeshOf(const Task& task, size_t slot) {
  return task.types[static_cast<size_t>(task.slots[slot].type)].mesh;
}

/// Walks the connections from one slot, with that slot's part at the origin. @return the slots reached.
std::vector<size_t> Walk(const Task& task, const std::vector<int>& connections, size_t start, std::vector<Pose>& poses,
                         std::vector<bool>& placed) {
  std::vector<size_t> reached{start};
  placed[start] = true;
  for (size_t k = 0; k < reached.size(); ++k) {
    for (const int index : connections) {
      const auto& connection = task.connections[static_cast<size_t>(index)];
      const auto a = static_cast<size_t>(connection.slot_a), b = static_cast<size_t>(connection.slot_b);
      if (a == reached[k] && !placed[b]) {
        poses[b] = poses[a] * connection.X_AB;
        placed[b] = true;
        reached.push_back(b);
      } else if (b == reached[k] && !placed[a]) {
        poses[a] = poses[b] * connection.X_AB.inverse();
        placed[a] = true;
        reached.push_back(a);
      }
    }
  }
  return reached;
}

/// Rotation that brings the flattest axis to z and the longest to x.
Matrix3 FlatView(const Vector3& extent) {
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return extent[a] > extent[b] + 1e-6; });
  Matrix3 R = Matrix3::Zero();
  for (int row = 0; row < 3; ++row) R(row, order[static_cast<size_t>(row)]) = 1;
  if (R.determinant() < 0) R.row(1) *= -1;
  return R;
}

Vector3 PlaceOfContact(const TriangleMesh& mesh_a, const Pose& X_FA, const TriangleMesh& mesh_b, const Pose& X_FB) {
  const auto a = SampleSurface(mesh_a, kContactSamples), b = SampleSurface(mesh_b, kContactSamples);
  struct Pair {
    double distance;
    Vector3 middle;
  };
  std::vector<Pair> pairs;
  double closest = std::numeric_limits<double>::max();
  for (const auto& point_a : a) {
    const Vector3 p = X_FA * point_a.p;
    Pair best{std::numeric_limits<double>::max(), p};
    for (const auto& point_b : b) {
      const Vector3 q = X_FB * point_b.p;
      const double distance = (p - q).norm();
      if (distance < best.distance) best = {distance, 0.5 * (p + q)};
    }
    pairs.push_back(best);
    closest = std::min(closest, best.distance);
  }
  Vector3 sum = Vector3::Zero();
  int count = 0;
  for (const auto& pair : pairs) {
    if (pair.distance > closest + kContactMargin) continue;
    sum += pair.middle;
    ++count;
  }
  return sum / std::max(count, 1);
}

}  // namespace

std::vector<Pose> SlotPoses(const Task& task, const std::vector<int>& connections) {
  std::vector<Pose> poses(task.slots.size(), Pose::Identity());
  std::vector<bool> placed(task.slots.size(), false);
  double right = 0;  // m; where the next structure begins
  for (size_t slot = 0; slot < task.slots.size(); ++slot) {
    if (placed[slot]) continue;
    const auto structure = Walk(task, connections, slot, poses, placed);
    Box box;
    for (const size_t s : structure) {
      for (const auto& p : MeshOf(task, s).vertices) box.Include(poses[s] * p);
    }
    const Eigen::Translation3d move(right - box.low.x(), 0, 0);
    for (const size_t s : structure) poses[s] = move * poses[s];
    right += box.high.x() - box.low.x() + kGap;
  }
  return poses;
}

AssemblyPlan PlanOf(const Task& task, const std::vector<int>& connections) {
  AssemblyPlan plan;
  if (task.slots.empty()) return plan;
  std::vector<Pose> poses = SlotPoses(task, connections);
  Box box;
  for (size_t s = 0; s < poses.size(); ++s) {
    for (const auto& p : MeshOf(task, s).vertices) box.Include(poses[s] * p);
  }
  const Pose X_VF = MakePose(FlatView(box.high - box.low), Vector3::Zero());
  Box view;
  for (size_t s = 0; s < poses.size(); ++s) {
    poses[s] = X_VF * poses[s];
    for (const auto& p : MeshOf(task, s).vertices) view.Include(poses[s] * p);
  }
  const Vector3 size = view.high - view.low;
  plan.width = size.x() * 1000;
  plan.height = size.y() * 1000;
  const auto on_plan = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2f(static_cast<float>((p.x() - view.low.x()) * 1000),
                           static_cast<float>((view.high.y() - p.y()) * 1000));
  };
  for (size_t s = 0; s < poses.size(); ++s) {
    const TriangleMesh mesh = Simplified(MeshOf(task, s), kMaxTriangles);
    AssemblyPlan::SlotShape shape;
    shape.outlines = SilhouetteFromAbove(mesh, poses[s], std::max(size.x(), size.y()) / kPixels);
    for (auto& polygon : shape.outlines) {
      for (auto& p : polygon) p = on_plan(p.cast<double>());
    }
    const Vector3 centre = poses[s] * Extent(mesh).centre;
    shape.label = on_plan(centre.head<2>());
    shape.height = centre.z() * 1000;
    plan.slots.push_back(std::move(shape));
  }
  for (const int index : connections) {
    const auto& connection = task.connections[static_cast<size_t>(index)];
    const auto a = static_cast<size_t>(connection.slot_a), b = static_cast<size_t>(connection.slot_b);
    const Vector3 place = PlaceOfContact(MeshOf(task, a), poses[a], MeshOf(task, b), poses[b]);
    plan.joints.push_back({index, on_plan(place.head<2>())});
  }
  return plan;
}

}  // namespace coach
