#include "veridyn/live/telemetry/sender_clock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::live {
namespace {

constexpr double kBlockLength = 1.0;  // [s]
/// The offset in use moves by this at most in a second: motion is never visibly stretched.
constexpr double kSlew = 2e-3;
/// Blocks whose least offset is in use: long enough to hold a quick packet, short enough to follow a drift of 100 ppm
/// to half a millisecond.
constexpr std::size_t kInUse = 5;

}  // namespace

void SenderClock::add(double stamp, Nanoseconds arrival) {
  const double offset = seconds(arrival) - stamp;
  if (!begun_) {
    begun_ = true;
    current_ = {stamp, offset};
    block_begin_ = last_ = stamp;
    offset_ = offset;
    return;
  }
  if (stamp - block_begin_ >= kBlockLength) {
    blocks_[count_ % kBlocks] = current_;
    ++count_;
    block_begin_ = stamp;
    current_ = {stamp, offset};
  } else if (offset < current_.offset) {
    current_ = {stamp, offset};
  }
  double least = current_.offset;
  for (std::size_t k = 0; k < std::min(count_, kInUse); ++k)
    least = std::min(least, blocks_[(count_ - 1 - k) % kBlocks].offset);
  const double most = kSlew * std::max(stamp - last_, 0.0);
  // In the first second every quicker packet counts at once.
  offset_ = count_ == 0 ? std::min(offset_, least) : offset_ + std::clamp(least - offset_, -most, most);
  last_ = stamp;
}

double SenderClock::drift() const {
  constexpr std::size_t kFewest = 10;
  const std::size_t n = std::min(count_, kBlocks);
  if (n < kFewest) return kNaN;
  double t0 = 0.0, y0 = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    t0 += blocks_[k].at;
    y0 += blocks_[k].offset;
  }
  t0 /= static_cast<double>(n);
  y0 /= static_cast<double>(n);
  double tt = 0.0, ty = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double t = blocks_[k].at - t0;
    tt += t * t;
    ty += t * (blocks_[k].offset - y0);
  }
  return tt > 0.0 ? ty / tt : kNaN;
}

std::string drift_warning(double drift) {
  constexpr double kUsualDrift = 100e-6;
  if (!(std::abs(drift) > kUsualDrift)) return "";
  return fmt::format(
      "the sender's clock runs {:.0f} ppm {} against ours: its stamps are followed, but one of the two clocks is poor",
      std::abs(drift) * 1e6, drift < 0.0 ? "fast" : "slow");
}

}  // namespace veridyn::live
