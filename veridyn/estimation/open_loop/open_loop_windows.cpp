#include "veridyn/estimation/open_loop/open_loop_windows.hpp"

#include <algorithm>

#include "veridyn/core/constants.hpp"

namespace veridyn::estimation {

std::vector<TimeSpan> unseen(std::span<const TimeSpan> stretches, std::span<const TimeSpan> seen) {
  std::vector<TimeSpan> left;
  for (TimeSpan span : stretches) {
    for (const TimeSpan& s : seen) {
      if (s.end <= span.begin || s.begin >= span.end) continue;
      if (s.begin > span.begin) left.push_back({span.begin, s.begin});
      span.begin = std::max(span.begin, s.end);
    }
    if (span.end > span.begin) left.push_back(span);
  }
  return left;
}

std::vector<TimeSpan> open_loop_windows(std::span<const TimeSpan> excited, std::span<const TimeSpan> free,
                                        const OpenLoopTimes& times) {
  const double shortest = times.start_s + kLeastForecast_s;
  std::vector<TimeSpan> windows;
  double next = -kInfinity;
  for (const TimeSpan& span : excited) {
    double begin = std::max(span.begin, next);
    while (begin + shortest <= span.end) {
      double end = span.end;
      for (const TimeSpan& f : free)
        if (f.begin <= begin && f.end >= begin) end = std::max(end, f.end);
      end = std::min(end, begin + times.duration_s);
      if (end - begin < shortest) break;
      windows.push_back({begin, end});
      next = begin = end;
    }
  }
  return windows;
}

}  // namespace veridyn::estimation
