#include "veridyn/io/log/clock_restarts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"

namespace veridyn::io {
namespace {

/// Stamps in a row that follow each other and are trusted, and at the end of a log.
constexpr int kStampsAreSure = 32, kLastStampsAreSure = 8;

}  // namespace

void ClockRestarts::add_away(double stamp, std::uint64_t place) {
  // No clock counts from before it was switched on.
  if (!std::isfinite(stamp) || stamp < 0.0) return;
  if (stamp < away_.latest - kBack_s || stamp > away_.latest + kAhead_s) {
    // What was logged at power-on, then the flight: both are back, and of one clock.
    const bool both_back = away_.earliest < latest_ - kBack_s && stamp < latest_ - kBack_s;
    if (!both_back) away_ = {.place = place};
    away_.latest = stamp;
    away_.count = 0;
  }
  ++away_.count;
  away_.earliest = std::min(away_.earliest, stamp);
  away_.latest = std::max(away_.latest, stamp);
  if (away_.count >= kStampsAreSure) accept();
}

void ClockRestarts::accept() {
  if (away_.earliest < latest_ - kBack_s) {
    const double before = latest_ + (restarts_.empty() ? 0.0 : restarts_.back().shift);
    restarts_.push_back({away_.place, away_.earliest, before + kRestartPause_s - away_.earliest});
  }
  latest_ = away_.latest;
  away_ = {};
}

void ClockRestarts::finish() {
  if (away_.count >= kLastStampsAreSure) accept();
}

double ClockRestarts::shift_at(std::uint64_t place) const {
  const auto next = std::ranges::upper_bound(restarts_, place, {}, &Restart::place);
  return next == restarts_.begin() ? 0.0 : (next - 1)->shift;
}

void ClockRestarts::shift(std::span<double> stamps, std::span<const std::uint64_t> places) const {
  VERIDYN_ASSERT(stamps.size() == places.size());
  if (restarts_.empty()) return;
  for (std::size_t i = 0; i < stamps.size(); ++i) stamps[i] += shift_at(places[i]);
}

void ClockRestarts::report_to(Log& log) const {
  if (restarts_.empty()) return;
  for (const Restart& restart : restarts_) log.restarts.push_back(restart.first + restart.shift);
  log.damage.notes.push_back(fmt::format(
      "its clock restarts {} time{}: times go on {:g} s after what came before, and the real pauses are not known",
      restarts_.size(), restarts_.size() == 1 ? "" : "s", kRestartPause_s));
}

}  // namespace veridyn::io
