#include "veridyn/live/teleoperation/sequence_counter.hpp"

namespace veridyn::live {

SequenceVerdict SequenceCounter::take(std::uint32_t sequence) {
  // Ahead by less than half of all numbers is newer.
  const std::uint32_t ahead = sequence - newest_;
  if (empty() || (ahead != 0 && ahead < 0x8000'0000U)) {
    const std::uint32_t step = empty() ? 1 : ahead;
    seen_ = (step < 64 ? seen_ << step : 0) | 1U;
    spanned_ += step;
    newest_ = sequence;
    ++received_;
    return SequenceVerdict::kNewer;
  }
  const std::uint32_t behind = newest_ - sequence;
  // Older than the first one would be lost less than none.
  if (behind >= 64 || behind >= spanned_) {
    ++too_old_;
    return SequenceVerdict::kTooOld;
  }
  const std::uint64_t bit = std::uint64_t{1} << behind;
  if ((seen_ & bit) != 0) {
    ++duplicates_;
    return SequenceVerdict::kDuplicate;
  }
  seen_ |= bit;
  ++received_;
  ++late_;
  return SequenceVerdict::kLate;
}

}  // namespace veridyn::live
