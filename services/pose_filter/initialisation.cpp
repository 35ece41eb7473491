#include "services/pose_filter/initialisation.h"

#include <omp.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/Registration.h>
#include <open3d/utility/Logging.h>
#include <open3d/utility/Random.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace coach {
namespace {

/// Chance of occlusion at a pixel when nothing is known.
constexpr float kOcclusion = 0.1F;

/// Open3D adds up in the order in which threads finish; one thread has one order.
class OneThread {
 public:
  OneThread() : threads_(omp_get_max_threads()) {
    omp_set_num_threads(1);
    open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);
  }
  ~OneThread() { omp_set_num_threads(threads_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int threads_;
};

/// The largest plane, its normal towards the camera.
std::optional<Plane> LargestPlane(const open3d::geometry::PointCloud& cloud, uint64_t seed,
                                  const InitialisationOptions& options) {
  if (cloud.points_.size() < 100) return std::nullopt;
  open3d::utility::random::Seed(static_cast<int>(seed & 0x7fffffff));
  const auto [plane, inliers] = cloud.SegmentPlane(options.plane_distance, 3, options.plane_iterations);
  if (static_cast<double>(inliers.size()) < options.least_table * static_cast<double>(cloud.points_.size())) {
    return std::nullopt;
  }
  // Least squares over the inliers.
  Vector3 mean = Vector3::Zero();
  for (const size_t i : inliers) mean += cloud.points_[i];
  mean /= static_cast<double>(inliers.size());
  Matrix3 scatter = Matrix3::Zero();
  for (const size_t i : inliers) scatter += (cloud.points_[i] - mean) * (cloud.points_[i] - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(scatter);
  Plane result{solver.eigenvectors().col(0), -solver.eigenvectors().col(0).dot(mean)};
  if (result.d < 0) result = {-result.n, -result.d};
  return result;
}

/// Every n-th, so that at most `most` are left.
std::vector<Vector3> Thin(const std::vector<Vector3>& points, int most) {
  const size_t stride = (points.size() + static_cast<size_t>(most) - 1) / static_cast<size_t>(most);
  std::vector<Vector3> result;
  for (size_t i = 0; i < points.size(); i += std::max<size_t>(1, stride)) result.push_back(points[i]);
  return result;
}

/// Uniform over SO(3).
Matrix3 RandomRotation(Random& random) {
  Eigen::Quaterniond q;
  do {
    q.coeffs() << random.Normal(), random.Normal(), random.Normal(), random.Normal();
  } while (q.norm() < 1e-6);
  return q.normalized().matrix();
}

}  // namespace

SceneClusters FindClusters(const cv::Mat& depth, double metres_per_unit, const CameraModel& camera, uint64_t seed,
                           const InitialisationOptions& options) {
  SceneClusters result;
  if (depth.empty()) return result;
  const OneThread one_thread;
  open3d::geometry::PointCloud all, above;
  std::vector<Eigen::Vector2i> pixels;
  for (int y = 0; y < depth.rows; y += options.step) {
    for (int x = 0; x < depth.cols; x += options.step) {
      const double z = depth.at<uint16_t>(y, x) * metres_per_unit;
      if (z < kNearPlane || z > options.farthest) continue;
      all.points_.push_back(camera.BackProject({x, y}, z));
      pixels.emplace_back(x, y);
    }
  }
  result.table = LargestPlane(all, seed, options);
  for (size_t i = 0; i < all.points_.size(); ++i) {
    if (result.table) {
      const double height = result.table->Height(all.points_[i]);
      if (height < options.lowest || height > options.highest) continue;
    }
    above.points_.push_back(all.points_[i]);
    result.pixels.push_back(pixels[i]);
  }
  result.points = above.points_;
  if (!above.points_.empty()) {
    result.cluster = above.ClusterDBSCAN(options.cluster_distance, static_cast<size_t>(options.cluster_neighbours));
  }
  for (const int c : result.cluster) result.num_clusters = std::max(result.num_clusters, c + 1);
  return result;
}

std::vector<Vector3> PointsOfRegion(const SceneClusters& clusters, const Detections& detections, const Region& region,
                                    const InitialisationOptions& options) {
  const auto coloured = [&](size_t i) {
    const Eigen::Vector2i& p = clusters.pixels[i];
    if (p.x() < region.box[0] || p.y() < region.box[1] || p.x() >= region.box[0] + region.box[2] ||
        p.y() >= region.box[1] + region.box[3]) {
      return false;
    }
    const auto at = static_cast<size_t>(p.y()) * static_cast<size_t>(detections.width) + static_cast<size_t>(p.x());
    return at >= detections.class_map.size() || (detections.class_map[at] >> region.colour_class & 1) != 0;
  };
  std::vector<int> votes(static_cast<size_t>(clusters.num_clusters));
  for (size_t i = 0; i < clusters.points.size(); ++i) {
    if (clusters.cluster[i] >= 0 && coloured(i)) ++votes[static_cast<size_t>(clusters.cluster[i])];
  }
  const auto most = std::max_element(votes.begin(), votes.end());
  if (most == votes.end() || *most == 0) return {};
  const int chosen = static_cast<int>(most - votes.begin());
  std::vector<Vector3> whole, own;
  for (size_t i = 0; i < clusters.points.size(); ++i) {
    if (clusters.cluster[i] != chosen) continue;
    whole.push_back(clusters.points[i]);
    if (coloured(i)) own.push_back(clusters.points[i]);
  }
  const auto least = static_cast<size_t>(options.least_points);
  if (own.size() >= least) return own;
  return whole.size() >= least ? whole : std::vector<Vector3>{};
}

std::optional<PoseFit> FitPose(const TriangleMesh& mesh, const RenderMesh& render_mesh,
                               const std::vector<Vector3>& points, const ObservationModel& model,
                               const DepthEvidence& evidence, Random& random, const InitialisationOptions& options) {
  if (points.empty()) return std::nullopt;
  const OneThread one_thread;
  const std::vector<Vector3> thinned = Thin(points, options.icp_points);
  const open3d::geometry::PointCloud seen(thinned);
  open3d::geometry::PointCloud surface;
  for (const SurfacePoint& s : SampleSurface(mesh, options.model_points)) surface.points_.push_back(s.p);
  Vector3 middle = Vector3::Zero();
  for (const Vector3& p : thinned) middle += p / static_cast<double>(thinned.size());
  const MeshExtent extent = Extent(mesh);
  // What is seen is the near side; the part's centre lies behind it.
  const Vector3 centre = middle + 0.25 * (extent.high - extent.low).minCoeff() * middle.normalized();

  namespace registration = open3d::pipelines::registration;
  const registration::ICPConvergenceCriteria criteria(1e-5, 1e-5, options.icp_iterations);
  std::optional<PoseFit> best;
  RenderedDepth tile;
  for (int k = 0; k < options.candidates; ++k) {
    const Matrix3 R_CP = RandomRotation(random);
    const Pose X_CP = MakePose(R_CP, centre - R_CP * extent.centre);
    const auto found =
        registration::RegistrationICP(seen, surface, options.icp_distance, X_CP.inverse().matrix(),
                                      registration::TransformationEstimationPointToPoint(false), criteria);
    if (!found.transformation_.allFinite()) continue;
    const Pose refined =
        MakePose(found.transformation_.topLeftCorner<3, 3>(), found.transformation_.topRightCorner<3, 1>()).inverse();
    RenderDepth(render_mesh, evidence.grid, refined, tile);
    const double log_likelihood = model.LogLikelihood(evidence, tile, kOcclusion);
    if (log_likelihood > 0 && (!best || log_likelihood > best->log_likelihood)) best = {refined, log_likelihood};
  }
  return best;
}

}  // namespace coach
