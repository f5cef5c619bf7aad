#include "veridyn/report/figures/track_panels.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::report {

Panel singular_value_panel(const aircraft::TrackHistory& history) {
  Panel panel{.label = "log10 singular values", .unit = "1"};
  const auto log10_of = [](std::vector<double> values) {
    for (double& v : values) v = v > 0.0 ? std::log10(v) : kNaN;
    return values;
  };
  for (std::size_t i = 0; i < history.singular_value.size(); ++i)
    panel.lines.push_back({.name = fmt::format("s{}", i + 1), .y = log10_of(history.singular_value[i])});
  panel.lines.push_back({.name = "threshold", .y = log10_of(history.threshold), .role = Role::kReference});
  return panel;
}

}  // namespace veridyn::report
