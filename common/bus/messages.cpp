#include "common/bus/messages.h"

#include <algorithm>

#include "common/bus/message_fields.h"
#include "common/imaging/class_map.h"
#include "common/imaging/image_codec.h"

namespace coach {
namespace {

template <class Message, class Struct>
std::vector<Message> ToMessages(const std::vector<Struct>& items) {
  std::vector<Message> out;
  out.reserve(items.size());
  for (const Struct& item : items) out.push_back(ToMessage(item));
  return out;
}

template <class Count, class Array>
void CheckCount(Count count, const Array& array, int high, const char* field) {
  IndexInRange(count, 0, high, field);
  if (static_cast<size_t>(count) != array.size()) RefuseField(field, std::to_string(count));
}

}  // namespace

// Conversions of what messages are made of.

static region_t ToMessage(const Region& region) {
  region_t m;
  m.colour_class = static_cast<int16_t>(region.colour_class);
  m.candidate_types = static_cast<int32_t>(region.candidate_types);
  m.area = region.area;
  m.centroid[0] = region.centroid.x();
  m.centroid[1] = region.centroid.y();
  std::copy(region.box.begin(), region.box.end(), m.box);
  m.touches_border = region.touches_border;
  m.median_depth = region.median_depth;
  return m;
}

static Region RegionFromMessage(const region_t& m, const detections_t& frame) {
  Region region;
  region.colour_class = IndexInRange(m.colour_class, 0, frame.num_classes - 1, "region.colour_class");
  region.candidate_types = static_cast<uint32_t>(m.candidate_types);
  region.area = IndexInRange(m.area, 0, frame.width * frame.height, "region.area");
  region.centroid = {static_cast<float>(InRange(m.centroid[0], 0, frame.width, "region.centroid")),
                     static_cast<float>(InRange(m.centroid[1], 0, frame.height, "region.centroid"))};
  IndexInRange(m.box[0], 0, frame.width, "region.box");
  IndexInRange(m.box[1], 0, frame.height, "region.box");
  IndexInRange(m.box[2], 0, frame.width - m.box[0], "region.box");
  IndexInRange(m.box[3], 0, frame.height - m.box[1], "region.box");
  std::copy(m.box, m.box + 4, region.box.begin());
  region.touches_border = m.touches_border != 0;
  region.median_depth = static_cast<float>(InRange(m.median_depth, 0, 100, "region.median_depth"));
  return region;
}

static part_pose_t ToMessage(const PartEstimate& part) {
  part_pose_t m;
  m.X_TP = ToMessage(part.X_TP);
  for (int i = 0; i < 6; ++i) m.velocity[i] = static_cast<float>(part.velocity[i]);
  SetCovariance(part.covariance, m.covariance);
  m.visible_fraction = static_cast<float>(part.visible_fraction);
  m.status = static_cast<int8_t>(part.status);
  m.confidence = static_cast<float>(part.confidence);
  m.ambiguous_with = static_cast<int16_t>(part.ambiguous_with);
  m.ambiguous_probability = static_cast<float>(part.ambiguous_probability);
  m.identity_exchange = static_cast<int16_t>(part.identity_exchange);
  return m;
}

static PartEstimate PartFromMessage(const part_pose_t& m, int num_parts) {
  PartEstimate part;
  part.X_TP = FromMessage(m.X_TP);
  for (int i = 0; i < 6; ++i) part.velocity[i] = Finite(m.velocity[i], "part.velocity");
  part.covariance = FiniteCovariance(m.covariance, "part.covariance");
  part.visible_fraction = InRange(m.visible_fraction, 0, 1, "part.visible_fraction");
  part.status = KnownValue(m.status, PartStatus::kAbsent, "part.status");
  part.confidence = InRange(m.confidence, 0, 1, "part.confidence");
  part.ambiguous_with = IndexInRange(m.ambiguous_with, -1, num_parts - 1, "part.ambiguous_with");
  part.ambiguous_probability = InRange(m.ambiguous_probability, 0, 1, "part.ambiguous_probability");
  part.identity_exchange = IndexInRange(m.identity_exchange, -1, num_parts - 1, "part.identity_exchange");
  return part;
}

static pair_evidence_t ToMessage(const PairEvidence& pair) {
  pair_evidence_t m;
  m.part_a = static_cast<int16_t>(pair.part_a);
  m.part_b = static_cast<int16_t>(pair.part_b);
  m.X_AB = ToMessage(pair.X_AB);
  SetCovariance(pair.covariance, m.covariance);
  m.candidate_kind = static_cast<int8_t>(pair.candidate_kind);
  m.candidate = static_cast<int16_t>(pair.candidate);
  m.log_evidence = static_cast<float>(pair.log_evidence);
  m.pixels = pair.pixels;
  m.surface_distance = static_cast<float>(pair.surface_distance);
  for (size_t i = 0; i < 2; ++i) {
    m.motion[i] = static_cast<float>(pair.motion[i]);
    m.relative_motion[i] = static_cast<float>(pair.relative_motion[i]);
    m.visible_fraction[i] = static_cast<float>(pair.visible_fraction[i]);
  }
  m.constrained = pair.constrained;
  return m;
}

static PairEvidence PairFromMessage(const pair_evidence_t& m, int num_parts) {
  PairEvidence pair;
  pair.part_a = IndexInRange(m.part_a, 0, num_parts - 1, "pair.part_a");
  pair.part_b = IndexInRange(m.part_b, pair.part_a + 1, num_parts - 1, "pair.part_b");
  pair.X_AB = FromMessage(m.X_AB);
  pair.covariance = FiniteCovariance(m.covariance, "pair.covariance");
  pair.candidate_kind = KnownValue(m.candidate_kind, CandidateKind::kMistake, "pair.candidate_kind");
  pair.candidate = IndexInRange(m.candidate, -1, kMaxConnections - 1, "pair.candidate");
  pair.log_evidence = Finite(m.log_evidence, "pair.log_evidence");
  pair.pixels = IndexInRange(m.pixels, 0, kMaxImageSide * kMaxImageSide, "pair.pixels");
  pair.surface_distance = Finite(m.surface_distance, "pair.surface_distance");
  for (size_t i = 0; i < 2; ++i) {
    pair.motion[i] = Finite(m.motion[i], "pair.motion");
    pair.relative_motion[i] = Finite(m.relative_motion[i], "pair.relative_motion");
    pair.visible_fraction[i] = InRange(m.visible_fraction[i], 0, 1, "pair.visible_fraction");
  }
  pair.constrained = m.constrained != 0;
  return pair;
}

static foreign_blob_t ToMessage(const ForeignBlob& blob) {
  foreign_blob_t m;
  SetVector(blob.centre, m.centre);
  m.radius = static_cast<float>(blob.radius);
  SetVector(blob.velocity, m.velocity);
  return m;
}

static std::vector<ForeignBlob> BlobsFromMessage(const std::vector<foreign_blob_t>& messages) {
  std::vector<ForeignBlob> blobs;
  blobs.reserve(messages.size());
  for (const foreign_blob_t& m : messages)
    blobs.push_back({FiniteVector(m.centre, "foreign.centre"), InRange(m.radius, 0, 10, "foreign.radius"),
                     FiniteVector(m.velocity, "foreign.velocity")});
  return blobs;
}

static connection_state_t ToMessage(const ConnectionState& state) {
  connection_state_t m;
  m.connection = static_cast<int16_t>(state.connection);
  m.part_a = static_cast<int16_t>(state.part_a);
  m.part_b = static_cast<int16_t>(state.part_b);
  m.probability = static_cast<float>(state.probability);
  m.state = static_cast<int8_t>(state.state);
  m.since = state.since;
  m.decided = state.decided;
  return m;
}

static ConnectionState StateFromMessage(const connection_state_t& m) {
  ConnectionState state;
  state.connection = IndexInRange(m.connection, kUnknownContact, kMaxConnections, "connection");
  state.part_a = IndexInRange(m.part_a, -1, kMaxParts - 1, "connection.part_a");
  state.part_b = IndexInRange(m.part_b, -1, kMaxParts - 1, "connection.part_b");
  state.probability = InRange(m.probability, 0, 1, "connection.probability");
  state.state = KnownValue(m.state, ConnectionState::State::kUncertain, "connection.state");
  state.since = m.since;
  state.decided = m.decided;
  return state;
}

static table_part_t ToMessage(const TableScene::TablePart& part) {
  table_part_t m;
  m.part = static_cast<int16_t>(part.part);
  SetVector(part.X_TP.translation(), m.position);
  SetRotation(part.X_TP.linear(), m.orientation);
  m.status = static_cast<int8_t>(part.status);
  return m;
}

// Conversions of whole messages.

pose_t ToMessage(const Pose& X) {
  pose_t m;
  SetVector(X.translation(), m.position);
  SetRotation(X.linear(), m.orientation);
  return m;
}

Pose FromMessage(const pose_t& m) {
  Pose X = Pose::Identity();
  X.linear() = UnitRotation(m.orientation, "pose.orientation");
  X.translation() = FiniteVector(m.position, "pose.position");
  return X;
}

detections_t ToMessage(const Detections& detections) {
  detections_t m;
  m.utime = detections.utime;
  m.received_utime = detections.received_utime;
  m.sequence = detections.sequence;
  m.width = static_cast<int16_t>(detections.width);
  m.height = static_cast<int16_t>(detections.height);
  m.num_classes = static_cast<int16_t>(detections.num_classes);
  m.regions = ToMessages<region_t>(detections.regions);
  m.num_regions = static_cast<int16_t>(m.regions.size());
  m.class_map = EncodeClassMap(detections.class_map);
  m.class_map_size = static_cast<int32_t>(m.class_map.size());
  return m;
}

Detections FromMessage(const detections_t& m) {
  CheckCount(m.num_regions, m.regions, kMaxRegions, "num_regions");
  Detections detections;
  detections.utime = m.utime;
  detections.received_utime = m.received_utime;
  detections.sequence = m.sequence;
  detections.width = IndexInRange(m.width, 0, kMaxImageSide, "width");
  detections.height = IndexInRange(m.height, 0, kMaxImageSide, "height");
  detections.num_classes = IndexInRange(m.num_classes, 0, 8, "num_classes");
  for (const region_t& region : m.regions) detections.regions.push_back(RegionFromMessage(region, m));
  detections.class_map = DecodeClassMap(m.class_map, static_cast<size_t>(m.width) * static_cast<size_t>(m.height));
  return detections;
}

part_poses_t ToMessage(const PartPoses& poses) {
  part_poses_t m;
  m.utime = poses.utime;
  m.received_utime = poses.received_utime;
  m.sequence = poses.sequence;
  m.X_TC = ToMessage(poses.X_TC);
  SetCovariance(poses.X_TC_covariance, m.X_TC_covariance);
  m.table_found = poses.table_found;
  m.table_residual = static_cast<float>(poses.table_residual);
  m.parts = ToMessages<part_pose_t>(poses.parts);
  m.num_parts = static_cast<int16_t>(m.parts.size());
  m.pairs = ToMessages<pair_evidence_t>(poses.pairs);
  m.num_pairs = static_cast<int16_t>(m.pairs.size());
  m.foreign = ToMessages<foreign_blob_t>(poses.foreign);
  m.num_foreign = static_cast<int16_t>(m.foreign.size());
  return m;
}

PartPoses FromMessage(const part_poses_t& m) {
  CheckCount(m.num_parts, m.parts, kMaxParts, "num_parts");
  CheckCount(m.num_pairs, m.pairs, kMaxPairs, "num_pairs");
  CheckCount(m.num_foreign, m.foreign, kMaxForeign, "num_foreign");
  PartPoses poses;
  poses.utime = m.utime;
  poses.received_utime = m.received_utime;
  poses.sequence = m.sequence;
  poses.X_TC = FromMessage(m.X_TC);
  poses.X_TC_covariance = FiniteCovariance(m.X_TC_covariance, "X_TC_covariance");
  poses.table_found = m.table_found != 0;
  poses.table_residual = Finite(m.table_residual, "table_residual");
  for (const part_pose_t& part : m.parts) poses.parts.push_back(PartFromMessage(part, m.num_parts));
  for (const pair_evidence_t& pair : m.pairs) poses.pairs.push_back(PairFromMessage(pair, m.num_parts));
  poses.foreign = BlobsFromMessage(m.foreign);
  return poses;
}

connection_belief_t ToMessage(const ConnectionBelief& belief) {
  connection_belief_t m;
  m.utime = belief.utime;
  for (const ConnectionProbability& c : belief.connections) {
    connection_probability_t& out = m.connections.emplace_back();
    out.connection = static_cast<int16_t>(c.connection);
    out.part_a = static_cast<int16_t>(c.part_a);
    out.part_b = static_cast<int16_t>(c.part_b);
    out.probability = static_cast<float>(c.probability);
  }
  m.num_connections = static_cast<int16_t>(m.connections.size());
  return m;
}

ConnectionBelief FromMessage(const connection_belief_t& m) {
  CheckCount(m.num_connections, m.connections, kMaxConnections, "num_connections");
  ConnectionBelief belief;
  belief.utime = m.utime;
  for (const connection_probability_t& c : m.connections)
    belief.connections.push_back({IndexInRange(c.connection, -kMaxConnections, kMaxConnections, "belief.connection"),
                                  IndexInRange(c.part_a, 0, kMaxParts - 1, "belief.part_a"),
                                  IndexInRange(c.part_b, 0, kMaxParts - 1, "belief.part_b"),
                                  InRange(c.probability, 0, 1, "belief.probability")});
  return belief;
}

guidance_event_t ToMessage(const GuidanceEvent& event) {
  guidance_event_t m;
  m.id = event.id;
  m.utime = event.utime;
  m.since = event.since;
  m.kind = event.kind;
  m.subject = event.subject;
  m.part_a = static_cast<int16_t>(event.part_a);
  m.part_b = static_cast<int16_t>(event.part_b);
  m.probability = static_cast<float>(event.probability);
  m.reason = event.reason;
  return m;
}

GuidanceEvent FromMessage(const guidance_event_t& m) {
  GuidanceEvent event;
  event.id = m.id;
  event.utime = m.utime;
  event.since = m.since;
  event.kind = m.kind;
  event.subject = m.subject;
  event.part_a = IndexInRange(m.part_a, -1, kMaxParts - 1, "event.part_a");
  event.part_b = IndexInRange(m.part_b, -1, kMaxParts - 1, "event.part_b");
  event.probability = InRange(m.probability, 0, 1, "event.probability");
  event.reason = m.reason;
  return event;
}

assembly_state_t ToMessage(const AssemblyState& state) {
  assembly_state_t m;
  m.utime = state.utime;
  m.session = state.session;
  m.task = state.task;
  m.phase = static_cast<int8_t>(state.phase);
  m.idle_level = static_cast<int8_t>(state.idle_level);
  m.step = static_cast<int16_t>(state.step);
  m.made = static_cast<int16_t>(state.made);
  m.required = static_cast<int16_t>(state.required);
  m.connections = ToMessages<connection_state_t>(state.connections);
  m.num_connections = static_cast<int16_t>(m.connections.size());
  m.events = ToMessages<guidance_event_t>(state.events);
  m.num_events = static_cast<int16_t>(m.events.size());
  return m;
}

AssemblyState FromMessage(const assembly_state_t& m) {
  CheckCount(m.num_connections, m.connections, 2 * kMaxConnections, "num_connections");
  CheckCount(m.num_events, m.events, 64, "num_events");
  AssemblyState state;
  state.utime = m.utime;
  state.session = m.session;
  state.task = m.task;
  state.phase = KnownValue(m.phase, Phase::kComplete, "phase");
  state.idle_level = IndexInRange(m.idle_level, 0, 4, "idle_level");
  state.step = IndexInRange(m.step, -1, kMaxConnections - 1, "step");
  state.made = IndexInRange(m.made, 0, kMaxConnections, "made");
  state.required = IndexInRange(m.required, 0, kMaxConnections, "required");
  for (const connection_state_t& connection : m.connections) state.connections.push_back(StateFromMessage(connection));
  for (const guidance_event_t& event : m.events) state.events.push_back(FromMessage(event));
  return state;
}

task_t ToMessage(const Task& task) {
  task_t m;
  m.name = task.name;
  m.file = task.file.string();
  m.sha256 = task.sha256;
  for (const PartType& type : task.types) {
    m.types.push_back(type.name);
    m.colours.push_back(type.colour);
  }
  m.num_types = static_cast<int16_t>(m.types.size());
  for (const Part& part : task.parts) {
    m.parts.push_back(part.name);
    m.part_types.push_back(static_cast<int16_t>(part.type));
  }
  m.num_parts = static_cast<int16_t>(m.parts.size());
  for (const Connection& connection : task.connections) m.connections.push_back(connection.name);
  m.num_connections = static_cast<int16_t>(m.connections.size());
  for (const Mistake& mistake : task.mistakes) m.mistakes.push_back(mistake.name);
  m.num_mistakes = static_cast<int16_t>(m.mistakes.size());
  return m;
}

table_scene_t ToMessage(const TableScene& scene) {
  table_scene_t m;
  m.utime = scene.utime;
  m.station = scene.station;
  m.parts = ToMessages<table_part_t>(scene.parts);
  m.num_parts = static_cast<int16_t>(m.parts.size());
  m.foreign = ToMessages<foreign_blob_t>(scene.foreign);
  m.num_foreign = static_cast<int16_t>(m.foreign.size());
  return m;
}

TableScene FromMessage(const table_scene_t& m) {
  CheckCount(m.num_parts, m.parts, kMaxParts, "num_parts");
  CheckCount(m.num_foreign, m.foreign, kMaxForeign, "num_foreign");
  TableScene scene;
  scene.utime = m.utime;
  scene.station = m.station;
  for (const table_part_t& part : m.parts) {
    TableScene::TablePart& out = scene.parts.emplace_back();
    out.part = IndexInRange(part.part, 0, kMaxParts - 1, "table.part");
    out.X_TP.linear() = UnitRotation(part.orientation, "table.orientation");
    out.X_TP.translation() = FiniteVector(part.position, "table.position");
    out.status = KnownValue(part.status, PartStatus::kAbsent, "table.status");
  }
  scene.foreign = BlobsFromMessage(m.foreign);
  return scene;
}

}  // namespace coach
