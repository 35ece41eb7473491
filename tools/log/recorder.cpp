#include "tools/log/recorder.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <stdexcept>
#include <vector>

namespace coach {
namespace {

constexpr int64_t kRetry = 5'000'000;  // us between two tries to begin a file on a disk that refuses

std::string FileName(int64_t utime) {
  const std::time_t seconds = utime / 1'000'000;
  std::tm local{};
  localtime_r(&seconds, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%d-%H%M%S", &local);
  return std::string("lesson-") + text;
}

}  // namespace

RecorderOptions ReadRecorderOptions(const Station& station) {
  RecorderOptions options;
  const YamlNode log = station.Section("log");
  const std::string folder = log.Get<std::string>("folder", "");
  if (!folder.empty()) {
    options.folder = std::filesystem::absolute(station.file).parent_path() / folder;
  } else {
    options.folder = (station.state_folder.empty() ? std::filesystem::current_path() : station.state_folder) / "log";
  }
  options.images = log.Get<bool>("images", options.images);
  options.split_mb = log.GetInRange("split_mb", options.split_mb, 1, 1e6);
  options.quota_gb = log.GetInRange("quota_gb", options.quota_gb, 0.001, 1e6);
  log.RejectUnknownKeys();
  return options;
}

bool IsKept(const std::string& channel, bool images) {
  static constexpr std::array<const char*, 3> kPictures{"COLOR_IMAGE", "DEPTH_IMAGE", "DETECTIONS"};
  const std::string name = channel.substr(channel.find('/') + 1);
  return images || std::find(kPictures.begin(), kPictures.end(), name) == kPictures.end();
}

Recorder::Recorder(const RecorderOptions& options) : options_(options) {
  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  if (!std::filesystem::is_directory(options.folder)) {
    throw std::runtime_error(options.folder.string() + ": the folder for recordings can't be made: " + error.message());
  }
}

bool Recorder::Begin(int64_t utime) {
  writer_.reset();
  DeleteOldest();
  const std::string name = FileName(utime);
  file_ = options_.folder / (name + ".lcm");
  for (int k = 1; std::filesystem::exists(file_); ++k) {
    file_ = options_.folder / (name + "-" + std::to_string(k) + ".lcm");
  }
  try {
    writer_ = std::make_unique<LogWriter>(file_);
    return true;
  } catch (const std::runtime_error& e) {
    spdlog::error("{}", e.what());
    return false;
  }
}

void Recorder::DeleteOldest() {
  struct Old {
    std::filesystem::path file;
    double bytes;
  };
  std::vector<Old> files;
  double total = options_.split_mb * 1e6;  // what is about to be written
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(options_.folder, error)) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("lesson-") || entry.path().extension() != ".lcm") continue;
    files.push_back({entry.path(), static_cast<double>(entry.file_size(error))});
    total += files.back().bytes;
  }
  std::sort(files.begin(), files.end(), [](const Old& a, const Old& b) { return a.file < b.file; });
  for (const auto& old : files) {
    if (total <= options_.quota_gb * 1e9) break;
    if (std::filesystem::remove(old.file, error)) spdlog::info("{} deleted: the quota is reached", old.file.string());
    total -= old.bytes;
  }
}

void Recorder::Write(int64_t utime, const std::string& channel, std::span<const uint8_t> bytes) {
  if (!IsKept(channel, options_.images)) return;
  const bool full = writer_ && static_cast<double>(writer_->bytes()) >= options_.split_mb * 1e6;
  if (!writer_ || full) {
    if (disk_refuses_ && utime < retry_) {
      ++refused_;
      return;
    }
    disk_refuses_ = !Begin(utime);
    retry_ = utime + kRetry;
  }
  if (writer_ && writer_->Write(utime, channel, bytes)) {
    ++events_;
    return;
  }
  if (!disk_refuses_) spdlog::error("{}: the disk refuses; trying again every 5 s", file_.string());
  ++refused_;
  disk_refuses_ = true;
  writer_.reset();
}

void Recorder::Flush() {
  if (writer_ && !writer_->Flush()) {
    disk_refuses_ = true;
    writer_.reset();
  }
}

}  // namespace coach
