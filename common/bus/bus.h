// One LCM network seen from one station: typed channels, and nothing on the wire can hurt the process.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/channels.h"
#include "common/bus/decode_message.h"

struct _lcm_t;
struct _lcm_recv_buf_t;

namespace coach {

/// The network can't be used; what() says why and, for a missing multicast route, which command adds it. Exit code 4.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Handlers run inside Handle() only, in the thread that calls it. An exception from a handler, or a message that can't
/// be decoded (another type, cut off, bytes left over, hostile counts), is counted and logged (at most one line in 10
/// s) and goes no further.
///
/// URLs: `udpm://239.255.76.67:7667?ttl=0` (the network), `file:///log.lcm?speed=0` (a recording, in lockstep),
/// `file:///log.lcm?mode=w` (writes a recording), `memq://` (inside this Bus only, for tests).
class Bus {
 public:
  /// @param station prefix of every channel: 1..32 characters of A-Z a-z 0-9 _ - .
  /// @throws BusError
  Bus(const std::string& url, const std::string& station);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  const std::string& station() const { return station_; }
  /// A recording is read: one message at a time, none skipped.
  bool lockstep() const { return lockstep_; }

  /// Every message in order. Of more than 1000 (30 of NewestOnly types) that wait between two calls of Handle(), the
  /// network's queue drops the newest.
  template <Message M>
  void Subscribe(std::function<void(const M&)> handler) {
    Add(kChannel<M>, NewestOnly<M>, false, Decoder<M>(std::move(handler)));
  }

  /// The newest of the messages that wait at each call of Handle(); the others are counted as skipped. In lockstep
  /// every message.
  template <NewestOnly M>
  void SubscribeNewest(std::function<void(const M&)> handler) {
    Add(kChannel<M>, true, true, Decoder<M>(std::move(handler)));
  }

  /// Sends; never throws. @returns false if the message's counts do not agree with its arrays or the network refuses
  /// (both counted).
  template <Message M>
  bool Publish(const M& message) {
    if (!CountsAgree(message)) return Refuse(kChannel<M>);
    buffer_.resize(static_cast<size_t>(message.getEncodedSize()));
    if (message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size())) < 0) return Refuse(kChannel<M>);
    return PublishBytes(kChannel<M>, buffer_);
  }
  /// Any bytes on a channel of this station.
  bool PublishBytes(const std::string& channel, std::span<const uint8_t> bytes);

  /// Waits up to timeout_ms for a message, then handles what waits (in lockstep: one message).
  /// @returns the number of messages; -1 at the end of a recording.
  int Handle(int timeout_ms);

  /// Readable when a message waits; for poll().
  int file_descriptor() const;

  int64_t received() const { return received_; }              ///< messages of subscribed channels
  int64_t skipped() const { return skipped_; }                ///< superseded, never given to a handler
  int64_t errors() const { return errors_; }                  ///< not decoded, or the handler threw
  int64_t publish_errors() const { return publish_errors_; }  ///< not sent

 private:
  using ByteHandler = std::function<void(std::span<const uint8_t>)>;
  struct Subscription;

  template <class M>
  static ByteHandler Decoder(std::function<void(const M&)> handler) {
    return [handler = std::move(handler)](std::span<const uint8_t> bytes) {
      handler(DecodeMessage<M>(bytes));
    };
  }
  void Add(const std::string& channel, bool newest_only, bool skip, ByteHandler handler);
  void Receive(Subscription& subscription, const _lcm_recv_buf_t& message);
  void Dispatch(Subscription& subscription, std::span<const uint8_t> bytes);
  void CountError(const Subscription& subscription, size_t size, const std::string& why);
  void DispatchNewest();
  bool Refuse(const std::string& channel);

  _lcm_t* lcm_ = nullptr;
  std::string url_, station_;
  bool lockstep_ = false;
  std::vector<std::unique_ptr<Subscription>> subscriptions_;
  std::vector<uint8_t> buffer_;
  int64_t received_ = 0, skipped_ = 0, errors_ = 0, publish_errors_ = 0;
  int64_t last_log_us_ = 0;
};

}  // namespace coach
