#include <algorithm>

#include "common/bus/message_fields.h"
#include "common/bus/messages.h"

namespace coach {
namespace {

void CheckText(const std::string& text) {
  if (text.size() > kMaxSpeechBytes) RefuseField("text", std::to_string(text.size()) + " bytes long");
}

}  // namespace

robot_command_t ToMessage(const RobotCommand& command) {
  CheckText(command.text);
  robot_command_t m;
  m.id = command.id;
  m.station = command.station;
  m.session = command.session;
  m.kind = static_cast<int8_t>(command.kind);
  m.priority = static_cast<int8_t>(command.priority);
  m.text = command.text;
  m.phrase_key = command.phrase_key;
  m.wording = static_cast<int16_t>(command.wording);
  m.language = command.language;
  m.point = command.point_target.has_value();
  SetVector(command.point_target.value_or(Vector3::Zero()), m.point_target);
  m.look = command.look_target.has_value();
  SetVector(command.look_target.value_or(Vector3::Zero()), m.look_target);
  m.eye_colour = command.eye_colour;
  m.order = static_cast<int8_t>(command.order);
  m.replaces_id = command.replaces_id;
  m.sent_utime = command.sent_utime;
  m.valid_for_us = command.valid_for_us;
  std::copy(command.hmac.begin(), command.hmac.end(), m.hmac);
  return m;
}

RobotCommand FromMessage(const robot_command_t& m) {
  CheckText(m.text);
  RobotCommand command;
  command.id = m.id;
  command.station = m.station;
  command.session = m.session;
  command.kind = KnownValue(m.kind, ActKind::kCancel, "kind");
  command.priority = KnownValue(m.priority, Priority::kStop, "priority");
  command.text = m.text;
  command.phrase_key = m.phrase_key;
  command.wording = m.wording;
  command.language = m.language;
  if (m.point) command.point_target = FiniteVector(m.point_target, "point_target");
  if (m.look) command.look_target = FiniteVector(m.look_target, "look_target");
  command.eye_colour = m.eye_colour;
  command.order = KnownValue(m.order, ActOrder::kLookThenSay, "order");
  command.replaces_id = m.replaces_id;
  command.sent_utime = m.sent_utime;
  command.valid_for_us = m.valid_for_us;
  std::copy(std::begin(m.hmac), std::end(m.hmac), command.hmac.begin());
  return command;
}

robot_status_t ToMessage(const RobotStatus& status) {
  robot_status_t m;
  m.utime = status.utime;
  m.station = status.station;
  m.session = status.session;
  m.command_id = status.command_id;
  m.state = static_cast<int8_t>(status.state);
  m.reason = status.reason;
  m.speaking = status.speaking;
  m.connected = status.connected;
  m.back_end = status.back_end;
  m.language = status.language;
  m.battery = static_cast<float>(status.battery);
  m.point_clamped = status.point_clamped;
  m.gaze_clamped = status.gaze_clamped;
  m.help_requests = status.help_requests;
  return m;
}

RobotStatus FromMessage(const robot_status_t& m) {
  RobotStatus status;
  status.utime = m.utime;
  status.station = m.station;
  status.session = m.session;
  status.command_id = m.command_id;
  status.state = KnownValue(m.state, ActState::kFailed, "state");
  status.reason = m.reason;
  status.speaking = m.speaking != 0;
  status.connected = m.connected != 0;
  status.back_end = m.back_end;
  status.language = m.language;
  status.battery = InRange(m.battery, -1, 1, "battery");
  status.point_clamped = m.point_clamped != 0;
  status.gaze_clamped = m.gaze_clamped != 0;
  status.help_requests = m.help_requests;
  return status;
}

operator_command_t ToMessage(const OperatorCommand& command) {
  operator_command_t m;
  m.id = command.id;
  m.station = command.station;
  m.utime = command.utime;
  m.kind = static_cast<int8_t>(command.kind);
  m.argument = command.argument;
  return m;
}

OperatorCommand FromMessage(const operator_command_t& m) {
  OperatorCommand command;
  command.id = m.id;
  command.station = m.station;
  command.utime = m.utime;
  command.kind = KnownValue(m.kind, OperatorKind::kHelp, "kind");
  command.argument = m.argument;
  return command;
}

}  // namespace coach
