#include "tools/log/log_file.h"

#include <lcm/eventlog.h>

#include <cstdio>
#include <stdexcept>

namespace coach {
namespace {

constexpr int64_t kHeader = 28;  // bytes of an event before channel and data

}  // namespace

LogReader::LogReader(const std::filesystem::path& file) : log_(lcm_eventlog_create(file.c_str(), "r")), size_(0) {
  if (!log_) throw std::runtime_error(file.string() + ": can't be read");
  std::error_code error;
  size_ = static_cast<int64_t>(std::filesystem::file_size(file, error));
  if (error) {
    lcm_eventlog_destroy(log_);
    throw std::runtime_error(file.string() + ": is no file");
  }
}

LogReader::~LogReader() { lcm_eventlog_destroy(log_); }

std::optional<LogEvent> LogReader::Next() {
  lcm_eventlog_event_t* raw = lcm_eventlog_read_next_event(log_);
  if (!raw) return std::nullopt;
  const auto* data = static_cast<const uint8_t*>(raw->data);
  LogEvent event{
      raw->timestamp, std::string(raw->channel, static_cast<size_t>(raw->channellen)), {data, data + raw->datalen}};
  consumed_ += kHeader + raw->channellen + raw->datalen;
  lcm_eventlog_free_event(raw);
  return event;
}

bool LogReader::complete() const { return consumed_ == size_; }

LogWriter::LogWriter(const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) throw std::runtime_error(file.string() + ": exists already");
  log_ = lcm_eventlog_create(file.c_str(), "w");
  if (!log_) throw std::runtime_error(file.string() + ": can't be written");
}

LogWriter::~LogWriter() { lcm_eventlog_destroy(log_); }

bool LogWriter::Write(int64_t utime, const std::string& channel, std::span<const uint8_t> bytes) {
  std::vector<uint8_t> copy(bytes.begin(), bytes.end());  // LCM's structure wants a mutable pointer
  std::string name = channel;
  lcm_eventlog_event_t event{};
  event.timestamp = utime;
  event.channellen = static_cast<int32_t>(name.size());
  event.datalen = static_cast<int32_t>(copy.size());
  event.channel = name.data();
  event.data = copy.data();
  if (lcm_eventlog_write_event(log_, &event) != 0) return false;
  bytes_ += kHeader + event.channellen + event.datalen;
  ++events_;
  return true;
}

bool LogWriter::Flush() { return std::fflush(log_->f) == 0; }

}  // namespace coach
