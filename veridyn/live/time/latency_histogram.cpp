#include "veridyn/live/time/latency_histogram.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::live {
namespace {

constexpr double kShortest = 1e-7;  // [s]

}  // namespace

void LatencyHistogram::add(Nanoseconds time) {
  time = std::max<Nanoseconds>(time, 0);
  const double s = seconds(time);
  std::size_t bin = 0;
  if (s > kShortest) {
    const double place = std::ceil(kPerDecade * std::log10(s / kShortest) - 1e-9);
    bin = std::min(static_cast<std::size_t>(std::max(place, 1.0)), kBins - 1);
  }
  ++bins_[bin];
  ++count_;
  largest_ = std::max(largest_, time);
  sum_ += s;
}

double LatencyHistogram::mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : kNaN; }

double LatencyHistogram::quantile(double share) const {
  if (count_ == 0) return kNaN;
  const double wanted = share * static_cast<double>(count_);
  double below = 0.0;
  for (std::size_t i = 0; i < kBins; ++i) {
    below += static_cast<double>(bins_[i]);
    if (below >= wanted) return std::min(upper_edge(i), seconds(largest_));
  }
  return seconds(largest_);
}

double LatencyHistogram::upper_edge(std::size_t bin) {
  return bin + 1 >= kBins ? kInfinity : kShortest * std::pow(10.0, static_cast<double>(bin) / kPerDecade);
}

}  // namespace veridyn::live
