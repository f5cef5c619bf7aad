#include "veridyn/report/figures/time_range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

namespace veridyn::report {
namespace {

using Runs = std::vector<std::pair<std::size_t, std::size_t>>;  // [first, last) of the samples kept

Runs runs_within(const std::vector<double>& x, std::span<const Window> ranges) {
  Runs runs;
  for (const Window& range : ranges) {
    const auto first = std::ranges::lower_bound(x, range.from), last = std::ranges::upper_bound(x, range.to);
    if (first < last)
      runs.emplace_back(static_cast<std::size_t>(first - x.begin()), static_cast<std::size_t>(last - x.begin()));
  }
  return runs;
}

void keep(std::vector<double>& values, const Runs& runs) {
  std::vector<double> kept;
  for (const auto& [first, last] : runs)
    for (std::size_t k = first; k < std::min(last, values.size()); ++k) kept.push_back(values[k]);
  values = std::move(kept);
}

}  // namespace

void keep_within(TimeSeries& figure, std::span<const Window> ranges) {
  if (ranges.empty()) return;
  const Runs shared = runs_within(figure.samples, ranges);
  for (Panel& panel : figure.panels) {
    for (Line& line : panel.lines) {
      const Runs runs = line.x.empty() ? shared : runs_within(line.x, ranges);
      keep(line.y, runs);
      if (line.band) {
        keep(line.band->low, runs);
        keep(line.band->high, runs);
      }
      if (!line.x.empty()) keep(line.x, runs);
    }
  }
  keep(figure.samples, shared);
  std::erase_if(figure.spans,
                [&](const Span& span) { return span.to <= ranges.front().from || span.from >= ranges.back().to; });
  for (Span& span : figure.spans) {
    span.from = std::max(span.from, ranges.front().from);
    span.to = std::min(span.to, ranges.back().to);
  }
}

TimeSeries in_longest_windows(TimeSeries figure, std::size_t most, double longest) {
  std::vector<Window>& windows = figure.windows;
  const std::size_t all = windows.size();
  std::string left_out;
  if (all > most) {
    std::ranges::stable_sort(windows, {}, [](const Window& w) { return w.from - w.to; });
    windows.resize(most);
    std::ranges::sort(windows, {}, &Window::from);
    left_out = fmt::format("The {} longest of {} stretches", most, all);
  }
  bool cut = false;
  for (Window& window : windows) {
    cut = cut || window.to - window.from > longest;
    window.to = std::min(window.to, window.from + longest);
  }
  if (cut)
    left_out += fmt::format("{} {:g} {} of each at most", left_out.empty() ? "The first" : ", the first", longest,
                            figure.x.unit);
  if (!left_out.empty())
    figure.caption += fmt::format("{}{}; all are further down.", figure.caption.empty() ? "" : " ", left_out);
  keep_within(figure, windows);
  return figure;
}

void show_range(Section& section, const Window& range, const std::string& axis) {
  for (Block& block : section.blocks) {
    TimeSeries* figure = std::get_if<TimeSeries>(&block);
    if (figure == nullptr || !figure->windows.empty()) continue;
    keep_within(*figure, std::span(&range, 1));
    figure->axis = axis;
  }
}

}  // namespace veridyn::report
