#include "veridyn/estimation/open_loop/open_loop_scores.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::estimation {
namespace {

double median_of(std::vector<double> values) {
  std::ranges::sort(values);
  return values.empty() ? kNaN : numerics::quantile_of_sorted(values, 0.5);
}

OpenLoopState scored(const ModelOutput& output, const std::string& group, std::size_t column,
                     std::span<const OpenLoopForecast> forecasts) {
  const auto j = signed_index(column);
  OpenLoopState state{.name = output.name, .unit = shown_unit(output.unit), .group = group};
  const double factor = shown_factor(output.unit);
  std::vector<double> measured, predicted, horizons;
  double inside = 0.0;
  for (const OpenLoopForecast& f : forecasts) {
    if (f.window.group != group) continue;
    ++state.windows;
    const double horizon = f.window.horizon_s[column];
    horizons.push_back(horizon);
    if (!f.window.diverged && f.window.forecast_from + horizon >= f.window.span.end - 1e-6) ++state.held;
    for (Eigen::Index k = 0; k < f.measured.rows(); ++k) {
      const double t = f.time[k];
      const bool is_forecast = t >= f.window.forecast_from;
      state.time.push_back(t + f.shift_s);
      state.measured.push_back(f.measured(k, j));
      state.predicted.push_back(f.predicted(k, j));
      state.sigma.push_back(is_forecast ? f.sigma(k, j) : kNaN);
      if (!is_forecast || !std::isfinite(f.measured(k, j))) continue;
      measured.push_back(factor * f.measured(k, j));
      predicted.push_back(factor * f.predicted(k, j));
      if (std::abs(f.measured(k, j) - f.predicted(k, j)) <= numerics::kNormal95 * f.sigma(k, j)) inside += 1.0;
    }
    // A gap between windows, so that no line is drawn across the restart.
    state.time.push_back(f.time.back() + f.shift_s);
    for (auto* series : {&state.measured, &state.predicted, &state.sigma}) series->push_back(kNaN);
  }
  state.fit = numerics::fit_measures(measured, predicted);
  state.shares = numerics::theil_shares(measured, predicted);
  state.normalised_rmse = std::sqrt(std::max(0.0, 1.0 - state.fit.r2));
  state.inside = inside / std::max(1.0, static_cast<double>(measured.size()));
  state.horizon_s = median_of(std::move(horizons));
  return state;
}

}  // namespace

std::vector<OpenLoopState> open_loop_scores(std::span<const ModelOutput> outputs,
                                            std::span<const OpenLoopForecast> forecasts,
                                            std::span<const std::string> groups,
                                            const std::function<std::string(std::string_view)>& group_of) {
  std::vector<OpenLoopState> states;
  for (const std::string& group : groups) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      if (group_of(outputs[i].name) != group) continue;
      OpenLoopState state = scored(outputs[i], group, i, forecasts);
      if (state.fit.count > 0) states.push_back(std::move(state));
    }
  }
  return states;
}

void add_windows(std::span<const OpenLoopForecast> forecasts, OpenLoop& open_loop) {
  for (const OpenLoopForecast& f : forecasts) {
    open_loop.windows.push_back(f.window);
    open_loop.forecast_s += f.window.span.end - f.window.forecast_from;
  }
}

std::size_t diverged_windows(const OpenLoop& open_loop) {
  return static_cast<std::size_t>(std::ranges::count(open_loop.windows, true, &OpenLoopWindow::diverged));
}

}  // namespace veridyn::estimation
