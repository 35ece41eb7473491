// Joins the messages that belong to one frame by equal utime.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

namespace coach {

/// A frame is a message of type Primary and, if all is well, one of each type of Companions; all have a field utime
/// (us). The frame is due when it is complete, or as soon as a later Primary has come: then it goes without what is
/// missing. Nothing depends on a clock: the same messages in the same order, with Next() called at the same places,
/// give the same frames.
///
/// If several frames are due the newest complete one is taken (the newest of all if none is complete), the older ones
/// are dropped and counted.
///
/// utime grows from frame to frame. A Primary that is not newer than the one before is dropped; but if three of them in
/// a row are over 1 s older and grow among themselves, the source has been started again: their time is accepted, and
/// the next frame is marked.
template <class Primary, class... Companions>
class FrameJoiner {
 public:
  struct Joined {
    Primary primary;
    std::tuple<std::unique_ptr<Companions>...> companions;  ///< null: missing
    bool complete = false;
    bool restarted = false;  ///< the first frame after the source was started again; utime is smaller than before
  };

  void Add(Primary message) {
    if (!InTime(message.utime)) {
      ++dropped_;
      return;
    }
    primaries_.push_back(std::move(message));
    if (primaries_.size() > kCapacity) {
      primaries_.pop_front();
      ++dropped_;
    }
  }

  template <class M>
  requires(std::is_same_v<M, Companions> || ...) void Add(M message) {
    auto& queue = std::get<std::deque<M>>(companions_);
    queue.push_back(std::move(message));
    if (queue.size() > kCapacity) queue.pop_front();
  }

  /// The frame that is due, if one is.
  std::optional<Joined> Next() {
    const std::optional<size_t> index = Due();
    if (!index) return std::nullopt;
    Joined joined;
    joined.primary = std::move(primaries_[*index]);
    joined.complete =
        (Take<Companions>(joined.primary.utime, std::get<std::unique_ptr<Companions>>(joined.companions)) & ... & true);
    joined.restarted = std::exchange(restarted_, false);
    incomplete_ += !joined.complete;
    dropped_ += static_cast<int64_t>(*index);
    primaries_.erase(primaries_.begin(), primaries_.begin() + static_cast<std::ptrdiff_t>(*index) + 1);
    return joined;
  }

  int64_t dropped() const { return dropped_; }        ///< Primaries that led to no frame
  int64_t incomplete() const { return incomplete_; }  ///< frames that went without a companion

 private:
  static constexpr size_t kCapacity = 8;
  static constexpr int64_t kRestart = 1'000'000;  // us
  static constexpr int kRestartFrames = 3;

  bool InTime(int64_t utime) {
    if (!last_ || utime > *last_) {
      last_ = utime;
      backwards_ = 0;
      return true;
    }
    const bool candidate = utime < *last_ - kRestart && (backwards_ == 0 || utime > last_backwards_);
    backwards_ = candidate ? backwards_ + 1 : 0;
    last_backwards_ = utime;
    if (backwards_ < kRestartFrames) return false;
    dropped_ += static_cast<int64_t>(primaries_.size());
    primaries_.clear();
    last_ = utime;
    backwards_ = 0;
    restarted_ = true;
    return true;
  }

  template <class M>
  auto Find(int64_t utime) {
    auto& queue = std::get<std::deque<M>>(companions_);
    return std::find_if(queue.begin(), queue.end(), [&](const M& m) { return m.utime == utime; });
  }
  template <class M>
  bool Has(int64_t utime) {
    return Find<M>(utime) != std::get<std::deque<M>>(companions_).end();
  }
  template <class M>
  bool Take(int64_t utime, std::unique_ptr<M>& out) {
    if (!Has<M>(utime)) return false;
    const auto place = Find<M>(utime);
    out = std::make_unique<M>(std::move(*place));
    std::get<std::deque<M>>(companions_).erase(place);
    return true;
  }

  std::optional<size_t> Due() {
    for (size_t i = primaries_.size(); i-- > 0;) {
      if ((Has<Companions>(primaries_[i].utime) && ...)) return i;
    }
    if (primaries_.size() < 2) return std::nullopt;
    return primaries_.size() - 2;
  }

  std::deque<Primary> primaries_;
  std::tuple<std::deque<Companions>...> companions_;
  std::optional<int64_t> last_;
  int backwards_ = 0;
  int64_t last_backwards_ = 0;
  bool restarted_ = false;
  int64_t dropped_ = 0, incomplete_ = 0;
};

}  // namespace coach
