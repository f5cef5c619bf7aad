#pragma once

#include <cstdint>

namespace veridyn::live {

/// What a frame's sequence number says about it.
enum class SequenceVerdict {
  kNewer,      ///< the newest so far
  kLate,       ///< older than the newest, and not seen before
  kDuplicate,  ///< seen before
  kTooOld,     ///< older than the first, or 64 or more older than the newest: whether it was seen is not known
};

/// Counts the frames of one sender by their sequence numbers, modulo 2^32: what came, what did not, and what came twice
/// or late. The first one is where counting begins.
class SequenceCounter {
 public:
  SequenceVerdict take(std::uint32_t sequence);
  void reset() { *this = {}; }

  [[nodiscard]] bool empty() const { return received_ == 0; }
  [[nodiscard]] std::uint32_t newest() const { return newest_; }
  /// Different ones that came.
  [[nodiscard]] std::uint64_t received() const { return received_; }
  /// From the first to the newest, those that did not come; one that comes late is lost until then.
  [[nodiscard]] std::uint64_t lost() const { return spanned_ - received_; }
  [[nodiscard]] std::uint64_t duplicates() const { return duplicates_; }
  [[nodiscard]] std::uint64_t late() const { return late_; }
  [[nodiscard]] std::uint64_t too_old() const { return too_old_; }

 private:
  std::uint32_t newest_ = 0;
  std::uint64_t seen_ = 0;     ///< bit k: `newest_ - k` was seen
  std::uint64_t spanned_ = 0;  ///< from the first to the newest
  std::uint64_t received_ = 0, duplicates_ = 0, late_ = 0, too_old_ = 0;
};

}  // namespace veridyn::live
