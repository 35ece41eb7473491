#include "services/pose_filter/pose_filter_service.h"

#include <spdlog/spdlog.h>

#include "common/bus/image_messages.h"
#include "common/bus/messages.h"
#include "common/bus/process_facts.h"

namespace coach {

PoseFilterService::PoseFilterService(const NodeOptions& node, const Task& task, MakeFilter make_filter,
                                     const PoseFilterServiceOptions& options)
    : make_filter_(std::move(make_filter)), options_(options), node_(node) {
  SetTask(task);
  // All of them: the joiner keeps the newest frame that is complete.
  node_.Subscribe<depth_image_t>([this](const depth_image_t& m) {
    node_.Received();
    frames_.Add(m);
  });
  node_.Subscribe<detections_t>([this](const detections_t& m) { frames_.Add(m); });
  node_.Subscribe<color_image_t>([this](const color_image_t& m) { frames_.Add(m); });
  node_.Subscribe<connection_belief_t>([this](const connection_belief_t& m) { belief_ = FromMessage(m); });
  node_.OnOperatorCommand([this](const OperatorCommand& command) {
    if (command.kind != OperatorKind::kResetTracker) return;
    spdlog::info("tracker reset by the operator");
    state_.reset();
    belief_.reset();
    filter_->Reset();
  });
}

void PoseFilterService::SetTask(const Task& task) {
  filter_ = make_filter_(task);
  task_sha256_ = task.sha256;
  belief_.reset();
  state_.reset();
  if (!options_.state_file.empty()) state_ = ReadState(options_.state_file, task.sha256, task.parts.size());
  if (!state_) return;
  spdlog::info("going on from the poses in {}", options_.state_file.string());
  filter_->Suggest(state_->X_CP);
}

void PoseFilterService::Run() {
  node_.Run([this] { Step(); });
}

void PoseFilterService::Step() {
  const auto joined = frames_.Next();
  node_.Dropped(frames_.dropped() - dropped_seen_);
  dropped_seen_ = frames_.dropped();
  if (!joined) return;
  if (joined->restarted) BeginAgain();
  try {
    Answer(joined->primary, std::get<0>(joined->companions).get(), std::get<1>(joined->companions).get());
  } catch (...) {
    node_.Dropped();
    throw;
  }
}

/// The camera's time has begun anew: the poses are hypotheses, nothing more.
void PoseFilterService::BeginAgain() {
  spdlog::info("the camera was started again");
  belief_.reset();
  recent_utimes_.clear();
  filter_->Reset();
  if (state_) filter_->Suggest(state_->X_CP);
}

void PoseFilterService::Answer(const depth_image_t& depth, const detections_t* detections_message,
                               const color_image_t* colour) {
  const Frame frame = FromMessage(depth);
  std::optional<Detections> detections;
  if (detections_message) detections = FromMessage(*detections_message);
  FilterInput input;
  input.utime = frame.utime;
  input.received_utime = frame.received_utime;
  input.sequence = frame.sequence;
  input.camera = frame.camera;
  if (colour) input.colour = FromMessage(*colour).colour;
  input.depth = frame.depth;
  input.metres_per_unit = frame.metres_per_unit;
  if (detections) input.detections = &*detections;
  const bool fresh = belief_ && !recent_utimes_.empty() && belief_->utime >= recent_utimes_.front();
  if (fresh) input.belief = &*belief_;
  const PartPoses& poses = filter_->Step(input);
  recent_utimes_.push_back(frame.utime);
  if (recent_utimes_.size() > static_cast<size_t>(options_.belief_frames)) recent_utimes_.erase(recent_utimes_.begin());
  node_.Publish(ToMessage(poses));
  node_.Answered(frame.received_utime);
  KeepState(poses);
}

void PoseFilterService::KeepState(const PartPoses& poses) {
  if (std::optional<FilterState> state = StateOf(poses, task_sha256_)) state_ = std::move(state);
  if (options_.state_file.empty() || node_.lockstep() || !state_ || SteadyTime() - last_state_ < 1'000'000) return;
  last_state_ = SteadyTime();
  try {
    WriteState(options_.state_file, *state_);
    node_.SetState(service_health_t::OK, "");
  } catch (const std::runtime_error& e) {
    node_.SetState(service_health_t::DEGRADED, e.what());  // a full disk is no reason to stop tracking
  }
}

}  // namespace coach
