#include "veridyn/estimation/open_loop/open_loop.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::estimation {

const KeyTable<OpenLoopTimes>& OpenLoopTimes::keys() {
  using O = OpenLoopTimes;
  static const auto table =
      KeyTable<O>("validate")
          .number("open_loop", &O::duration_s, "s", kPositive,
                  "the model is run in windows of this length at most, by what is commanded alone")
          .otherwise("none")
          .number(
              "open_loop_start", &O::start_s, "s", kPositive,
              "of each window: its initial state and the offsets are estimated from it; what comes after is forecast")
          .check([](const StudyTable& t, O& o) {
            if (o.duration_s > 0.0 && !(o.duration_s > o.start_s))
              t.fail("open_loop", fmt::format("= {} s must be longer than open_loop_start = {} s, from which the "
                                              "initial state is estimated",
                                              o.duration_s, o.start_s));
          });
  return table;
}

std::vector<std::string> OpenLoop::groups() const {
  std::vector<std::string> groups;
  for (const OpenLoopState& state : states)
    if (std::ranges::find(groups, state.group) == groups.end()) groups.push_back(state.group);
  return groups;
}

std::string open_loop_name(const OpenLoopState& state) { return "open_loop." + state.name; }

void add_open_loop(const OpenLoop& open_loop, Estimate& estimate) {
  for (const OpenLoopState& state : open_loop.states) {
    const std::string name = open_loop_name(state);
    estimate.validation[name] = {state.fit.mae, state.fit.rmse, state.fit.r2, state.fit.theil, state.unit};
    estimate.fit[name + ".normalised_rmse"] = state.normalised_rmse;
    estimate.fit[name + ".theil_bias"] = state.shares.bias;
    estimate.fit[name + ".theil_variance"] = state.shares.variance;
    estimate.fit[name + ".theil_covariance"] = state.shares.covariance;
    estimate.fit[name + ".inside_bands"] = state.inside;
    estimate.fit[name + ".horizon_s"] = state.horizon_s;
  }
}

std::string shown_unit(std::string_view unit) {
  return std::string(unit == "rad" ? "deg" : unit == "rad/s" ? "deg/s" : unit);
}

double shown_factor(std::string_view unit) { return unit == "rad" || unit == "rad/s" ? 1.0 / kDegree : 1.0; }

std::string si_unit(const OpenLoopState& state) {
  return state.unit == "deg" ? "rad" : state.unit == "deg/s" ? "rad/s" : state.unit;
}

double shown_factor(const OpenLoopState& state) { return shown_factor(si_unit(state)); }

}  // namespace veridyn::estimation
