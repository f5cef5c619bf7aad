#include "veridyn/recording/signal_gain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::recording {
namespace {

constexpr std::size_t kFewestRows = 40;
constexpr double kRowsPerPeriod = 4.0;
/// Longest correlation of the residual that is looked for [s].
constexpr double kLongestMemory_s = 10.0;

numerics::LowPassDesign filter_of(const numerics::UniformGrid& grid, double band_Hz) {
  return {.rate_Hz = grid.rate_Hz(),
          .pass_Hz = band_Hz,
          .stop_Hz = std::min(2.0 * band_Hz, 0.5 * grid.rate_Hz()),
          .attenuation_dB = 40.0};
}

/// Least squares of `z` on the columns of X, the first of which is asked for: its coefficient and standard error.
struct Slope {
  double value = 0.0, sigma = 0.0;
};

std::optional<Slope> slope_of(const estimation::RegressionData& data, double row_s) {
  estimation::RegressionOptions options;
  options.max_lag = static_cast<Eigen::Index>(std::max(4.0, kLongestMemory_s / row_s));
  const estimation::RegressionEstimate estimate = estimation::estimate(data, estimation::Method::kOls, options);
  if (!estimate.usable() || !std::isfinite(estimate.covariance(0, 0))) return std::nullopt;
  return Slope{estimate.theta(0), std::sqrt(std::max(0.0, estimate.covariance(0, 0)))};
}

/// What the columns of `others` leave of a series.
Eigen::VectorXd remainder(const Eigen::VectorXd& series, const Eigen::MatrixXd& others) {
  if (others.cols() == 0) return series;
  return series - others * numerics::least_squares(others, series);
}

/// The rows of both regressions: column 0 is the truth or the reading, the rest are the others and the constant.
struct GainRows {
  Eigen::VectorXd reading, truth;
  Eigen::MatrixXd others;
  std::vector<int> segment;
  double row_s = 0.0;

  [[nodiscard]] estimation::RegressionData regression(const Eigen::VectorXd& z, const Eigen::VectorXd& x) const {
    estimation::RegressionData data;
    data.regressors.resize(x.size(), 1 + others.cols());
    data.regressors.col(0) = x;
    data.regressors.rightCols(others.cols()) = others;
    data.regressand = z;
    data.segment = segment;
    for (Eigen::Index j = 0; j < data.regressors.cols(); ++j) data.parameter_names.push_back(fmt::format("g{}", j));
    return data;
  }
};

std::optional<GainRows> rows_of(const ComparedSignals& signals, const numerics::UniformGrid& grid,
                                std::span<const TimeSpan> spans, double band_Hz, std::span<const bool> used) {
  const std::vector<double> reading = low_passed(signals.reading, grid, band_Hz);
  const std::vector<double> truth = low_passed(signals.truth, grid, band_Hz);
  std::vector<std::vector<double>> others;
  for (const std::vector<double>& other : signals.others) others.push_back(low_passed(other, grid, band_Hz));
  const auto stride =
      std::max<std::size_t>(1, static_cast<std::size_t>(grid.rate_Hz() / (kRowsPerPeriod * band_Hz) + 1e-9));
  std::vector<std::size_t> index;
  GainRows rows;
  int segment = 0;
  for (const TimeSpan& span : spans) {
    const auto [first, last] = grid_indices(grid, span);
    bool hole = true;
    for (std::size_t k = first; k < last; k += stride) {
      bool complete = (used.empty() || used[k]) && std::isfinite(reading[k]) && std::isfinite(truth[k]);
      for (const std::vector<double>& other : others) complete = complete && std::isfinite(other[k]);
      if (complete) {
        if (hole) ++segment;
        index.push_back(k);
        rows.segment.push_back(segment);
      }
      hole = !complete;
    }
  }
  if (index.size() < kFewestRows) return std::nullopt;
  const auto n = signed_index(index.size());
  rows.row_s = static_cast<double>(stride) * grid.step;
  rows.reading.resize(n);
  rows.truth.resize(n);
  rows.others.resize(n, signed_index(others.size()) + (signals.with_bias ? 1 : 0));
  rows.others.setOnes();
  for (Eigen::Index i = 0; i < n; ++i) {
    rows.reading(i) = reading[index[i]];
    rows.truth(i) = truth[index[i]];
    for (std::size_t j = 0; j < others.size(); ++j) rows.others(i, j) = others[j][index[i]];
  }
  return rows;
}

}  // namespace

std::vector<double> low_passed(std::span<const double> values, const numerics::UniformGrid& grid, double band_Hz) {
  return numerics::filter(values, numerics::low_pass(filter_of(grid, band_Hz)));
}

std::vector<double> low_passed_derivative(std::span<const double> values, const numerics::UniformGrid& grid,
                                          double band_Hz) {
  return numerics::filter(values, numerics::low_pass_differentiator(filter_of(grid, band_Hz)));
}

std::optional<SignalGain> signal_gain(const ComparedSignals& signals, const numerics::UniformGrid& grid,
                                      std::span<const TimeSpan> spans, double band_Hz, std::span<const bool> used) {
  const std::optional<GainRows> rows = rows_of(signals, grid, spans, band_Hz, used);
  if (!rows) return std::nullopt;
  const Eigen::VectorXd reading = remainder(rows->reading, rows->others);
  const Eigen::VectorXd truth = remainder(rows->truth, rows->others);
  // A signal that others explain to rounding says nothing.
  constexpr double kRounding = 1e-9;
  if (!(reading.norm() > kRounding * rows->reading.norm()) || !(truth.norm() > kRounding * rows->truth.norm()))
    return std::nullopt;
  const auto forward = slope_of(rows->regression(rows->reading, rows->truth), rows->row_s);
  const auto backward = slope_of(rows->regression(rows->truth, rows->reading), rows->row_s);
  if (!forward || !backward) return std::nullopt;
  SignalGain gain;
  gain.rows = rows->segment.size();
  gain.correlation = reading.dot(truth) / (reading.norm() * truth.norm());
  gain.truth_rms = truth.norm() / std::sqrt(static_cast<double>(gain.rows));
  gain.reading_rms = reading.norm() / std::sqrt(static_cast<double>(gain.rows));
  const double inverse = 1.0 / backward->value, inverse_sigma = backward->sigma / (backward->value * backward->value);
  const bool ascending = forward->value <= inverse;
  gain.low = ascending ? forward->value : inverse;
  gain.low_sigma = ascending ? forward->sigma : inverse_sigma;
  gain.high = ascending ? inverse : forward->value;
  gain.high_sigma = ascending ? inverse_sigma : forward->sigma;
  return gain;
}

}  // namespace veridyn::recording
