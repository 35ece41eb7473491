#include "services/robot_bridge/robot_options.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace coach {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
const Vector3 kPosition(0, -0.5, 0.08);  // m
const Vector3 kDegrees(0, 0, 90);        // roll, pitch, yaw

Vector3 ReadVector(const YamlNode& node, const std::string& key, const Vector3& otherwise, double limit) {
  const std::optional<YamlNode> value = node.Find(key);
  if (!value) return otherwise;
  const auto numbers = value->As<std::vector<double>>();
  if (numbers.size() != 3) value->Fail("three numbers");
  const Vector3 result(numbers[0], numbers[1], numbers[2]);
  if (result.cwiseAbs().maxCoeff() > limit) value->Fail("numbers of at most " + std::to_string(limit));
  return result;
}

Pose PoseOf(const Vector3& position, const Vector3& degrees) {
  const Matrix3 rotation = (Eigen::AngleAxisd(degrees.z() * kDegree, Vector3::UnitZ()) *
                            Eigen::AngleAxisd(degrees.y() * kDegree, Vector3::UnitY()) *
                            Eigen::AngleAxisd(degrees.x() * kDegree, Vector3::UnitX()))
                               .toRotationMatrix();
  return MakePose(rotation, position);
}

Pose ReadPose(const YamlNode& robot) {
  return PoseOf(ReadVector(robot, "position", kPosition, 5), ReadVector(robot, "roll_pitch_yaw", kDegrees, 360));
}

VirtualRobotOptions ReadVirtual(const YamlNode& node) {
  VirtualRobotOptions options;
  options.host = node.Get<std::string>("host", options.host);
  options.port = static_cast<int>(node.GetInRange("port", options.port, 0, 65535));
  options.token = node.Get<std::string>("token", options.token);
  options.max_pages = static_cast<int>(node.GetInRange("max_pages", options.max_pages, 1, 100));
  node.RejectUnknownKeys();
  const bool loopback = options.host == "localhost" || options.host == "::1" || options.host.starts_with("127.");
  if (!loopback && options.token.size() < 12) {
    node.At("host").Fail(options.host, "a loopback address, or a `token` of at least 12 characters beside it");
  }
  return options;
}

NaoOptions ReadNao(const YamlNode& node) {
  NaoOptions options;
  options.url = node.Get<std::string>("url", options.url);
  if (!options.url.starts_with("tcp://") && !options.url.starts_with("tcps://")) {
    node.At("url").Fail("tcp://host:port or tcps://host:port");
  }
  options.user = node.Get<std::string>("user", options.user);
  options.token = node.Get<std::string>("token", options.token);
  options.call_timeout_s = node.GetInRange("call_timeout", options.call_timeout_s, 0.5, 60);
  options.largest_volume = node.GetInRange("largest_volume", options.largest_volume, 0, 1);
  node.RejectUnknownKeys();
  return options;
}

}  // namespace

Pose DefaultRobotPose() { return PoseOf(kPosition, kDegrees); }

Vector3 SeatDegrees(const Pose& X_TR) {
  const Matrix3& R = X_TR.linear();
  return Vector3(std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
                 std::atan2(R(1, 0), R(0, 0))) /
         kDegree;
}

RobotOptions ReadRobotOptions(const YamlNode& robot) {
  RobotOptions options;
  options.back_end = robot.GetChoice("back_end", options.back_end, {"virtual", "nao", "log"});
  options.recordings = robot.Get<std::string>("recordings", options.recordings);
  options.volume = robot.GetInRange("volume", options.volume, 0, 1);
  options.conductor.X_TR = ReadPose(robot);
  options.conductor.heartbeat_timeout_s =
      robot.GetInRange("heartbeat_timeout", options.conductor.heartbeat_timeout_s, 2, 600);
  GestureOptions& gesture = options.conductor.gesture;
  gesture.speed_fraction = robot.GetInRange("speed", gesture.speed_fraction, 0.05, 0.3);
  gesture.child_distance = robot.GetInRange("child_distance", gesture.child_distance, 0.1, 5);
  gesture.hand_clearance = robot.GetInRange("hand_clearance", gesture.hand_clearance, 0.05, 1);
  if (const auto node = robot.Find("virtual")) options.virtual_robot = ReadVirtual(*node);
  if (const auto node = robot.Find("nao")) options.nao = ReadNao(*node);
  robot.RejectUnknownKeys();
  return options;
}

}  // namespace coach
