#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace veridyn::live {

/// Hands the newest value from one thread to another: neither ever waits, and a value is always seen whole. What the
/// reader was too slow for is passed over.
template <typename T>
class TripleBuffer {
 public:
  explicit TripleBuffer(const T& begin = T{}) { values_.fill(begin); }

  /// By the writing thread: the place to write, then `publish`.
  [[nodiscard]] T& to_write() { return values_[writes_]; }
  void publish() { writes_ = shared_.exchange(writes_ | kNew, std::memory_order_acq_rel) & kPlace; }

  /// By the reading thread. @return whether there is a newer value than before
  bool update() {
    if ((shared_.load(std::memory_order_relaxed) & kNew) == 0) return false;
    reads_ = shared_.exchange(reads_, std::memory_order_acq_rel) & kPlace;
    return true;
  }
  [[nodiscard]] const T& value() const { return values_[reads_]; }

 private:
  static constexpr std::uint32_t kPlace = 3, kNew = 4;
  std::array<T, 3> values_;
  std::uint32_t writes_ = 0, reads_ = 1;
  std::atomic<std::uint32_t> shared_{2};
};

}  // namespace veridyn::live
