// Random content for every struct that travels on the bus. Values that travel as floats are floats.
#pragma once

#include <random>

#include "common/bus/messages.h"

namespace coach::random_domain {

using Random = std::mt19937;

inline int Integer(Random& random, int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); }
inline int64_t Long(Random& random) { return std::uniform_int_distribution<int64_t>(0, int64_t{1} << 60)(random); }
inline double Float(Random& random, double low, double high) {
  return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random));
}
inline bool Coin(Random& random) { return random() % 2; }
inline std::string Text(Random& random, int length) {
  std::string text;
  for (int i = Integer(random, 0, length); i > 0; --i) text += static_cast<char>(Integer(random, 1, 255));
  return text;
}
inline Vector3 FloatVector(Random& random) {
  return {Float(random, -2, 2), Float(random, -2, 2), Float(random, -2, 2)};
}
inline Pose RandomPose(Random& random) {
  Pose X = Pose::Identity();
  X.linear() = ExpRotation(Vector3(FloatVector(random)));
  X.translation() = FloatVector(random);
  return X;
}
inline Matrix6 Covariance(Random& random) {
  Matrix6 m;
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c) m(r, c) = m(c, r) = Float(random, r == c ? 0.5 : -0.05, r == c ? 1 : 0.05);
  return m;
}

inline std::vector<ForeignBlob> Blobs(Random& random) {
  std::vector<ForeignBlob> blobs(static_cast<size_t>(Integer(random, 0, 4)));
  for (ForeignBlob& blob : blobs) blob = {FloatVector(random), Float(random, 0, 1), FloatVector(random)};
  return blobs;
}

inline Detections RandomDetections(Random& random) {
  Detections d;
  d.utime = Long(random);
  d.received_utime = Long(random);
  d.sequence = Long(random);
  d.width = 64;
  d.height = 48;
  d.num_classes = 3;
  for (int i = Integer(random, 0, 20); i > 0; --i) {
    Region region;
    region.colour_class = Integer(random, 0, 2);
    region.candidate_types = static_cast<uint32_t>(random());
    region.area = Integer(random, 0, 64 * 48);
    region.centroid = {static_cast<float>(Float(random, 0, 64)), static_cast<float>(Float(random, 0, 48))};
    region.box = {Integer(random, 0, 30), Integer(random, 0, 20), Integer(random, 0, 34), Integer(random, 0, 28)};
    region.touches_border = Coin(random);
    region.median_depth = static_cast<float>(Float(random, 0, 3));
    d.regions.push_back(region);
  }
  if (Coin(random)) {
    while (d.class_map.size() < 64 * 48)
      d.class_map.insert(d.class_map.end(), std::min<size_t>(64 * 48 - d.class_map.size(), random() % 200),
                         static_cast<uint8_t>(random()));
  }
  return d;
}

inline PartPoses RandomPartPoses(Random& random) {
  PartPoses p;
  p.utime = Long(random);
  p.received_utime = Long(random);
  p.sequence = Long(random);
  p.X_TC = RandomPose(random);
  p.X_TC_covariance = Covariance(random);
  p.table_found = Coin(random);
  p.table_residual = Float(random, 0, 0.01);
  const int n = Integer(random, 2, 8);
  for (int i = 0; i < n; ++i) {
    PartEstimate part;
    part.X_TP = RandomPose(random);
    for (int k = 0; k < 6; ++k) part.velocity[k] = Float(random, -1, 1);
    part.covariance = Covariance(random);
    part.visible_fraction = Float(random, 0, 1);
    part.status = static_cast<PartStatus>(Integer(random, 0, 4));
    part.confidence = Float(random, 0, 1);
    part.ambiguous_with = Integer(random, -1, n - 1);
    part.ambiguous_probability = Float(random, 0, 0.5);
    part.identity_exchange = Integer(random, -1, n - 1);
    p.parts.push_back(part);
  }
  for (int i = Integer(random, 0, 5); i > 0; --i) {
    PairEvidence pair;
    pair.part_a = Integer(random, 0, n - 2);
    pair.part_b = Integer(random, pair.part_a + 1, n - 1);
    pair.X_AB = RandomPose(random);
    pair.covariance = Covariance(random);
    pair.candidate_kind = static_cast<CandidateKind>(Integer(random, 0, 2));
    pair.candidate = Integer(random, -1, 10);
    pair.log_evidence = Float(random, -100, 100);
    pair.pixels = Integer(random, 0, 100'000);
    pair.surface_distance = Float(random, -0.01, 0.03);
    for (size_t k = 0; k < 2; ++k) {
      pair.motion[k] = Float(random, 0, 1);
      pair.relative_motion[k] = Float(random, 0, 1);
      pair.visible_fraction[k] = Float(random, 0, 1);
    }
    pair.constrained = Coin(random);
    p.pairs.push_back(pair);
  }
  p.foreign = Blobs(random);
  return p;
}

inline ConnectionBelief RandomBelief(Random& random) {
  ConnectionBelief belief{Long(random), {}};
  for (int i = Integer(random, 0, 9); i > 0; --i)
    belief.connections.push_back(
        {Integer(random, -9, 9), Integer(random, 0, 5), Integer(random, 0, 5), Float(random, 0, 1)});
  return belief;
}

inline GuidanceEvent RandomEvent(Random& random) {
  GuidanceEvent event;
  event.id = Long(random);
  event.utime = Long(random);
  event.since = Long(random);
  event.kind = Text(random, 10);
  event.subject = Text(random, 20);
  event.part_a = Integer(random, -1, 5);
  event.part_b = Integer(random, -1, 5);
  event.probability = Float(random, 0, 1);
  event.reason = Text(random, 80);
  return event;
}

inline AssemblyState RandomAssemblyState(Random& random) {
  AssemblyState state;
  state.utime = Long(random);
  state.session = Long(random);
  state.task = Text(random, 20);
  state.phase = static_cast<Phase>(Integer(random, 0, 9));
  state.idle_level = Integer(random, 0, 4);
  state.step = Integer(random, -1, 5);
  state.made = Integer(random, 0, 5);
  state.required = Integer(random, 0, 5);
  for (int i = Integer(random, 0, 6); i > 0; --i)
    state.connections.push_back(
        {Coin(random) ? kUnknownContact : Integer(random, -3, 5), Integer(random, -1, 5), Integer(random, -1, 5),
         Float(random, 0, 1), static_cast<ConnectionState::State>(Integer(random, 0, 2)), Long(random), Long(random)});
  for (int i = Integer(random, 0, 8); i > 0; --i) state.events.push_back(RandomEvent(random));
  return state;
}

inline RobotCommand RandomRobotCommand(Random& random) {
  RobotCommand c;
  c.id = Long(random);
  c.station = Text(random, 10);
  c.session = Long(random);
  c.kind = static_cast<ActKind>(Integer(random, 0, 4));
  c.priority = static_cast<Priority>(Integer(random, 0, 5));
  c.text = Text(random, 400);
  c.phrase_key = Text(random, 20);
  c.wording = Integer(random, 0, 9);
  c.language = Text(random, 2);
  if (Coin(random)) c.point_target = FloatVector(random);
  if (Coin(random)) c.look_target = FloatVector(random);
  c.eye_colour = Text(random, 8);
  c.order = static_cast<ActOrder>(Integer(random, 0, 1));
  c.replaces_id = Long(random);
  c.sent_utime = Long(random);
  c.valid_for_us = Long(random);
  for (uint8_t& byte : c.hmac) byte = static_cast<uint8_t>(random());
  return c;
}

inline RobotStatus RandomRobotStatus(Random& random) {
  RobotStatus s;
  s.utime = Long(random);
  s.station = Text(random, 10);
  s.session = Long(random);
  s.command_id = Long(random);
  s.state = static_cast<ActState>(Integer(random, 0, 6));
  s.reason = Text(random, 30);
  s.speaking = Coin(random);
  s.connected = Coin(random);
  s.back_end = Text(random, 10);
  s.language = Text(random, 2);
  s.battery = Float(random, 0, 1);
  s.point_clamped = Coin(random);
  s.gaze_clamped = Coin(random);
  s.help_requests = Long(random);
  return s;
}

inline TableScene RandomTableScene(Random& random) {
  TableScene scene;
  scene.utime = Long(random);
  scene.station = Text(random, 10);
  for (int i = Integer(random, 0, 8); i > 0; --i)
    scene.parts.push_back({Integer(random, 0, 20), RandomPose(random), static_cast<PartStatus>(Integer(random, 0, 4))});
  scene.foreign = Blobs(random);
  return scene;
}

inline OperatorCommand RandomOperatorCommand(Random& random) {
  return {Long(random), Text(random, 10), Long(random), static_cast<OperatorKind>(Integer(random, 0, 13)),
          Text(random, 50)};
}

}  // namespace coach::random_domain
