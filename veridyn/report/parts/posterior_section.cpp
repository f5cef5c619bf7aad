#include "veridyn/report/parts/posterior_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::report {
namespace {

using estimation::Parameter;
using estimation::PosteriorParameter;
using estimation::PosteriorSample;

constexpr int kBins = 30;
/// Points of the scatter picture.
constexpr Eigen::Index kMostPoints = 1500;

std::string unit_of(const std::string& unit) { return unit == "1" ? std::string() : unit; }

Table posterior_table(const PosteriorSample& s, std::span<const Parameter> parameters) {
  Table table{.title = "Posterior intervals",
              .columns = {{.name = "parameter", .align = Align::kLeft},
                          {.name = "median"},
                          {.name = "from", .group = "95 %, posterior"},
                          {.name = "to", .group = "95 %, posterior"},
                          {.name = "from", .group = "95 %, error bar"},
                          {.name = "to", .group = "95 %, error bar"},
                          {.name = "unit", .align = Align::kLeft}}};
  for (const PosteriorParameter& p : s.parameters) {
    const Parameter& estimate = parameters[p.parameter];
    table.rows.push_back({.cells = {text_cell(p.name), measured_cell(p.median, p.sd), measured_cell(p.low, p.sd),
                                    measured_cell(p.high, p.sd), measured_cell(estimate.low95, p.sd),
                                    measured_cell(estimate.high95, p.sd), text_cell(unit_of(p.unit))}});
  }
  return table;
}

/// Density of the draws as steps, and that of a normal distribution of the error bar.
XYPlot histogram(const PosteriorSample& s, std::size_t i, const Parameter& estimate) {
  const PosteriorParameter& p = s.parameters[i];
  const auto draws = s.ensemble.draws.col(i);
  const double low = draws.minCoeff(), width = (draws.maxCoeff() - low) / kBins;
  XYPlot plot{
      .title = p.name, .x = {.label = p.name, .unit = unit_of(p.unit)}, .y = {.label = "density"}, .height = 150};
  if (!(width > 0.0)) return plot;
  std::vector<double> count(kBins, 0.0);
  for (const double x : draws) count[std::min(kBins - 1, static_cast<int>((x - low) / width))] += 1.0;
  XYSeries steps{.name = "draws", .style = Style::kLine};
  for (int b = 0; b < kBins; ++b) {
    for (const int end : {b, b + 1}) {
      steps.x.push_back(low + end * width);
      steps.y.push_back(count[b] / (static_cast<double>(draws.size()) * width));
    }
  }
  plot.series.push_back(std::move(steps));
  if (std::isfinite(estimate.sigma) && estimate.sigma > 0.0) {
    XYSeries normal{.name = "error bar", .role = Role::kReference, .style = Style::kLine};
    for (int k = 0; k <= 60; ++k) {
      const double x = low + kBins * width * k / 60.0;
      normal.x.push_back(x);
      normal.y.push_back(std::exp(-0.5 * std::pow((x - estimate.value) / estimate.sigma, 2)) /
                         (estimate.sigma * std::sqrt(2.0 * kPi)));
    }
    plot.series.push_back(std::move(normal));
  }
  return plot;
}

/// The two whose draws are correlated most.
XYPlot closest_pair(const PosteriorSample& s) {
  XYPlot plot{.title = "The two that go together most"};
  const auto n = signed_index(s.parameters.size());
  double largest = 0.0;
  Eigen::Index first = 0, second = 1;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i + 1; j < n; ++j) {
      const Eigen::ArrayXd a = s.ensemble.draws.col(i).array() - s.parameters[i].mean;
      const Eigen::ArrayXd b = s.ensemble.draws.col(j).array() - s.parameters[j].mean;
      const double correlation = (a * b).mean() / (s.parameters[i].sd * s.parameters[j].sd);
      if (!(std::abs(correlation) > std::abs(largest))) continue;
      largest = correlation;
      first = i;
      second = j;
    }
  }
  plot.caption = fmt::format("Correlation {:.2f}.", largest);
  const PosteriorParameter &x = s.parameters[first], &y = s.parameters[second];
  plot.x = {.label = x.name, .unit = unit_of(x.unit)};
  plot.y = {.label = y.name, .unit = unit_of(y.unit)};
  XYSeries points{.name = "draws", .width = 2.0, .opacity = 0.4};
  const Eigen::Index every = std::max<Eigen::Index>(1, s.ensemble.draws.rows() / kMostPoints);
  for (Eigen::Index row = 0; row < s.ensemble.draws.rows(); row += every) {
    points.x.push_back(s.ensemble.draws(row, first));
    points.y.push_back(s.ensemble.draws(row, second));
  }
  plot.series.push_back(std::move(points));
  return plot;
}

}  // namespace

Section posterior_section(const PosteriorSample& s, std::span<const Parameter> parameters) {
  Section section{.title = "Posterior", .id = "posterior"};
  if (!s.usable()) return section;
  section.blocks.emplace_back(Paragraph{
      .text = fmt::format("Draws of all unknowns together, by what the measurements and the priors allow; the noise is "
                          "taken for white. {}.",
                          s.ensemble.message),
      .tone = s.ensemble.converged ? Tone::kPlain : Tone::kWarning});
  section.blocks.emplace_back(posterior_table(s, parameters));
  for (std::size_t i = 0; i < s.parameters.size(); ++i)
    section.blocks.emplace_back(histogram(s, i, parameters[s.parameters[i].parameter]));
  if (s.parameters.size() > 1) section.blocks.emplace_back(closest_pair(s));
  return section;
}

}  // namespace veridyn::report
