// Recordings of the bus (LCM's event log format), event by event.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

struct _lcm_eventlog_t;

namespace coach {

struct LogEvent {
  int64_t utime = 0;    ///< us since 1970; when the logger received it
  std::string channel;  ///< with the station's prefix
  std::vector<uint8_t> bytes;
};

class LogReader {
 public:
  /// @throws std::runtime_error naming the file if it can't be opened.
  explicit LogReader(const std::filesystem::path& file);
  ~LogReader();
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// The next event; nothing at the end, or where the file is cut off or damaged (the two look alike: see complete()).
  std::optional<LogEvent> Next();
  /// After Next() has returned nothing: whether that was at the file's last byte.
  bool complete() const;

 private:
  _lcm_eventlog_t* log_;
  int64_t size_, consumed_ = 0;  // bytes
};

class LogWriter {
 public:
  /// Makes the file; there must be none yet. @throws std::runtime_error naming the file.
  explicit LogWriter(const std::filesystem::path& file);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// @returns false if the disk refuses.
  bool Write(int64_t utime, const std::string& channel, std::span<const uint8_t> bytes);
  bool Flush();
  int64_t bytes() const { return bytes_; }    ///< written so far
  int64_t events() const { return events_; }  ///< written so far

 private:
  _lcm_eventlog_t* log_;
  int64_t bytes_ = 0, events_ = 0;
};

}  // namespace coach
