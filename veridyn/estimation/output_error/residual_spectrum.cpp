#include "veridyn/estimation/output_error/residual_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "veridyn/estimation/regression/long_run_covariance.hpp"
#include "veridyn/numerics/linear_algebra/real_form.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::estimation {
namespace {

constexpr double kLeastDensity = 0.05;

// The residual of one output, all segments end to end, with gaps as zeros.
void pool(const std::vector<RowMatrix>& residuals, Eigen::Index output, Eigen::VectorXd& values,
          SegmentRanges& segments) {
  Eigen::Index total = 0;
  for (const RowMatrix& r : residuals) total += r.rows();
  values.resize(total);
  segments.clear();
  Eigen::Index at = 0;
  for (const RowMatrix& r : residuals) {
    for (Eigen::Index k = 0; k < r.rows(); ++k) values(at + k) = std::isfinite(r(k, output)) ? r(k, output) : 0.0;
    segments.emplace_back(at, at + r.rows());
    at += r.rows();
  }
}

// E[w_a(k + lag) w_b(k)], tapered as a biased autocovariance is.
double lagged_covariance(const std::vector<RowMatrix>& residuals, Eigen::Index a, Eigen::Index b, Eigen::Index lag,
                         double total) {
  double sum = 0.0, pairs = 0.0, possible = 0.0;
  for (const RowMatrix& r : residuals) {
    for (Eigen::Index k = 0; k + lag < r.rows(); ++k) {
      const double product = r(k + lag, a) * r(k, b);
      possible += 1.0;
      if (!std::isfinite(product)) continue;
      sum += product;
      pairs += 1.0;
    }
  }
  return pairs > 0.0 ? sum / pairs * possible / total : 0.0;
}

}  // namespace

ResidualSpectrum residual_spectrum(const std::vector<RowMatrix>& residuals, Eigen::Index max_lag) {
  const Eigen::Index p = residuals.front().cols();
  ResidualSpectrum result;
  Eigen::Index longest = 0;
  double total = 0.0;
  for (const RowMatrix& r : residuals) {
    longest = std::max(longest, r.rows());
    total += static_cast<double>(r.rows());
  }
  for (Eigen::Index j = 0; j < p; ++j) {
    Eigen::VectorXd values;
    SegmentRanges segments;
    pool(residuals, j, values, segments);
    result.window = std::max(result.window, correlation_length(values, segments, max_lag));
  }
  const Eigen::Index w = result.window;
  const Eigen::Index lags = w > 0 ? 2 * w : 1;  // lag 0 and those of weight above 0
  result.length = 1;
  while (result.length < longest + 2 * w) result.length *= 2;
  const Eigen::Index L = result.length, half = L / 2 + 1;

  double sum = 1.0, squares = 1.0;
  for (Eigen::Index lag = 1; lag < lags; ++lag) {
    const double weight = flat_top_weight(lag, w);
    sum += 2.0 * weight;
    squares += 2.0 * weight * weight;
  }
  result.kept = std::max(0.2, 1.0 - sum / total);
  result.degrees_of_freedom = std::max(1.0, total / squares);

  result.density.assign(static_cast<std::size_t>(half), Eigen::MatrixXcd::Zero(p, p));
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> sequence(static_cast<std::size_t>(L)), transform;
  for (Eigen::Index a = 0; a < p; ++a) {
    for (Eigen::Index b = a; b < p; ++b) {
      std::fill(sequence.begin(), sequence.end(), 0.0);
      for (Eigen::Index lag = 0; lag < lags && lag < longest; ++lag) {
        const double weight = flat_top_weight(lag, w);
        sequence[lag] += weight * lagged_covariance(residuals, a, b, lag, total);
        if (lag > 0) sequence[L - lag] += weight * lagged_covariance(residuals, b, a, lag, total);
      }
      fft.fwd(transform, sequence);
      for (Eigen::Index f = 0; f < half; ++f) {
        auto& density = result.density[f];
        density(a, b) = transform[f];
        density(b, a) = std::conj(density(a, b));
      }
    }
  }
  for (auto& density : result.density) {
    for (Eigen::Index a = 0; a < p; ++a) density(a, a) = density(a, a).real();
    const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(numerics::real_form(density));
    if (eigen.values(0) >= kLeastDensity) continue;
    density = numerics::complex_form(numerics::from_eigen(eigen.vectors, eigen.values.cwiseMax(kLeastDensity)));
  }
  return result;
}

Eigen::MatrixXd autocorrelated_information(const ResidualSpectrum& spectrum, const RowMatrix& sensitivity,
                                           Eigen::Index outputs) {
  const Eigen::Index n = sensitivity.cols(), N = sensitivity.rows() / outputs;
  const Eigen::Index L = spectrum.length, half = L / 2 + 1;
  // Row f of block j: transforms of output j's sensitivities at frequency f.
  std::vector<Eigen::MatrixXcd> transformed(static_cast<std::size_t>(outputs), Eigen::MatrixXcd(half, n));
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> sequence(static_cast<std::size_t>(L)), transform;
  for (Eigen::Index j = 0; j < outputs; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      std::fill(sequence.begin(), sequence.end(), 0.0);
      for (Eigen::Index k = 0; k < N; ++k) sequence[k] = sensitivity(k * outputs + j, i);
      fft.fwd(transform, sequence);
      for (Eigen::Index f = 0; f < half; ++f) transformed[j](f, i) = transform[f];
    }
  }
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXcd rows(outputs, n);
  for (Eigen::Index f = 0; f < half; ++f) {
    for (Eigen::Index j = 0; j < outputs; ++j) rows.row(j) = transformed[j].row(f);
    const double twice = f == 0 || (f == half - 1 && L % 2 == 0) ? 1.0 : 2.0;
    result += twice / static_cast<double>(L) * (rows.adjoint() * spectrum.density[f] * rows).real();
  }
  return 0.5 * (result + result.transpose());
}

}  // namespace veridyn::estimation
