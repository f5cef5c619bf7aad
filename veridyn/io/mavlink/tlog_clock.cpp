#include "veridyn/io/mavlink/tlog_clock.hpp"

#include <algorithm>
#include <cmath>

namespace veridyn::io::internal {
namespace {

/// A stamp that is so far before the latest is of a clock that restarted [s]; messages overtake each other by less.
constexpr double kRestart_s = 10.0;
/// Beyond it stamps count from 1970 [s].
constexpr double kSince1970_s = 1e9;
/// A message without a stamp is not so long after one that has one [s].
constexpr double kLongestGuess_s = 5.0;

/// To the nanosecond: sums of large stamps and delays hold no more, and a zero would have a sign.
double rounded(double t) { return 1e-9 * std::round(1e9 * t) + 0.0; }

}  // namespace

void SenderClock::add(double received, std::optional<double> own) {
  if (own) {
    const std::int32_t kind = *own > kSince1970_s ? 1 : 0;
    Clock& clock = clocks_[kind];
    if (clock.epochs.empty() || *own < clock.epochs.back().latest - kRestart_s)
      clock.epochs.push_back({received - *own, *own, *own});
    Epoch& epoch = clock.epochs.back();
    epoch.delay = std::min(epoch.delay, received - *own);
    epoch.latest = std::max(epoch.latest, *own);
    clock.received = received;
    clock.own = *own;
    last_kind_ = kind;
    packets_.push_back({*own, kind, clock.epochs.size() - 1});
    return;
  }
  if (last_kind_ >= 0) {
    const Clock& clock = clocks_[last_kind_];
    const double passed = received - clock.received;
    if (passed >= 0.0 && passed <= kLongestGuess_s) {
      packets_.push_back({clock.own + passed, last_kind_, clock.epochs.size() - 1});
      return;
    }
  }
  packets_.push_back({received, -1, 0});
}

std::vector<double> SenderClock::times() const {
  std::vector<double> times;
  times.reserve(packets_.size());
  for (const Packet& p : packets_)
    times.push_back(rounded(p.kind < 0 ? p.time : p.time + clocks_[p.kind].epochs[p.epoch].delay));
  return times;
}

std::vector<double> SenderClock::restarts() const {
  std::vector<double> moments;
  for (const Clock& clock : clocks_) {
    if (clock.epochs.size() <= moments.size() + 1) continue;
    moments.clear();
    for (std::size_t i = 1; i < clock.epochs.size(); ++i)
      moments.push_back(rounded(clock.epochs[i].first + clock.epochs[i].delay));
  }
  return moments;
}

}  // namespace veridyn::io::internal
