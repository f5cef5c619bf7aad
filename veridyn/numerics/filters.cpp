#include "veridyn/numerics/filters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

namespace veridyn::numerics {
namespace {

// Modified Bessel function I0 by its series; the terms fall below rounding after about 50 for x <= 20.
double bessel_i0(double x) {
  double term = 1.0, sum = 1.0;
  for (int k = 1; k < 200 && term > 1e-17 * sum; ++k) {
    term *= (0.5 * x / k) * (0.5 * x / k);
    sum += term;
  }
  return sum;
}

using Vector = Eigen::Map<const Eigen::VectorXd>;

// y_k = sum over the kernel of padded[k .. k+2m], in blocks that stay in the first-level cache, pairing equal taps.
void convolve(const double* padded, std::size_t count, const std::vector<double>& taps, double* out) {
  constexpr std::size_t kBlock = 1024;
  const std::size_t m = taps.size() / 2;
  const bool symmetric = std::equal(taps.begin(), taps.end(), taps.rbegin());
  const bool antisymmetric =
      !symmetric && std::equal(taps.begin(), taps.end(), taps.rbegin(), [](double a, double b) { return a == -b; });
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const auto size = static_cast<Eigen::Index>(std::min(kBlock, count - begin));
    Eigen::Map<Eigen::VectorXd> y(out + begin, size);
    const double* x = padded + begin;
    if (symmetric || antisymmetric) {
      y = taps[m] * Vector(x + m, size);
      for (std::size_t j = 0; j < m; ++j) {
        const Vector before(x + j, size);
        const Vector after(x + 2 * m - j, size);
        if (symmetric) {
          y += taps[j] * (before + after);
        } else {
          y += taps[j] * (before - after);
        }
      }
    } else {
      y.setZero();
      for (std::size_t j = 0; j < taps.size(); ++j) y += taps[j] * Vector(x + j, size);
    }
  }
}

}  // namespace

void LowPassDesign::validate() const {
  if (!(rate_Hz > 0.0) || !std::isfinite(rate_Hz))
    throw InputError("low_pass.rate_Hz", fmt::format("is {}; must be > 0", rate_Hz));
  if (!(pass_Hz > 0.0)) throw InputError("low_pass.pass_Hz", fmt::format("is {}; must be > 0", pass_Hz));
  if (!(stop_Hz > pass_Hz)) {
    throw InputError("low_pass.stop_Hz", fmt::format("is {}; must be above pass_Hz, {}", stop_Hz, pass_Hz));
  }
  if (!(stop_Hz <= 0.5 * rate_Hz)) {
    throw InputError("low_pass.stop_Hz",
                     fmt::format("is {}; must be at most half the rate, {}", stop_Hz, 0.5 * rate_Hz));
  }
  if (!(attenuation_dB >= 20.0 && attenuation_dB <= 120.0)) {
    throw InputError("low_pass.attenuation_dB", fmt::format("is {}; must be in [20, 120]", attenuation_dB));
  }
}

double FirKernel::noise_gain() const { return noise_autocovariance(0); }

double FirKernel::noise_autocovariance(std::size_t lag) const {
  double sum = 0.0;
  for (std::size_t j = 0; j + lag < taps.size(); ++j) sum += taps[j] * taps[j + lag];
  return sum;
}

double FirKernel::gain(double frequency_Hz) const {
  const double w = 2.0 * kPi * frequency_Hz / rate_Hz;
  const auto m = static_cast<double>(half_width());
  double even = 0.0, odd = 0.0;
  for (std::size_t j = 0; j < taps.size(); ++j) {
    even += taps[j] * std::cos(w * (static_cast<double>(j) - m));
    odd += taps[j] * std::sin(w * (static_cast<double>(j) - m));
  }
  const bool antisymmetric =
      std::equal(taps.begin(), taps.end(), taps.rbegin(), [](double a, double b) { return a == -b; });
  return antisymmetric ? odd : even;
}

FirKernel low_pass(const LowPassDesign& design) {
  design.validate();
  const double A = design.attenuation_dB;
  const double transition = 2.0 * kPi * (design.stop_Hz - design.pass_Hz) / design.rate_Hz;
  const double beta = A > 50.0   ? 0.1102 * (A - 8.7)
                      : A > 21.0 ? 0.5842 * std::pow(A - 21.0, 0.4) + 0.07886 * (A - 21.0)
                                 : 0.0;
  const auto m = static_cast<std::ptrdiff_t>(std::ceil((A - 7.95) / (2.285 * transition) / 2.0));
  const double cutoff = kPi * (design.stop_Hz + design.pass_Hz) / design.rate_Hz;
  FirKernel kernel;
  kernel.rate_Hz = design.rate_Hz;
  kernel.taps.resize(2 * m + 1);
  double sum = 0.0;
  for (std::ptrdiff_t j = -m; j <= m; ++j) {
    const auto n = static_cast<double>(j);
    const double sinc = j == 0 ? cutoff / kPi : std::sin(cutoff * n) / (kPi * n);
    const double u = n / static_cast<double>(m);
    const double tap = sinc * bessel_i0(beta * std::sqrt(std::max(0.0, 1.0 - u * u))) / bessel_i0(beta);
    kernel.taps[j + m] = tap;
    sum += tap;
  }
  for (double& tap : kernel.taps) tap /= sum;
  return kernel;
}

FirKernel low_pass_differentiator(const LowPassDesign& design) {
  const FirKernel smoother = low_pass(design);
  const auto m = static_cast<std::ptrdiff_t>(smoother.half_width());
  const std::ptrdiff_t wide = m + (m + 1) / 2;
  FirKernel kernel;
  kernel.rate_Hz = design.rate_Hz;
  kernel.taps.assign(static_cast<std::size_t>(2 * wide + 1), 0.0);
  std::vector<double> tap(static_cast<std::size_t>(wide + 1), 0.0), correction(tap);
  double slope = 0.0, correction_slope = 0.0;
  for (std::ptrdiff_t k = 1; k <= wide; ++k) {
    for (std::ptrdiff_t j = -m; j <= m; ++j) {
      const std::ptrdiff_t n = k - j;
      if (n == 0) continue;
      // y_k = sum taps x_{k+j}: the ideal differentiator weights x_{k+n} by -(-1)^n/n.
      tap[k] -= smoother.taps[j + m] * ((n % 2 == 0) ? 1.0 : -1.0) / static_cast<double>(n);
    }
    const double u = static_cast<double>(k) / static_cast<double>(wide);
    correction[k] = static_cast<double>(k) * (1.0 - u * u) * (1.0 - u * u);
    slope += 2.0 * static_cast<double>(k) * tap[k];
    correction_slope += 2.0 * static_cast<double>(k) * correction[k];
  }
  // What was cut off is missing at 0 Hz: added by a short pulse of low frequency instead of by scaling all frequencies.
  const double missing = (1.0 - slope) / correction_slope;
  for (std::ptrdiff_t k = 1; k <= wide; ++k) {
    const double value = design.rate_Hz * (tap[k] + missing * correction[k]);
    kernel.taps[wide + k] = value;
    kernel.taps[wide - k] = -value;
  }
  return kernel;
}

std::vector<std::pair<std::size_t, std::size_t>> finite_stretches(std::span<const double> x) {
  std::vector<std::pair<std::size_t, std::size_t>> stretches;
  std::size_t begin = 0;
  bool inside = false;
  for (std::size_t k = 0; k <= x.size(); ++k) {
    const bool finite = k < x.size() && std::isfinite(x[k]);
    if (finite && !inside) begin = k;
    if (!finite && inside) stretches.emplace_back(begin, k);
    inside = finite;
  }
  return stretches;
}

void filter(std::span<const double> x, const FirKernel& kernel, std::span<double> out, Edges edges) {
  VERIDYN_ASSERT(x.size() == out.size());
  VERIDYN_ASSERT(kernel.taps.size() % 2 == 1);
  const std::size_t m = kernel.half_width();
  std::fill(out.begin(), out.end(), kNaN);
  std::vector<double> padded;
  for (const auto& [begin, end] : finite_stretches(x)) {
    const std::size_t n = end - begin;
    const double* s = x.data() + begin;
    if (edges == Edges::kNan) {
      if (n >= 2 * m + 1) convolve(s, n - 2 * m, kernel.taps, out.data() + begin + m);
      continue;
    }
    if (n < m + 1) continue;
    padded.resize(n + 2 * m);
    std::copy(s, s + n, padded.begin() + m);
    for (std::size_t j = 1; j <= m; ++j) {
      padded[m - j] = 2.0 * s[0] - s[j];
      padded[m + n - 1 + j] = 2.0 * s[n - 1] - s[n - 1 - j];
    }
    convolve(padded.data(), n, kernel.taps, out.data() + begin);
  }
}

std::vector<double> filter(std::span<const double> x, const FirKernel& kernel, Edges edges) {
  std::vector<double> out(x.size());
  filter(x, kernel, out, edges);
  return out;
}

SavitzkyGolay::SavitzkyGolay(int order, int half_width, int derivative, double rate_Hz) : rate_Hz_(rate_Hz) {
  if (half_width < 1) throw InputError("savitzky_golay.half_width", fmt::format("is {}; must be >= 1", half_width));
  if (order < 0 || order > 2 * half_width) {
    throw InputError("savitzky_golay.order",
                     fmt::format("is {}; must be in [0, 2 half_width = {}]", order, 2 * half_width));
  }
  if (derivative < 0 || derivative > order) {
    throw InputError("savitzky_golay.derivative", fmt::format("is {}; must be in [0, order = {}]", derivative, order));
  }
  if (!(rate_Hz > 0.0)) throw InputError("savitzky_golay.rate_Hz", fmt::format("is {}; must be > 0", rate_Hz));
  // Legendre polynomials on [-1, 1] keep the fit well conditioned at any order; their derivatives follow by recursion.
  const int count = 2 * half_width + 1;
  const auto legendre = [&](double u, int d) {
    Eigen::MatrixXd p = Eigen::MatrixXd::Zero(d + 1, order + 1);  // row i: i-th derivatives
    p(0, 0) = 1.0;
    for (int n = 0; n < order; ++n) {
      for (int i = 0; i <= d; ++i) {
        const double lower = i > 0 ? i * p(i - 1, n) : 0.0;
        p(i, n + 1) = ((2 * n + 1) * (u * p(i, n) + lower) - (n > 0 ? n * p(i, n - 1) : 0.0)) / (n + 1);
      }
    }
    return Eigen::VectorXd(p.row(d));
  };
  Eigen::MatrixXd basis(count, order + 1);
  Eigen::MatrixXd wanted(count, order + 1);
  const double unit = std::pow(rate_Hz / half_width, derivative);
  for (int j = 0; j < count; ++j) {
    const double u = static_cast<double>(j - half_width) / half_width;
    basis.row(j) = legendre(u, 0);
    wanted.row(j) = unit * legendre(u, derivative);
  }
  const Eigen::MatrixXd fit = HouseholderQr(basis).solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(count, count)));
  taps_ = (wanted * fit).transpose();
}

void SavitzkyGolay::apply(std::span<const double> x, std::span<double> out) const {
  VERIDYN_ASSERT(x.size() == out.size());
  std::fill(out.begin(), out.end(), kNaN);
  const auto count = static_cast<std::size_t>(taps_.rows());
  const std::size_t m = count / 2;
  const FirKernel centre = kernel();
  for (const auto& [begin, end] : finite_stretches(x)) {
    const std::size_t n = end - begin;
    if (n < count) continue;
    const double* s = x.data() + begin;
    double* y = out.data() + begin;
    convolve(s, n - 2 * m, centre.taps, y + m);
    const Vector first(s, taps_.rows());
    const Vector last(s + n - count, taps_.rows());
    for (std::size_t j = 0; j < m; ++j) {
      y[j] = taps_.col(j).dot(first);
      y[n - 1 - j] = taps_.col(count - 1 - j).dot(last);
    }
  }
}

std::vector<double> SavitzkyGolay::apply(std::span<const double> x) const {
  std::vector<double> out(x.size());
  apply(x, out);
  return out;
}

FirKernel SavitzkyGolay::kernel() const {
  FirKernel kernel;
  kernel.rate_Hz = rate_Hz_;
  const Eigen::VectorXd centre = taps_.col(taps_.cols() / 2);
  kernel.taps.assign(centre.data(), centre.data() + centre.size());
  // Exact symmetry lets the convolution pair its taps; the fit gives it only to rounding.
  const std::size_t m = kernel.half_width();
  for (std::size_t j = 0; j < m; ++j) {
    double& before = kernel.taps[j];
    double& after = kernel.taps[2 * m - j];
    const double sign = before * after < 0.0 ? -1.0 : 1.0;
    const double mean = 0.5 * (before + sign * after);
    before = mean;
    after = sign * mean;
  }
  return kernel;
}

}  // namespace veridyn::numerics
