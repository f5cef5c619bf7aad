#include "veridyn/estimation/regression/frequency_domain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/estimation/regression/ordinary_least_squares.hpp"

namespace veridyn::estimation {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr Index kLeastSamples = 8;

/// Weight of the inner samples and corrections of the first four, for exp(+j theta k) and cubic interpolation (Press et
/// al., Numerical Recipes, eq. 13.9.14; series for small theta, where the closed forms cancel).
struct EndCorrection {
  double inner = 1.0;
  std::array<Complex, 4> first;
};

EndCorrection end_correction(double theta) {
  EndCorrection c;
  const double t2 = theta * theta, t4 = t2 * t2, t6 = t4 * t2;
  if (std::abs(theta) < 0.1) {
    c.inner = 1.0 - 11.0 / 720.0 * t4 + 23.0 / 15120.0 * t6;
    c.first[0] = {-2.0 / 3.0 + t2 / 45.0 + 103.0 / 15120.0 * t4 - 169.0 / 226800.0 * t6,
                  theta * (2.0 / 45.0 + 2.0 / 105.0 * t2 - 8.0 / 2835.0 * t4 + 86.0 / 467775.0 * t6)};
    c.first[1] = {7.0 / 24.0 - 7.0 / 180.0 * t2 + 5.0 / 3456.0 * t4 - 7.0 / 259200.0 * t6,
                  theta * (7.0 / 72.0 - t2 / 168.0 + 11.0 / 72576.0 * t4 - 13.0 / 5987520.0 * t6)};
    c.first[2] = {-1.0 / 6.0 + t2 / 45.0 - 5.0 / 6048.0 * t4 + t6 / 64800.0,
                  theta * (-7.0 / 90.0 + t2 / 210.0 - 11.0 / 90720.0 * t4 + 13.0 / 7484400.0 * t6)};
    c.first[3] = {1.0 / 24.0 - t2 / 180.0 + 5.0 / 24192.0 * t4 - t6 / 259200.0,
                  theta * (7.0 / 360.0 - t2 / 840.0 + 11.0 / 362880.0 * t4 - 13.0 / 29937600.0 * t6)};
    return c;
  }
  const double cosine = std::cos(theta), sine = std::sin(theta);
  const double cos2 = cosine * cosine - sine * sine, sin2 = 2.0 * sine * cosine;
  const double a = 6.0 + t2, b = 3.0 - t2;
  c.inner = a / (3.0 * t4) * (3.0 - 4.0 * cosine + cos2);
  c.first[0] = {(-42.0 + 5.0 * t2 + a * (8.0 * cosine - cos2)) / (6.0 * t4),
                (theta * (-12.0 + 6.0 * t2) + a * sin2) / (6.0 * t4)};
  c.first[1] = {(14.0 * b - 7.0 * a * cosine) / (6.0 * t4), (30.0 * theta - 5.0 * a * sine) / (6.0 * t4)};
  c.first[2] = {(-4.0 * b + 2.0 * a * cosine) / (3.0 * t4), (-12.0 * theta + 2.0 * a * sine) / (3.0 * t4)};
  c.first[3] = {(2.0 * b - a * cosine) / (6.0 * t4), (6.0 * theta - a * sine) / (6.0 * t4)};
  return c;
}

/// Sum of x_k exp(-j theta k), the rotation restarted every 64 samples so that rounding does not build up.
Complex rotated_sum(std::span<const double> x, double theta) {
  const Complex turn = std::polar(1.0, -theta);
  Complex sum = 0.0, rotation = 1.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (k % 64 == 0) rotation = std::polar(1.0, -theta * static_cast<double>(k));
    sum += x[k] * rotation;
    rotation *= turn;
  }
  return sum;
}

void remove_line(Eigen::Ref<Eigen::VectorXd> x) {
  const Index N = x.size();
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(N, -1.0, 1.0);
  const double slope = t.dot(x) / t.squaredNorm(), mean = x.mean();
  x.array() -= mean;
  x -= slope * t;
}

/// Columns [x, z] of each segment, transformed at the frequencies of the band that the segment resolves.
std::vector<Eigen::MatrixXcd> transformed_segments(const RegressionData& data, const std::vector<Index>& columns,
                                                   double step, const FrequencyOptions& options) {
  const auto n = signed_index(columns.size());
  std::vector<Eigen::MatrixXcd> segments;
  for (const auto& [begin, end] : segment_ranges(data.rows(), data.segment)) {
    const Index N = end - begin;
    if (N < kLeastSamples) continue;
    const double duration = step * static_cast<double>(N);
    const double spacing = options.resolution_Hz > 0.0 ? options.resolution_Hz : 1.0 / duration;
    std::vector<double> frequencies;
    for (double m = std::ceil(options.low_Hz / spacing - 1e-9); m * spacing <= options.high_Hz * (1.0 + 1e-9); m += 1.0)
      if (m >= 1.0) frequencies.push_back(m * spacing);
    if (frequencies.empty()) continue;
    Eigen::MatrixXcd segment(frequencies.size(), n + 1);
    for (Index j = 0; j <= n; ++j) {
      Eigen::VectorXd column = data.regressand.segment(begin, N);
      if (j < n) column = data.regressors.col(columns[j]).segment(begin, N);
      if (data.row_scale.size() > 0) column = column.cwiseQuotient(data.row_scale.segment(begin, N)).eval();
      if (options.remove_trend) remove_line(column);
      segment.col(j) = finite_fourier_transform({column.data(), static_cast<std::size_t>(N)}, step, frequencies) /
                       std::sqrt(duration);
    }
    segments.push_back(std::move(segment));
  }
  return segments;
}

/// Real and imaginary parts as separate rows: theta is real.
RowMatrix real_rows(const std::vector<Eigen::MatrixXcd>& segments, Index columns) {
  Index rows = 0;
  for (const Eigen::MatrixXcd& segment : segments) rows += 2 * segment.rows();
  RowMatrix D(rows, columns);
  Index row = 0;
  for (const Eigen::MatrixXcd& segment : segments) {
    D.middleRows(row, segment.rows()) = segment.real();
    D.middleRows(row + segment.rows(), segment.rows()) = segment.imag();
    row += 2 * segment.rows();
  }
  return D;
}

std::vector<Parameter> unknown_parameters(const RegressionData& data, const std::vector<Index>& columns) {
  std::vector<Parameter> parameters;
  for (const Index j : columns) {
    Parameter p;
    p.name = data.parameter_names[j];
    if (!data.parameter_units.empty()) p.unit = data.parameter_units[j];
    p.value = kNaN;
    p.sigma = p.sigma_white = p.high95 = kInfinity;
    p.low95 = -p.sigma;
    parameters.push_back(std::move(p));
  }
  return parameters;
}

/// Covariance whose filling is the residual's own power at each frequency, whatever its spectrum: heteroscedasticity-
/// consistent with leverage removed (HC3, MacKinnon & White 1985).
Eigen::MatrixXd covariance_by_frequency(const RowMatrix& D, const OrdinaryLeastSquares& ols) {
  const Index n = D.cols() - 1;
  const Eigen::VectorXd residual = D.col(n) - D.leftCols(n) * ols.theta;
  Eigen::MatrixXd filling = Eigen::MatrixXd::Zero(n, n);
  for (Index k = 0; k < D.rows(); ++k) {
    const Eigen::VectorXd x = D.row(k).head(n).transpose();
    const double r = residual(k) / std::max(1e-6, 1.0 - x.dot(ols.inverse_normal * x));
    filling += r * r * x * x.transpose();
  }
  return ols.inverse_normal * filling * ols.inverse_normal;
}

}  // namespace

Eigen::VectorXcd finite_fourier_transform(std::span<const double> x, double step,
                                          std::span<const double> frequencies_Hz) {
  VERIDYN_ASSERT(signed_index(x.size()) >= kLeastSamples && step > 0.0);
  Eigen::VectorXcd result(frequencies_Hz.size());
  const std::size_t last = x.size() - 1;
  for (std::size_t i = 0; i < frequencies_Hz.size(); ++i) {
    const double theta = 2.0 * kPi * frequencies_Hz[i] * step;
    const EndCorrection c = end_correction(theta);
    Complex sum = c.inner * rotated_sum(x, theta);
    // The formulas are for exp(+j theta k): conjugated here.
    Complex ends = 0.0;
    for (std::size_t m = 0; m < 4; ++m) {
      ends += std::conj(c.first[m]) * x[m];
      ends += std::polar(1.0, -theta * static_cast<double>(last)) * c.first[m] * x[last - m];
    }
    result(i) = step * (sum + ends);
  }
  return result;
}

void FrequencyOptions::validate(double step) const {
  if (!(step > 0.0)) throw InputError("frequency_domain.step", fmt::format("is {} s; must be > 0", step));
  if (!(low_Hz > 0.0)) throw InputError("frequency_domain.low", fmt::format("is {} Hz; must be > 0", low_Hz));
  if (!(high_Hz > low_Hz && high_Hz <= 0.5 / step)) {
    throw InputError("frequency_domain.high",
                     fmt::format("is {} Hz; must be above low = {} Hz and at most {} Hz, half the sampling rate",
                                 high_Hz, low_Hz, 0.5 / step));
  }
  if (!(resolution_Hz >= 0.0))
    throw InputError("frequency_domain.resolution", fmt::format("is {} Hz; must be >= 0", resolution_Hz));
  if (!(significance > 0.0 && significance < 1.0))
    throw InputError("frequency_domain.significance", fmt::format("is {}; must be in (0, 1)", significance));
}

FrequencyEstimate frequency_equation_error(const RegressionData& data, double step, const FrequencyOptions& options) {
  data.validate();
  options.validate(step);
  FrequencyEstimate result;
  std::vector<Index> columns;
  for (Index j = 0; j < data.parameters(); ++j) {
    if ((data.regressors.col(j).array() == data.regressors(0, j)).all())
      result.left_out.push_back(data.parameter_names[j]);
    else
      columns.push_back(j);
  }
  const auto n = signed_index(columns.size());
  const std::vector<Eigen::MatrixXcd> segments = transformed_segments(data, columns, step, options);
  result.segments = signed_index(segments.size());
  for (const Eigen::MatrixXcd& segment : segments) result.frequencies += segment.rows();
  RegressionEstimate& e = result.estimate;
  e.method = Method::kOls;
  e.rows = 2 * result.frequencies;
  e.parameters = unknown_parameters(data, columns);
  if (n == 0 || e.rows < n + 2) {
    e.message = fmt::format("{} frequencies between {} and {} Hz in {} segments are too few for {} parameters",
                            result.frequencies, options.low_Hz, options.high_Hz, result.segments, n);
    return result;
  }
  const RowMatrix D = real_rows(segments, n + 1);
  AugmentedQr qr(n + 1);
  qr.append(D);
  const OrdinaryLeastSquares ols = ordinary_least_squares(qr.triangle());
  e.theta = ols.theta;
  e.condition_number = ols.condition_number;
  e.singular_values.assign(ols.singular_values.data(), ols.singular_values.data() + n);
  e.excited_directions = n;
  if (!ols.full_rank) {
    e.termination = EstimateTermination::kRankDeficient;
    e.message =
        fmt::format("regressors are linearly dependent in the band (condition number {:.2g})", ols.condition_number);
    return result;
  }
  const double freedom = static_cast<double>(e.rows - n);
  const double power = D.col(n).squaredNorm();
  e.residual_sd = std::sqrt(ols.residual_sum_of_squares / freedom);
  e.r_squared = power > 0.0 ? 1.0 - ols.residual_sum_of_squares / power : 0.0;
  e.covariance_white = ols.residual_sum_of_squares / freedom * ols.inverse_normal;
  e.covariance = e.covariance_white;
  e.degrees_of_freedom = freedom;
  if (options.covariance == CovarianceKind::kAutocorrelated) {
    e.covariance = covariance_by_frequency(D, ols);
    // It is an estimate too, from as many values as there are frequencies.
    e.degrees_of_freedom = std::max(1.0, static_cast<double>(result.frequencies - n));
  }
  for (Index i = 0; i < n; ++i) {
    Parameter& p = e.parameters[i];
    p.value = e.theta(i);
    p.sigma = std::sqrt(e.covariance(i, i));
    p.sigma_white = std::sqrt(e.covariance_white(i, i));
    p.variance_inflation = std::max(1.0, D.col(i).squaredNorm() * ols.inverse_normal(i, i));
    set_interval(p, e.degrees_of_freedom);
    p.status = p.p_value < options.significance ? ParameterStatus::kIdentified : ParameterStatus::kInsignificant;
  }
  e.termination = EstimateTermination::kEstimated;
  e.message = fmt::format("estimated from {} frequencies between {} and {} Hz in {} segments", result.frequencies,
                          options.low_Hz, options.high_Hz, result.segments);
  return result;
}

}  // namespace veridyn::estimation
