#include "veridyn/report/figures/response_figures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace veridyn::report {
namespace {

using cueing::Cue;
using cueing::MaskPoint;
using cueing::ResponsePoint;

/// The number a whole turn away that is nearest to the one before [rad].
double near_to(double before, double phase) { return before + std::remainder(phase - before, kFullTurn); }

bool limits_phase(const std::vector<MaskPoint>& mask) {
  for (const MaskPoint& m : mask) {
    if (std::isfinite(m.least_phase) || std::isfinite(m.most_phase)) return true;
  }
  return false;
}

/// Two figures of a mask over frequency; a gain of at least zero is no limit.
struct MaskSide {
  double MaskPoint::*least;
  double MaskPoint::*most;
  double unit;
};

/// The mask shaded, and its edges. Between its points limits go straight over the frequency, not over its logarithm.
void add_mask(XYPlot& plot, const std::vector<MaskPoint>& mask, const MaskSide& side) {
  constexpr int kSteps = 24;
  XYArea area{.name = "mask"};
  for (std::size_t i = 0; i + 1 < mask.size(); ++i) {
    const MaskPoint &a = mask[i], &b = mask[i + 1];
    for (int k = i == 0 ? 0 : 1; k <= kSteps; ++k) {
      const double frequency = a.frequency * std::pow(b.frequency / a.frequency, static_cast<double>(k) / kSteps);
      const double share = (frequency - a.frequency) / (b.frequency - a.frequency);
      const auto at = [&](double MaskPoint::*limit) {
        const double low = a.*limit, high = b.*limit;
        return std::isfinite(low) && std::isfinite(high) ? (low + share * (high - low)) / side.unit : kNaN;
      };
      area.x.push_back(frequency);
      area.low.push_back(at(side.least));
      area.high.push_back(at(side.most));
    }
  }
  bool any = false;
  for (const auto* edge : {&area.low, &area.high}) {
    XYSeries line{.name = "edge of the mask", .role = Role::kReference, .style = Style::kLine};
    bool limits = false;
    for (std::size_t k = 0; k < edge->size(); ++k) {
      line.x.push_back(area.x[k]);
      line.y.push_back((*edge)[k]);
      limits = limits || (std::isfinite((*edge)[k]) && (*edge)[k] != 0.0);
    }
    if (!limits) continue;
    any = true;
    plot.series.push_back(std::move(line));
  }
  if (any) plot.areas.push_back(std::move(area));
}

XYPlot empty_plot(Cue cue, const char* what, const char* unit) {
  return {.title = fmt::format("{} of {}", what, name_of(cue)),
          .x = {"frequency", "rad/s"},
          .y = {what, unit},
          .log_x = true};
}

}  // namespace

Section response_section(const cueing::ResponseStudy& study, const cueing::CueingResult& result) {
  Section section{.title = "Gain and phase"};
  section.blocks.emplace_back(Paragraph{
      fmt::format("Of the whole chain, algorithm to rider, on sines of {:g} m/s^2 and {:g} deg/s. Markers are "
                  "where it was measured.",
                  study.options.force, study.options.rate / kDegree)});
  List outside{.tone = Tone::kWarning};
  std::vector<Block> plots;
  for (const Cue cue : cueing::kAllCues) {
    const auto mask = study.mask.find(cue);
    const bool wrapped = mask != study.mask.end() && limits_phase(mask->second);
    XYPlot gain = empty_plot(cue, "Gain", ""), phase = empty_plot(cue, "Phase", "deg");
    for (const cueing::AlgorithmResult& a : result.algorithms) {
      const auto found = a.response.find(cue);
      if (found == a.response.end()) continue;
      XYSeries g{.name = a.run.algorithm, .style = Style::kLine}, p = g;
      double last = 0.0;
      for (const ResponsePoint& r : found->second) {
        last = wrapped || p.x.empty() ? r.phase : near_to(last, r.phase);
        g.x.push_back(r.frequency);
        g.y.push_back(r.gain);
        p.x.push_back(r.frequency);
        p.y.push_back(last / kDegree);
      }
      // Points where it was measured: between them the response may be anything.
      for (auto [plot, line] : {std::pair(&gain, &g), std::pair(&phase, &p)}) {
        plot->series.push_back(*line);
        line->style = Style::kMarkers;
        plot->series.push_back(std::move(*line));
      }
      const auto out = a.outside_mask.find(cue);
      if (out == a.outside_mask.end() || out->second.empty()) continue;
      std::vector<std::string> at;
      for (const ResponsePoint& r : out->second) at.push_back(fmt::format("{:.3g}", r.frequency));
      outside.items.push_back(
          fmt::format("{}, {}: outside the mask at {} rad/s", name_of(cue), a.run.algorithm, fmt::join(at, ", ")));
    }
    if (gain.series.empty()) continue;
    if (mask != study.mask.end()) {
      add_mask(gain, mask->second, {&MaskPoint::least_gain, &MaskPoint::most_gain, 1.0});
      add_mask(phase, mask->second, {&MaskPoint::least_phase, &MaskPoint::most_phase, kDegree});
    }
    plots.emplace_back(std::move(gain));
    plots.emplace_back(std::move(phase));
  }
  if (!outside.items.empty()) {
    section.blocks.emplace_back(std::move(outside));
  } else if (!study.mask.empty()) {
    section.blocks.emplace_back(
        Paragraph{"Every algorithm is within the mask at the frequencies that were measured.", Tone::kNote});
  }
  for (Block& plot : plots) section.blocks.push_back(std::move(plot));
  return section;
}

}  // namespace veridyn::report
