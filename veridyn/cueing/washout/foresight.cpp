#include "veridyn/cueing/washout/foresight.hpp"

#include <fmt/format.h>

#include <cmath>

namespace veridyn::cueing {

void ForesightAccount::add(double force, double expected, bool foreseen, double step) {
  time_ += step;
  if (foreseen) foreseen_time_ += step;
  while (count_ > 0 && kept_[first_].due <= time_) {
    const Expected& e = kept_[first_];
    squares_ += (e.force - force) * (e.force - force);
    held_squares_ += (e.held - force) * (e.held - force);
    ++compared_;
    first_ = (first_ + 1) % kKept;
    --count_;
  }
  if (!foreseen || count_ == kKept || time_ < last_kept_ + kBetween) return;
  kept_[(first_ + count_) % kKept] = {time_ + kAhead, expected, force};
  ++count_;
  last_kept_ = time_;
}

double ForesightAccount::missed() const {
  return compared_ > 0 ? std::sqrt(squares_ / static_cast<double>(compared_)) : 0.0;
}

double ForesightAccount::missed_held() const {
  return compared_ > 0 ? std::sqrt(held_squares_ / static_cast<double>(compared_)) : 0.0;
}

std::string ForesightAccount::text(const std::string& from) const {
  if (time_ < 1.0) return {};
  std::string text = fmt::format("{} foresaw {:.0f} % of the time", from, 100.0 * share());
  constexpr double kFelt = 0.17;  // [m/s^2]
  const bool misleads = missed() > kFelt && missed() > 1.05 * missed_held();
  if (compared_ > 0)
    text += fmt::format("; forces {:.2f} s ahead were missed by {:.2f} m/s^2 RMS, held ones by {:.2f}{}", kAhead,
                        missed(), missed_held(), misleads ? ": it misleads" : "");
  return text;
}

}  // namespace veridyn::cueing
