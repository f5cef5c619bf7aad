#include "veridyn/report/parts/profile_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::report {
namespace {

using estimation::Parameter;
using estimation::ParameterProfile;
using estimation::ProfileEnd;
using estimation::ProfilePoint;
using estimation::ProfileResult;

/// Statistics beyond so many thresholds are not drawn.
constexpr double kTop = 2.0;

std::string shown_unit(const std::string& unit) { return unit == "1" ? std::string() : unit; }

Cell end_cell(ProfileEnd end, double value, double sigma) {
  return end == ProfileEnd::kClosed ? measured_cell(value, sigma)
                                    : status_cell(Status::kCaution, std::string(to_string(end)));
}

Table interval_table(const ProfileResult& result, std::span<const Parameter> parameters) {
  Table table{.title = "Profile intervals",
              .columns = {{.name = "parameter", .align = Align::kLeft},
                          {.name = "value"},
                          {.name = "from", .group = "95 %, profile"},
                          {.name = "to", .group = "95 %, profile"},
                          {.name = "from", .group = "95 %, error bar"},
                          {.name = "to", .group = "95 %, error bar"},
                          {.name = "unit", .align = Align::kLeft}}};
  for (const ParameterProfile& p : result.profiles) {
    const Parameter& estimate = parameters[p.parameter];
    table.rows.push_back(
        {.cells = {text_cell(p.name), measured_cell(p.value, estimate.sigma),
                   end_cell(p.low_end, p.low, estimate.sigma), end_cell(p.high_end, p.high, estimate.sigma),
                   measured_cell(estimate.low95, estimate.sigma), measured_cell(estimate.high95, estimate.sigma),
                   text_cell(shown_unit(p.unit))}});
  }
  return table;
}

/// The curve between the points: the signed root of the statistic is nearly a straight line there.
XYSeries curve_of(const ParameterProfile& p, double top) {
  XYSeries curve{.name = "profile", .style = Style::kLine};
  constexpr int kBetween = 12;
  const auto root = [&](const ProfilePoint& q) {
    return (q.value < p.value ? -1.0 : 1.0) * std::sqrt(std::max(0.0, q.statistic));
  };
  const auto add = [&](double x, double y) {
    if (y > top) return;
    curve.x.push_back(x);
    curve.y.push_back(y);
  };
  for (std::size_t i = 0; i + 1 < p.points.size(); ++i) {
    const ProfilePoint &a = p.points[i], &b = p.points[i + 1];
    for (int k = 0; k < kBetween; ++k) {
      const double share = static_cast<double>(k) / kBetween;
      add(a.value + share * (b.value - a.value), std::pow(root(a) + share * (root(b) - root(a)), 2));
    }
  }
  if (!p.points.empty()) add(p.points.back().value, std::max(0.0, p.points.back().statistic));
  return curve;
}

XYPlot profile_plot(const ParameterProfile& p, const Parameter& estimate, double threshold) {
  const double top = kTop * threshold;
  XYPlot plot{.title = p.name,
              .x = {.label = p.name, .unit = shown_unit(p.unit)},
              .y = {.label = "likelihood ratio"},
              .height = 200};
  plot.caption = p.text();
  if (std::isfinite(estimate.sigma) && estimate.sigma > 0.0) {
    XYSeries parabola{.name = "error bar", .role = Role::kReference, .style = Style::kLine};
    constexpr int kPoints = 60;
    const double reach = std::sqrt(top) * estimate.sigma;
    for (int k = 0; k <= kPoints; ++k) {
      const double x = estimate.value + reach * (2.0 * k / kPoints - 1.0);
      if (x < p.low_bound || x > p.high_bound) continue;
      parabola.x.push_back(x);
      parabola.y.push_back(std::pow((x - estimate.value) / estimate.sigma, 2));
    }
    plot.series.push_back(std::move(parabola));
  }
  plot.series.push_back(curve_of(p, top));
  XYSeries fits{.name = "fits"};
  for (const ProfilePoint& q : p.points) {
    if (q.statistic > top) continue;
    fits.x.push_back(q.value);
    fits.y.push_back(std::max(0.0, q.statistic));
  }
  plot.series.push_back(std::move(fits));
  plot.guides.push_back({.value = threshold, .label = "95 %"});
  if (p.low_end == ProfileEnd::kOpen)
    plot.guides.push_back({.direction = Guide::Direction::kVertical, .value = p.low_bound, .label = "bound: open"});
  if (p.high_end == ProfileEnd::kOpen)
    plot.guides.push_back({.direction = Guide::Direction::kVertical, .value = p.high_bound, .label = "bound: open"});
  return plot;
}

/// Along which profile another parameter goes furthest, both in standard deviations.
std::optional<XYPlot> valley_plot(const ProfileResult& result, std::span<const Parameter> parameters) {
  const ParameterProfile* worst = nullptr;
  Eigen::Index other = 0;
  double furthest = 0.0;
  for (const ParameterProfile& p : result.profiles) {
    for (Eigen::Index j = 0; j < signed_index(parameters.size()); ++j) {
      const double sigma = parameters[j].sigma;
      if (at(j) == p.parameter || !(sigma > 0.0 && std::isfinite(sigma))) continue;
      double least = kInfinity, most = -kInfinity;
      for (const ProfilePoint& q : p.points) {
        if (q.statistic > kTop * result.threshold) continue;
        least = std::min(least, q.theta(j));
        most = std::max(most, q.theta(j));
      }
      if ((most - least) / sigma > furthest) {
        furthest = (most - least) / sigma;
        worst = &p;
        other = j;
      }
    }
  }
  if (worst == nullptr) return std::nullopt;
  const Parameter& along = parameters[other];
  XYPlot plot{.title = "The valley",
              .caption = fmt::format("Where {} goes as {} is moved: no other pair makes up for each other as much.",
                                     along.name, worst->name),
              .x = {.label = worst->name, .unit = shown_unit(worst->unit)},
              .y = {.label = along.name, .unit = shown_unit(along.unit)},
              .height = 240};
  XYSeries line{.name = "best fits", .style = Style::kLine}, fits{.name = "within 95 %"};
  for (const ProfilePoint& q : worst->points) {
    if (q.statistic > kTop * result.threshold) continue;
    line.x.push_back(q.value);
    line.y.push_back(q.theta(other));
    if (q.statistic > result.threshold) continue;
    fits.x.push_back(q.value);
    fits.y.push_back(q.theta(other));
  }
  plot.series = {std::move(line), std::move(fits)};
  return plot;
}

}  // namespace

Section profile_section(const ProfileResult& result, std::span<const Parameter> parameters, const std::string& note) {
  Section section{.title = "Profile likelihood", .id = "profiles"};
  if (!result.message.empty()) section.blocks.emplace_back(Paragraph{result.message, Tone::kWarning});
  if (result.profiles.empty()) return section;
  section.blocks.emplace_back(Paragraph{
      "One parameter is moved and all others are fitted again, priors included. The interval holds the values whose "
      "likelihood ratio stays below the line; where the curve is no parabola, error bars mislead. Open: not even the "
      "parameter's bound is excluded. Dashed: what the error bar says."});
  if (!note.empty()) section.blocks.emplace_back(Paragraph{note});
  if (result.gain > 0.1)
    section.blocks.emplace_back(Paragraph{
        fmt::format("On the way a better fit was found, by {:.2g} of the likelihood ratio: profiles are about "
                    "that one, and values there differ from those of the table of parameters.",
                    result.gain),
        Tone::kWarning});
  section.blocks.emplace_back(interval_table(result, parameters));
  for (const ParameterProfile& p : result.profiles)
    section.blocks.emplace_back(profile_plot(p, parameters[p.parameter], result.threshold));
  if (std::optional<XYPlot> valley = valley_plot(result, parameters)) section.blocks.emplace_back(std::move(*valley));
  return section;
}

}  // namespace veridyn::report
