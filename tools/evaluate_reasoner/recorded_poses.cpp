#include "tools/evaluate_reasoner/recorded_poses.h"

#include <stdexcept>

#include "common/bus/messages.h"
#include "tools/log/log_file.h"

namespace coach {
namespace {

constexpr char kPoses[] = "PART_POSES";

bool IsPartPoses(const std::string& channel) {
  const size_t slash = channel.rfind('/');
  return channel.substr(slash == std::string::npos ? 0 : slash + 1) == kPoses;
}

}  // namespace

std::vector<PartPoses> ReadPartPoses(const std::filesystem::path& log) {
  LogReader reader(log);
  std::vector<PartPoses> out;
  while (const auto event = reader.Next()) {
    part_poses_t message;
    if (!IsPartPoses(event->channel)) continue;
    if (message.decode(event->bytes.data(), 0, static_cast<int>(event->bytes.size())) < 0) continue;
    try {
      PartPoses poses = FromMessage(message);
      if (out.empty() || poses.utime > out.back().utime) out.push_back(std::move(poses));
    } catch (const std::invalid_argument&) {
      continue;
    }
  }
  if (out.empty()) throw std::runtime_error(log.string() + ": holds no " + kPoses);
  return out;
}

void WritePartPoses(const std::filesystem::path& log, const std::vector<PartPoses>& poses) {
  LogWriter writer(log);
  for (const PartPoses& p : poses) {
    const part_poses_t message = ToMessage(p);
    std::vector<uint8_t> bytes(static_cast<size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    if (!writer.Write(p.utime, std::string("SCENE/") + kPoses, bytes))
      throw std::runtime_error(log.string() + ": can't be written");
  }
}

}  // namespace coach
