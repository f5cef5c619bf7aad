#include "veridyn/cueing/score/tuning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/quiet_progress.hpp"
#include "veridyn/estimation/search/pattern_search.hpp"

namespace veridyn::cueing {
namespace {

/// One coordinate of the search: a number of a knob, or all of its numbers, then all the same.
struct Coordinate {
  std::size_t knob, first, count;
  bool logarithmic;
  double low, high;
  [[nodiscard]] double of(double value) const { return logarithmic ? std::log(std::max(value, 1e-9)) : value; }
};

std::vector<Coordinate> coordinates(const std::vector<Knob>& knobs, bool together) {
  std::vector<Coordinate> all;
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    const Knob& knob = knobs[k];
    if (!(knob.tune_to > knob.tune_from)) continue;
    const bool logarithmic = knob.tune_from > 0.0;
    const std::size_t count = together ? knob.values.size() : 1;
    for (std::size_t i = 0; i < knob.values.size(); i += count) {
      Coordinate c{k, i, count, logarithmic, 0.0, 0.0};
      c.low = c.of(knob.tune_from);
      c.high = c.of(knob.tune_to);
      all.push_back(c);
    }
  }
  return all;
}

void turn(WashoutDesign& design, const std::vector<Coordinate>& to, const Eigen::VectorXd& x) {
  const std::vector<Knob> knobs = design.knobs();
  for (std::size_t i = 0; i < to.size(); ++i) {
    const double v = x(i);
    const auto values = knobs[to[i].knob].values.subspan(to[i].first, to[i].count);
    std::fill(values.begin(), values.end(), to[i].logarithmic ? std::exp(v) : v);
  }
}

/// A first look along the gains: a small platform is often driven far too hard, and from there no small turn of a knob
/// helps.
void halve_gains(Tuning& result, const std::function<double(const WashoutDesign&)>& cost_of, std::size_t evaluations,
                 const Progress& progress) {
  constexpr int kHalvings = 4;
  for (const char* name : {"force_gain", "rate_gain"}) {
    const std::unique_ptr<WashoutDesign> from = result.design->clone();
    for (int k = 1; k <= kHalvings && result.evaluations + 1 < evaluations && !progress.interrupted(); ++k) {
      const std::unique_ptr<WashoutDesign> less = from->clone();
      bool has_it = false;
      for (const Knob& knob : less->knobs()) {
        if (knob.name != name) continue;
        has_it = true;
        for (double& gain : knob.values) gain *= std::pow(0.5, k);
      }
      if (!has_it) break;
      ++result.evaluations;
      const double cost = cost_of(*less);
      if (!(cost < result.cost_after)) continue;
      result.cost_after = cost;
      result.design = less->clone();
    }
  }
}

}  // namespace

double tuning_cost(const CueingRun& run, const FeltMotion& felt, const TuningOptions& options) {
  double cost = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < kCues; ++i) {
    const CuePair& pair = felt.felt[i];
    const auto n = static_cast<double>(pair.vehicle.size());
    double v = 0.0, p = 0.0, vv = 0.0, pp = 0.0, vp = 0.0, largest = 0.0;
    for (std::size_t k = 0; k < pair.vehicle.size(); ++k) {
      v += pair.vehicle[k] / n;
      p += pair.platform[k] / n;
      largest = std::max(largest, std::abs(pair.vehicle[k]));
    }
    if (largest < felt.threshold[i]) continue;
    for (std::size_t k = 0; k < pair.vehicle.size(); ++k) {
      vv += std::pow(pair.vehicle[k] - v, 2);
      pp += std::pow(pair.platform[k] - p, 2);
      vp += (pair.vehicle[k] - v) * (pair.platform[k] - p);
    }
    const double r = pp > 0.0 ? vp / std::sqrt(vv * pp) : 0.0, s = std::sqrt(pp / vv);
    cost += options.weights[i] * (1.0 - r + 0.5 * std::max({0.0, 1.0 - s / options.strength, s - 1.0}));
    weights += options.weights[i];
  }
  double limited = 0.0;
  for (const CueingStep& s : run.steps) limited += s.limited.any() ? 1.0 : 0.0;
  const double samples = std::max(1.0, static_cast<double>(run.steps.size()));
  return (weights > 0.0 ? cost / weights : 0.0) + options.limited * limited / samples;
}

Tuning tuned(const WashoutDesign& design, const Platform& platform, const std::vector<recording::MotionSample>& drive,
             const VestibularModel& model, const MotionThresholds& thresholds, const TuningOptions& options,
             Progress& progress) {
  Tuning result;
  result.design = design.clone();
  const auto cost_of = [&](const WashoutDesign& of) {
    QuietProgress quiet(progress);
    const CueingRun run = drive_platform(drive, *of.make(platform), platform, quiet);
    return tuning_cost(run, felt_motion(run, model, thresholds), options);
  };
  result.cost_before = result.cost_after = cost_of(design);
  halve_gains(result, cost_of, options.evaluations, progress);
  // All numbers of a knob together first: gains of three axes are wrong by the same factor more often than not, and the
  // search is shorter by half. Then each by itself.
  for (const bool together : {true, false}) {
    const std::vector<Knob> knobs = result.design->knobs();
    const std::vector<Coordinate> to = coordinates(knobs, together);
    const auto n = signed_index(to.size());
    const std::size_t left = options.evaluations - result.evaluations, allowed = together ? left / 2 : left;
    if (n == 0 || allowed == 0 || result.interrupted) break;
    estimation::BlackBoxProblem problem{.name = "washout", .low = Eigen::VectorXd(n), .high = Eigen::VectorXd(n)};
    Eigen::VectorXd start(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Coordinate& c = to[i];
      problem.names.push_back(fmt::format("{}[{}]", knobs[c.knob].name, c.first));
      problem.low(i) = c.low;
      problem.high(i) = c.high;
      start(i) = std::clamp(c.of(knobs[c.knob].values[c.first]), c.low, c.high);
    }
    problem.evaluate = [&](const Eigen::VectorXd& x) {
      const std::unique_ptr<WashoutDesign> turned = result.design->clone();
      turn(*turned, to, x);
      try {
        return estimation::SearchValues{.objective = cost_of(*turned)};
      } catch (const InputError&) {
        return estimation::SearchValues{};  // no such filter
      }
    };
    estimation::BatchEvaluator evaluator(problem, {.max_evaluations = allowed}, progress);
    const estimation::SearchResult found =
        estimation::pattern_search(evaluator, start, {.initial_mesh = together ? 0.25 : 0.12, .tolerance = 1e-3});
    result.evaluations += found.evaluations;
    result.interrupted = found.termination == estimation::SearchTermination::kInterrupted;
    if (!(found.values.objective < result.cost_after)) continue;
    result.cost_after = found.values.objective;
    turn(*result.design, to, found.x);
  }
  const std::vector<Knob> knobs = result.design->knobs();
  const std::unique_ptr<WashoutDesign> before = design.clone();
  const std::vector<Knob> old = before->knobs();
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    const std::vector<double> was(old[k].values.begin(), old[k].values.end()),
        is(knobs[k].values.begin(), knobs[k].values.end());
    if (was != is) result.knobs.push_back({knobs[k].name, knobs[k].unit, was, is});
  }
  return result;
}

}  // namespace veridyn::cueing
