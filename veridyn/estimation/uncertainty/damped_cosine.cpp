#include "veridyn/estimation/uncertainty/damped_cosine.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/regression/long_run_covariance.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"

namespace veridyn::estimation {
namespace {

constexpr std::size_t kSpectrumSamples = 1000;
constexpr int kIterations = 100;

using Parameters = Eigen::Matrix<double, 5, 1>;  // w, s, a, b, c

/// Peak of the spectrum of block means; the grid is fine enough for Newton to find the rest.
double spectral_peak(const std::vector<double>& t, const std::vector<double>& y) {
  const std::size_t block = std::max<std::size_t>(1, t.size() / kSpectrumSamples);
  std::vector<double> ts, ys;
  double mean = 0.0;
  for (std::size_t i = 0; i + block <= t.size(); i += block) {
    double a = 0.0, b = 0.0;
    for (std::size_t k = i; k < i + block; ++k) {
      a += t[k];
      b += y[k];
    }
    ts.push_back(a / static_cast<double>(block));
    ys.push_back(b / static_cast<double>(block));
    mean += ys.back();
  }
  mean /= static_cast<double>(ys.size());
  const double span = ts.back() - ts.front();
  const double step = 0.125 / span, first = 0.5 / span;
  const double highest = 0.5 * static_cast<double>(ts.size()) / span;
  std::vector<std::complex<double>> sum(static_cast<std::size_t>((highest - first) / step) + 1);
  for (std::size_t i = 0; i < ts.size(); ++i) {
    // One turn further from frequency to frequency: a multiplication instead of a sine and a cosine.
    const std::complex<double> start = (ys[i] - mean) * std::polar(1.0, -kFullTurn * first * (ts[i] - ts[0]));
    const std::complex<double> turn = std::polar(1.0, -kFullTurn * step * (ts[i] - ts[0]));
    double re = start.real(), im = start.imag();
    for (std::complex<double>& s : sum) {
      s += std::complex<double>(re, im);
      const double next = re * turn.real() - im * turn.imag();
      im = re * turn.imag() + im * turn.real();
      re = next;
    }
  }
  const auto peak = std::max_element(sum.begin(), sum.end(),
                                     [](const auto& a, const auto& b) { return std::norm(a) < std::norm(b); });
  const double best = first + step * static_cast<double>(peak - sum.begin());
  return kFullTurn * best;
}

/// a, b, c of given w, s.
void solve_linear(const std::vector<double>& t, const std::vector<double>& y, Parameters& p) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double e = std::exp(-p(1) * t[i]);
    const Eigen::Vector3d x(e * std::cos(p(0) * t[i]), e * std::sin(p(0) * t[i]), 1.0);
    A += x * x.transpose();
    r += x * y[i];
  }
  p.tail<3>() = numerics::solve_symmetric(A, Eigen::VectorXd(r));
}

struct Linearisation {
  RowMatrix J;
  Eigen::VectorXd residual;
  double cost = 0.0;
};

Linearisation linearise(const std::vector<double>& t, const std::vector<double>& y, const Parameters& p) {
  const auto n = static_cast<Eigen::Index>(t.size());
  Linearisation l{RowMatrix(n, 5), Eigen::VectorXd(n), 0.0};
  for (Eigen::Index i = 0; i < n; ++i) {
    const double time = t[i];
    const double e = std::exp(-p(1) * time), c = std::cos(p(0) * time), s = std::sin(p(0) * time);
    const double swing = e * (p(2) * c + p(3) * s);
    l.J.row(i) << e * time * (-p(2) * s + p(3) * c), -time * swing, e * c, e * s, 1.0;
    l.residual(i) = y[i] - swing - p(4);
  }
  l.cost = l.residual.squaredNorm();
  return l;
}

}  // namespace

const char* to_string(DampedCosineEnd end) {
  switch (end) {
    case DampedCosineEnd::kFitted:
      return "fitted";
    case DampedCosineEnd::kTooFewSamples:
      return "too few samples";
    case DampedCosineEnd::kNoOscillation:
      return "no oscillation";
    case DampedCosineEnd::kNoConvergence:
      break;
  }
  return "no convergence";
}

double DampedCosine::undamped_frequency() const { return std::hypot(damped_frequency, decay); }
double DampedCosine::cycles() const { return damped_frequency * duration / kFullTurn; }
double DampedCosine::amplitude() const { return std::hypot(cosine, sine); }
double DampedCosine::operator()(double time) const {
  const double t = time - start;
  return std::exp(-decay * t) * (cosine * std::cos(damped_frequency * t) + sine * std::sin(damped_frequency * t)) +
         offset;
}

DampedCosine fit_damped_cosine(std::span<const double> time, std::span<const double> value) {
  VERIDYN_ASSERT(time.size() == value.size());
  DampedCosine fit;
  std::vector<double> t, y;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i]) || !std::isfinite(value[i])) continue;
    if (t.empty()) fit.start = time[i];
    t.push_back(time[i] - fit.start);
    y.push_back(value[i]);
  }
  if (t.size() < 20 || !(t.back() > 0.0)) return fit;
  fit.duration = t.back();

  Parameters p = Parameters::Zero();
  p(0) = spectral_peak(t, y);
  solve_linear(t, y, p);
  Linearisation at = linearise(t, y, p);
  const double resolution = kFullTurn / fit.duration;
  double damping = 1e-3;
  fit.end = DampedCosineEnd::kNoConvergence;
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::Matrix<double, 5, 5> N = at.J.transpose() * at.J;
    Eigen::Matrix<double, 5, 5> damped = N;
    damped.diagonal() += damping * N.diagonal();
    Parameters next = p + numerics::solve_symmetric(damped, Eigen::VectorXd(at.J.transpose() * at.residual));
    // The three linear parameters are free: exact for every frequency and decay.
    solve_linear(t, y, next);
    Linearisation trial = linearise(t, y, next);
    if (std::isfinite(trial.cost) && trial.cost <= at.cost) {
      const double step = (next - p).head<2>().norm();
      p = next;
      at = std::move(trial);
      damping = std::max(1e-12, 0.1 * damping);
      if (step < 1e-10 * resolution) {
        fit.end = DampedCosineEnd::kFitted;
        break;
      }
    } else {
      damping *= 10.0;
      if (damping > 1e12) {  // the cost cannot be lowered within rounding
        fit.end = DampedCosineEnd::kFitted;
        break;
      }
    }
  }
  fit.damped_frequency = std::abs(p(0));
  fit.decay = p(1);
  fit.cosine = p(2);
  fit.sine = p(0) < 0.0 ? -p(3) : p(3);
  fit.offset = p(4);
  const auto n = static_cast<double>(t.size());
  fit.residual_rms = std::sqrt(at.cost / n);
  const Eigen::Map<const Eigen::VectorXd> all(y.data(), static_cast<Eigen::Index>(y.size()));
  const double variance = (all.array() - all.mean()).square().sum();
  fit.r_squared = variance > 0.0 ? 1.0 - at.cost / variance : 0.0;
  for (const double time_i : t)
    fit.mean_square_swing += std::exp(-2.0 * fit.decay * time_i) * (p(2) * p(2) + p(3) * p(3)) / n;

  // Sandwich covariance: what the motion holds beyond the model is autocorrelated.
  const SegmentRanges whole{{0, at.J.rows()}};
  const Eigen::Index window = correlation_length(at.residual, whole, std::min<Eigen::Index>(5000, at.J.rows() / 4));
  const Eigen::MatrixXd S = autocorrelated_normal_matrix(at.J, at.residual, whole, window).matrix;
  const Eigen::Matrix<double, 5, 5> N = at.J.transpose() * at.J;
  const Eigen::Matrix<double, 5, 5> inverse =
      numerics::solve_symmetric(N, Eigen::MatrixXd(Eigen::MatrixXd::Identity(5, 5)));
  fit.sigma_frequency = std::sqrt(std::max(0.0, (inverse * S * inverse)(0, 0)));
  if (fit.usable() && (!(fit.cycles() >= 3.0) || !(fit.r_squared >= 0.5))) fit.end = DampedCosineEnd::kNoOscillation;
  return fit;
}

}  // namespace veridyn::estimation
