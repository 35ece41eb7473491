#include "tools/simulator/simulator.h"

#include <algorithm>
#include <cmath>

#include "tools/simulator/ray_tracer.h"
#include "tools/simulator/shading.h"

namespace coach {

struct Simulator::State {
  State(Stage s, uint64_t seed)
      : stage(std::move(s)), random(seed), colour(stage.colour, random), depth(stage.depth, stage.camera, random) {}

  Stage stage;
  Random random;
  ColourSensor colour;
  DepthSensor depth;
  RayTracer tracer;
  std::vector<Look> looks;        // by body
  std::vector<int> thing_meshes;  // by part, then prop
  std::vector<int> thing_bodies;
  int skin = -1, clothes = -1, hair = -1;
  Hits hits, infrared_hits;
  std::vector<float> lit;
  cv::Mat linear;
  int64_t sequence = 0;

  void AddThing(const TriangleMesh& mesh, const Material& material) {
    thing_meshes.push_back(tracer.AddMesh(mesh));
    thing_bodies.push_back(tracer.AddBody(thing_meshes.back()));
    looks.push_back({material});
  }
  int AddLimb(const Material& material) {
    looks.push_back({material});
    return tracer.AddLimb();
  }
  void MoveTo(const Performance& performance, double time);
  void FillTruth(const Pose& X_WC, FrameTruth* truth);
};

void Simulator::State::MoveTo(const Performance& performance, double time) {
  for (size_t i = 0; i < thing_bodies.size(); ++i) {
    const Pose X_W = performance.things.At(static_cast<int>(i), time);
    tracer.SetPose(thing_bodies[i], X_W);
    looks[static_cast<size_t>(thing_bodies[i])].X_WB = X_W;
  }
  if (stage.child) {
    const BodySegments body =
        PoseBody(stage.room.body, {performance.HandAt(Side::kLeft, time), performance.HandAt(Side::kRight, time)});
    tracer.SetSegments(skin, body.skin);
    tracer.SetSegments(clothes, body.clothes);
    tracer.SetSegments(hair, body.hair);
  }
  tracer.Commit();
}

void Simulator::State::FillTruth(const Pose& X_WC, FrameTruth* truth) {
  truth->X_WC = X_WC;
  truth->parts.assign(stage.task.parts.size(), {});
  truth->part_at = cv::Mat(stage.camera.height, stage.camera.width, CV_8UC1, cv::Scalar(0));
  std::vector<int> part_of(static_cast<size_t>(tracer.num_bodies()), -1);
  for (size_t i = 0; i < truth->parts.size(); ++i) part_of[static_cast<size_t>(thing_bodies[i])] = static_cast<int>(i);
  for (int y = 0; y < hits.height; ++y) {
    uint8_t* row = truth->part_at.ptr<uint8_t>(y);
    for (int x = 0; x < hits.width; ++x) {
      const int body = hits.body[static_cast<size_t>(y * hits.width + x)];
      const int part = body < 0 ? -1 : part_of[static_cast<size_t>(body)];
      if (part < 0) continue;
      row[x] = static_cast<uint8_t>(part + 1);
      PartTruth& p = truth->parts[static_cast<size_t>(part)];
      auto& box = p.visible_box;  // left, top, right, bottom until the end
      box = p.pixels_visible++ == 0 ? std::array<int, 4>{x, y, x, y}
                                    : std::array<int, 4>{std::min(box[0], x), std::min(box[1], y), std::max(box[2], x),
                                                         std::max(box[3], y)};
    }
  }
  const Pose X_CW = X_WC.inverse();
  for (size_t i = 0; i < truth->parts.size(); ++i) {
    PartTruth& p = truth->parts[i];
    p.X_CP = X_CW * looks[static_cast<size_t>(thing_bodies[i])].X_WB;
    const RayTracer::Silhouette s = tracer.Outline(thing_meshes[i], stage.camera, p.X_CP);
    p.pixels = std::max(s.pixels, p.pixels_visible);
    p.pixels_in_image = std::max(s.pixels_in_image, p.pixels_visible);
    if (s.pixels > 0) p.box = {s.left, s.top, s.right - s.left + 1, s.bottom - s.top + 1};
    if (p.pixels_visible > 0) {
      auto& b = p.visible_box;
      b = {b[0], b[1], b[2] - b[0] + 1, b[3] - b[1] + 1};
    }
  }
}

Simulator::Simulator(Stage stage, uint64_t seed) : state_(std::make_unique<State>(std::move(stage), seed)) {
  State& s = *state_;
  for (size_t i = 0; i < s.stage.task.parts.size(); ++i) {
    s.AddThing(s.stage.task.TypeOf(static_cast<int>(i)).mesh, s.stage.part_materials.at(i));
  }
  for (const Prop& prop : s.stage.props) s.AddThing(prop.mesh, prop.material);
  for (const Fixture& fixture : s.stage.room.fixtures) {
    s.tracer.AddFixture(fixture.mesh, fixture.X_W);
    s.looks.push_back({fixture.material, fixture.X_W});
  }
  if (s.stage.child) {
    s.skin = s.AddLimb(s.stage.room.skin);
    s.clothes = s.AddLimb(s.stage.room.clothes);
    s.hair = s.AddLimb(s.stage.room.hair);
  }
}

Simulator::~Simulator() = default;

const Stage& Simulator::stage() const { return state_->stage; }

Frame Simulator::Render(const Performance& performance, const CameraPath& path, double time, FrameTruth* truth) {
  State& s = *state_;
  s.MoveTo(performance, time);
  const Pose X_WC = path.At(time);
  s.tracer.Trace(s.stage.camera, X_WC, &s.hits);
  s.tracer.Light(s.stage.camera, X_WC, s.hits, s.stage.room.lighting.lamp, s.stage.room.lighting.lamp_size, &s.lit);
  Shade(s.stage.camera, X_WC, s.hits, s.lit, s.stage.room.lighting, s.looks, s.stage.room.patterns, &s.linear);
  Frame frame;
  frame.utime = static_cast<int64_t>(std::llround(1e6 * time));
  frame.sequence = s.sequence++;
  frame.camera = s.stage.camera;
  frame.colour = s.colour.Expose(&s.linear, time, s.random);
  std::vector<double> holes;
  for (const Look& look : s.looks) holes.push_back(look.material.depth_holes);
  const Pose X_WI = X_WC * s.depth.X_CI();
  s.tracer.Trace(s.depth.camera(), X_WI, &s.infrared_hits);
  frame.depth = s.depth.Measure(s.infrared_hits, X_WI.linear(), holes, s.random);
  if (truth) s.FillTruth(X_WC, truth);
  return frame;
}

}  // namespace coach
