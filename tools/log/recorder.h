// Keeps a lesson's messages on disk: split into files, within a quota, never a picture that was not agreed to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "common/configuration/station.h"
#include "tools/log/log_file.h"

namespace coach {

struct RecorderOptions {
  std::filesystem::path folder;  ///< default: log in the station's state folder
  bool images = false;           ///< keep COLOR_IMAGE, DEPTH_IMAGE, DETECTIONS: only with the consent of those in them
  double split_mb = 512;         ///< a file is closed and another begun at this size
  double quota_gb = 20;          ///< of all recordings in the folder; the oldest are deleted
};

/// The section `log` of the station file. @throws ConfigurationError
RecorderOptions ReadRecorderOptions(const Station& station);

/// Whether a channel (with the station's prefix) is kept.
bool IsKept(const std::string& channel, bool images);

class Recorder {
 public:
  /// Makes the folder. @throws std::runtime_error naming it if that fails.
  explicit Recorder(const RecorderOptions& options);

  /// One message of the bus. @param utime us since 1970; also names the files.
  void Write(int64_t utime, const std::string& channel, std::span<const uint8_t> bytes);
  /// To be called once a second or so: brings what was written to the disk.
  void Flush();

  int64_t events() const { return events_; }    ///< kept so far
  int64_t refused() const { return refused_; }  ///< by the disk
  bool disk_refuses() const { return disk_refuses_; }
  std::filesystem::path file() const { return file_; }  ///< that is being written; empty before the first event

 private:
  bool Begin(int64_t utime);
  void DeleteOldest();

  RecorderOptions options_;
  std::unique_ptr<LogWriter> writer_;
  std::filesystem::path file_;
  int64_t events_ = 0, refused_ = 0, retry_ = 0;
  bool disk_refuses_ = false;
};

}  // namespace coach
