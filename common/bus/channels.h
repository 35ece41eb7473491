// The channel of every message type. Each type travels on one channel, so a type that happens to have the fields (and
// with them the fingerprint) of another can't be taken for it by a slip of the pen.
#pragma once

#include <coach/annotation_t.hpp>
#include <coach/assembly_state_t.hpp>
#include <coach/color_image_t.hpp>
#include <coach/config_t.hpp>
#include <coach/connection_belief_t.hpp>
#include <coach/depth_image_t.hpp>
#include <coach/detections_t.hpp>
#include <coach/guidance_event_t.hpp>
#include <coach/operator_command_t.hpp>
#include <coach/part_poses_t.hpp>
#include <coach/robot_command_t.hpp>
#include <coach/robot_status_t.hpp>
#include <coach/service_health_t.hpp>
#include <coach/table_scene_t.hpp>
#include <coach/task_t.hpp>
#include <concepts>

namespace coach {

/// Name of the channel without the station's prefix; empty for what is no message.
template <class M>
inline constexpr const char* kChannel = "";

template <>
inline constexpr const char* kChannel<color_image_t> = "COLOR_IMAGE";
template <>
inline constexpr const char* kChannel<depth_image_t> = "DEPTH_IMAGE";
template <>
inline constexpr const char* kChannel<detections_t> = "DETECTIONS";
template <>
inline constexpr const char* kChannel<part_poses_t> = "PART_POSES";
template <>
inline constexpr const char* kChannel<connection_belief_t> = "CONNECTION_BELIEF";
template <>
inline constexpr const char* kChannel<assembly_state_t> = "ASSEMBLY_STATE";
template <>
inline constexpr const char* kChannel<guidance_event_t> = "GUIDANCE_EVENT";
template <>
inline constexpr const char* kChannel<task_t> = "TASK";
template <>
inline constexpr const char* kChannel<table_scene_t> = "TABLE_SCENE";
template <>
inline constexpr const char* kChannel<robot_command_t> = "ROBOT_COMMAND";
template <>
inline constexpr const char* kChannel<robot_status_t> = "ROBOT_STATUS";
template <>
inline constexpr const char* kChannel<operator_command_t> = "OPERATOR_COMMAND";
template <>
inline constexpr const char* kChannel<annotation_t> = "ANNOTATION";
template <>
inline constexpr const char* kChannel<service_health_t> = "SERVICE_HEALTH";
template <>
inline constexpr const char* kChannel<config_t> = "CONFIG";

/// A type of lcmtypes/ that has a channel.
template <class M>
concept Message = kChannel<M>
[0] != '\0';

/// Messages of which only the newest counts.
template <class M>
concept NewestOnly = std::same_as<M, color_image_t> || std::same_as<M, depth_image_t> ||
    std::same_as<M, detections_t> || std::same_as<M, part_poses_t>;

}  // namespace coach
