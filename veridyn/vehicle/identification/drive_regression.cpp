#include "veridyn/vehicle/identification/drive_regression.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/regression/long_run_covariance.hpp"
#include "veridyn/estimation/regression/total_least_squares.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/modulating_kernel.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Method;
using estimation::RegressionData;
using estimation::RegressionEstimate;

/// Rows a cut-off frequency: they are nearly independent then.
constexpr double kRowsPerCutoff = 4.0;
/// Rows on which the error covariance is averaged.
constexpr std::size_t kCovarianceRows = 100;
/// Relative variation of the speed from which a gyro bias is distinguishable from a constant.
constexpr double kSpeedVaries = 0.05;
/// Power of the roll's column over that of its noise from which it is one.
constexpr double kRollMoves = 4.0;

/// Sensors whose noise enters, in this order.
enum Source : std::size_t {
  kSteerNoise,
  kSpeedNoise,
  kYawRateNoise,
  kAccelNoise,
  kLateralNoise,
  kRollNoise,
  kRollRateNoise,
  kSources
};

/// A term of a column: `coefficient(k)` times the kernel over one sensor's noise.
struct NoiseTerm {
  Source source;
  double coefficient;
  const numerics::FirKernel* kernel;
};

/// View of a drive's signals, the spans within them and the vehicle's geometry, which forms the rows of both
/// regressions and the noise of their columns.
class RegressionRows {
 public:
  RegressionRows(const DriveSignals& signals, std::span<const TimeSpan> spans, const VehicleParameters<double>& known,
                 double pass_Hz)
      : s_(signals),
        spans_(spans),
        p_(known),
        kernel_(numerics::modulating_kernel(signals.grid.rate_Hz(), pass_Hz)),
        stride_(std::max<std::size_t>(
            1, static_cast<std::size_t>(signals.grid.rate_Hz() / (kRowsPerCutoff * pass_Hz) + 1e-9))) {
    x_ = signals.accel_position[0];
    y_ = signals.accel_position[1];
    const std::array<DriveSignal, kSources> which{
        DriveSignal::kSteer,           DriveSignal::kSpeed, DriveSignal::kYawRate, DriveSignal::kAccelY,
        DriveSignal::kLateralVelocity, DriveSignal::kRoll,  DriveSignal::kRollRate};
    for (std::size_t i = 0; i < kSources; ++i) {
      const GridSignal& signal = s_[which[i]];
      // A sensor slower than the grid was interpolated: more of its noise lies in the pass band.
      const double spread = signal.rate_Hz > 0.0 ? std::max(1.0, s_.grid.rate_Hz() / signal.rate_Hz) : 1.0;
      variance_[i] = signal.sigma * signal.sigma * spread;
    }
    out_.direct = s_[DriveSignal::kLateralVelocity].available();
    // Gravity's share of a lean is in accel_y where it was not taken off; the lean's rate alone does not tell it.
    has_roll_ = s_.gravity_removed && (s_[DriveSignal::kRoll].available() || s_[DriveSignal::kRollRate].available());
    out_.filter = {.rate_Hz = s_.grid.rate_Hz(), .pass_Hz = pass_Hz, .stop_Hz = 2.0 * pass_Hz, .attenuation_dB = 20.0};
    out_.row_interval_s = static_cast<double>(stride_) * s_.grid.step;
  }

  DriveRegressions run() {
    u_slow_ = numerics::filter(s_[DriveSignal::kSpeed].value, kernel_.smooth);
    r_slow_ = numerics::filter(s_[DriveSignal::kYawRate].value, kernel_.smooth);
    a_slow_ = numerics::filter(s_[DriveSignal::kAccelY].value, kernel_.smooth);
    du_ = numerics::filter(s_[DriveSignal::kSpeed].value, kernel_.first);
    for (std::size_t i = 0; i < spans_.size(); ++i) take_span(spans_[i], static_cast<int>(i));
    finish();
    return std::move(out_);
  }

 private:
  /// Columns of a regression, in this order; those that the recording moves are used.
  enum Column : Eigen::Index { kOne, kOther, kConstant, kSpeed, kRoll, kRegressand, kColumns };
  using Columns = std::array<std::vector<NoiseTerm>, kColumns>;

  [[nodiscard]] double sum(const std::vector<double>& x, std::size_t k, const numerics::FirKernel& kernel) const {
    const std::size_t m = kernel.half_width();
    double total = 0.0;
    for (std::size_t j = 0; j < kernel.taps.size(); ++j) total += kernel.taps[j] * x[k + j - m];
    return total;
  }

  void take_span(const TimeSpan& span, int id) {
    const auto [begin, end] = s_.indices(span);
    const std::size_t m = kernel_.smooth.half_width();
    if (end < begin + 2 * m + 1) return;
    const std::size_t n = end - begin;
    const auto at = [this, first = begin](DriveSignal which, std::size_t k) { return s_[which].value[first + k]; };
    // Products on unfiltered samples.
    std::vector<double> delta(n), r(n), u(n), curvature(n), a(n), ua(n), ur(n), du_r(n), v_prime(n);
    std::vector<double> front(n), rear(n), accel(n), roll(n);
    const DriveSignal shown = roll_shown();
    for (std::size_t k = 0; k < n; ++k) {
      delta[k] = at(DriveSignal::kSteer, k);
      r[k] = at(DriveSignal::kYawRate, k);
      u[k] = at(DriveSignal::kSpeed, k);
      accel[k] = at(DriveSignal::kAccelY, k) + y_ * r[k] * r[k];
      curvature[k] = r[k] / u[k];
      ua[k] = u[k] * accel[k];
      ur[k] = u[k] * r[k];
      du_r[k] = du_[begin + k] * r[k];
      v_prime[k] = ur[k] - accel[k];
      if (has_roll_) roll[k] = at(shown, k);
      if (!out_.direct) continue;
      const double v = at(DriveSignal::kLateralVelocity, k);
      front[k] = (delta[k] - std::atan((v + p_.a * r[k]) / u[k])) * std::cos(delta[k]);
      rear[k] = -std::atan((v - p_.b * r[k]) / u[k]);
    }
    const double L = p_.wheelbase();
    for (std::size_t k = m; k + m < n; k += stride_) {
      const double dr = sum(r, k, kernel_.first);
      const double a_y = sum(accel, k, kernel_.smooth) - x_ * dr;
      const auto [rate_kernel, acceleration_kernel] = roll_kernels();
      if (out_.direct) {
        const double rate = has_roll_ ? sum(roll, k, *rate_kernel) / u_slow_[begin + k] : 0.0;
        const double f = sum(front, k, kernel_.smooth), r_slip = sum(rear, k, kernel_.smooth);
        first_.insert(first_.end(), {f, r_slip, 1.0, 0.0, rate, a_y});
        second_.insert(second_.end(), {f, r_slip, 1.0, 0.0, rate, dr});
      } else {
        // u r' = (u r)' - u' r
        const double d_ur = sum(ur, k, kernel_.second) - sum(du_r, k, kernel_.first);
        const double d_ua = sum(ua, k, kernel_.first) - x_ * d_ur;
        first_.insert(first_.end(),
                      {a_y, dr, 1.0, 0.0, 0.0, sum(delta, k, kernel_.smooth) - L * sum(curvature, k, kernel_.smooth)});
        second_.insert(second_.end(), {d_ua, -d_ur, 1.0, sum(u, k, kernel_.smooth),
                                       has_roll_ ? sum(roll, k, *acceleration_kernel) : 0.0,
                                       sum(v_prime, k, kernel_.smooth) + (x_ + p_.b) * dr});
      }
      out_.time.push_back(s_.grid.at(begin + k));
      index_.push_back(begin + k);
      segment_.push_back(id);
    }
  }

  /// Noise of the columns [x..., z] at a row, sensors white per sample.
  [[nodiscard]] Eigen::MatrixXd covariance(const Columns& columns) const {
    constexpr Eigen::Index n = kColumns;
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(n, n);
    const auto size = static_cast<Eigen::Index>(kernel_.smooth.taps.size());
    for (std::size_t source = 0; source < kSources; ++source) {
      if (!(variance_[source] > 0.0)) continue;
      Eigen::MatrixXd taps = Eigen::MatrixXd::Zero(size, n);
      for (Eigen::Index j = 0; j < n; ++j) {
        for (const NoiseTerm& term : columns[at(j)]) {
          if (term.source != source) continue;
          taps.col(j) += term.coefficient * Eigen::Map<const Eigen::VectorXd>(term.kernel->taps.data(), size);
        }
      }
      W += variance_[source] * taps.transpose() * taps;
    }
    return W;
  }

  /// Roll rate, or else roll.
  [[nodiscard]] DriveSignal roll_shown() const {
    return s_[DriveSignal::kRollRate].available() ? DriveSignal::kRollRate : DriveSignal::kRoll;
  }
  /// Of what is shown: its kernels for the roll's rate and acceleration.
  [[nodiscard]] std::pair<const numerics::FirKernel*, const numerics::FirKernel*> roll_kernels() const {
    if (roll_shown() == DriveSignal::kRollRate) return {&kernel_.smooth, &kernel_.first};
    return {&kernel_.first, &kernel_.second};
  }

  struct Described {
    std::array<const char*, kColumns> name;
    std::array<const char*, kColumns> unit;
  };

  void finish() {
    const auto rows = static_cast<Eigen::Index>(out_.time.size());
    const Eigen::Map<const estimation::RowMatrix> D1(first_.data(), rows, kColumns);
    const Eigen::Map<const estimation::RowMatrix> D2(second_.data(), rows, kColumns);
    Eigen::MatrixXd W1 = Eigen::MatrixXd::Zero(kColumns, kColumns), W2 = W1;
    const std::size_t every = std::max<std::size_t>(1, index_.size() / kCovarianceRows);
    double count = 0.0;
    for (std::size_t i = 0; i < index_.size(); i += every) {
      const auto [one, two] = noise_terms(index_[i]);
      W1 += covariance(one);
      W2 += covariance(two);
      count += 1.0;
    }
    if (count > 0.0) {
      W1 /= count;
      W2 /= count;
    }
    const Described first = out_.direct
                                ? Described{{"2 C_f/m", "2 C_r/m", "accel_y_bias", "", "-2 (C_f + C_r) h/m", "accel_y"},
                                            {"m/s^2", "m/s^2", "m/s^2", "", "m^2/s^2", ""}}
                                : Described{{"understeer_gradient", "yaw_lag", "steer_bias", "", "", "steer - L r/u"},
                                            {"rad s^2/m", "rad s^2", "rad", "", "", ""}};
    const Described second =
        out_.direct
            ? Described{{"2 a C_f/I_z", "-2 b C_r/I_z", "yaw_acceleration_bias", "", "2 (b C_r - a C_f) h/I_z",
                         "yaw_acceleration"},
                        {"1/s^2", "1/s^2", "rad/s^2", "", "m/s^2", ""}}
            : Described{{"rear_lag_accel", "rear_lag_yaw", "accel_y_bias", "yaw_rate_bias", "roll_arm", "-v' + b r'"},
                        {"s/m", "s", "m/s^2", "rad/s", "m", ""}};
    fill(out_.first, D1, W1, first);
    fill(out_.second, D2, W2, second);
  }

  /// Whether the recording moves a column that is there for what moves it.
  [[nodiscard]] static bool moves(const Eigen::VectorXd& column, double noise, Eigen::Index which) {
    if (column.size() == 0) return false;
    const double power = (column.array() - column.mean()).square().mean();
    return which == kSpeed ? std::sqrt(power) > kSpeedVaries * std::abs(column.mean()) : power > kRollMoves * noise;
  }

  void fill(RegressionData& data, const estimation::RowMatrix& D, const Eigen::MatrixXd& W,
            const Described& described) const {
    std::vector<Eigen::Index> used{kOne, kOther, kConstant};
    for (const Eigen::Index i : {Eigen::Index{kSpeed}, Eigen::Index{kRoll}})
      if (moves(D.col(i), W(i, i), i)) used.push_back(i);
    data.regressors = D(Eigen::all, used);
    data.regressand = D.col(kRegressand);
    data.segment = segment_;
    for (const Eigen::Index i : used) {
      data.parameter_names.emplace_back(described.name[at(i)]);
      data.parameter_units.emplace_back(described.unit[at(i)]);
    }
    data.regressand_name = described.name[kRegressand];
    used.push_back(kRegressand);
    data.error_covariance = W(used, used);
    // A recording without noise has errors of rounding.
    double& of_regressand = data.error_covariance(signed_index(used.size()) - 1, signed_index(used.size()) - 1);
    const double power = data.rows() > 0 ? data.regressand.squaredNorm() / static_cast<double>(data.rows()) : 1.0;
    of_regressand = std::max(of_regressand, 1e-20 * power + std::numeric_limits<double>::min());
    data.regressand_error_known = false;
  }

  [[nodiscard]] std::pair<Columns, Columns> noise_terms(std::size_t k) const {
    const auto or_zero = [](double v) { return std::isfinite(v) ? v : 0.0; };
    const double u = u_slow_[k], r = or_zero(r_slow_[k]), a = or_zero(a_slow_[k]);
    const double L = p_.wheelbase();
    const auto *h = &kernel_.smooth, *d = &kernel_.first, *dd = &kernel_.second;
    const Source roll_noise = roll_shown() == DriveSignal::kRollRate ? kRollRateNoise : kRollNoise;
    const auto [rate_kernel, acceleration_kernel] = roll_kernels();
    Columns one, two;
    if (out_.direct) {
      one[kOne] = two[kOne] = {{kSteerNoise, 1.0, h}, {kLateralNoise, -1.0 / u, h}, {kYawRateNoise, -p_.a / u, h}};
      one[kOther] = two[kOther] = {{kLateralNoise, -1.0 / u, h}, {kYawRateNoise, p_.b / u, h}};
      if (has_roll_) one[kRoll] = two[kRoll] = {{roll_noise, 1.0 / u, rate_kernel}};
      one[kRegressand] = {{kAccelNoise, 1.0, h}, {kYawRateNoise, 2.0 * y_ * r, h}, {kYawRateNoise, -x_, d}};
      two[kRegressand] = {{kYawRateNoise, 1.0, d}};
      return {one, two};
    }
    one[kOne] = {{kAccelNoise, 1.0, h}, {kYawRateNoise, 2.0 * y_ * r, h}, {kYawRateNoise, -x_, d}};
    one[kOther] = {{kYawRateNoise, 1.0, d}};
    one[kRegressand] = {{kSteerNoise, 1.0, h}, {kYawRateNoise, -L / u, h}, {kSpeedNoise, L * r / (u * u), h}};
    two[kOne] = {
        {kAccelNoise, u, d}, {kSpeedNoise, a, d}, {kYawRateNoise, 2.0 * y_ * r * u, d}, {kYawRateNoise, -x_ * u, dd}};
    two[kOther] = {{kYawRateNoise, -u, dd}};
    two[kSpeed] = {{kSpeedNoise, 1.0, h}};
    if (has_roll_) two[kRoll] = {{roll_noise, 1.0, acceleration_kernel}};
    two[kRegressand] = {{kYawRateNoise, u, h},
                        {kSpeedNoise, r, h},
                        {kAccelNoise, -1.0, h},
                        {kYawRateNoise, -2.0 * y_ * r, h},
                        {kYawRateNoise, x_ + p_.b, d}};
    return {one, two};
  }

  const DriveSignals& s_;
  std::span<const TimeSpan> spans_;
  const VehicleParameters<double>& p_;
  numerics::ModulatingKernel kernel_;
  std::size_t stride_;
  double x_ = 0.0, y_ = 0.0;
  bool has_roll_ = false;
  std::array<double, kSources> variance_{};
  std::vector<double> u_slow_, r_slow_, a_slow_, du_;  // smoothed, for coefficients of noise; rate of the speed
  std::vector<double> first_, second_;                 // rows [x, z]
  std::vector<int> segment_;
  std::vector<std::size_t> index_;
  DriveRegressions out_;
};

/// Influence of every row on the first two parameters of an estimate: theta_hat - theta = sum of rows.
Eigen::MatrixXd influence(const RegressionData& data, const RegressionEstimate& estimate) {
  const auto n = data.parameters();
  Eigen::MatrixXd W = data.error_covariance;
  Eigen::MatrixXd M = data.regressors.transpose() * data.regressors;
  if (estimate.method == Method::kOls) {
    W.setZero();
    W(n, n) = 1.0;
  } else {
    M -= static_cast<double>(data.rows()) * W.topLeftCorner(n, n);
    // All of the residual is variance of W's combination.
    Eigen::VectorXd h(n + 1);
    h << estimate.theta, -1.0;
    const double beyond = estimate.residual_sd * estimate.residual_sd - h.dot(W * h);
    W(n, n) += std::max(0.0, beyond);
  }
  const estimation::RowMatrix scores =
      estimation::errors_in_variables_scores(data.regressors, data.regressand, W, estimate.theta,
                                             estimation::ErrorRatio::kKnown)
          .rows();
  const Eigen::VectorXd scale = data.regressors.colwise().norm().transpose().cwiseMax(1e-300).cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * M * scale.asDiagonal();
  const Eigen::MatrixXd all =
      scale.asDiagonal() * numerics::solve_linear(scaled, Eigen::MatrixXd(scale.asDiagonal() * scores.transpose()));
  return all.topRows(2).transpose();
}

/// The four coefficients' covariance: what each regression gives for its two, and the correlation between the two
/// regressions from their scores over the same rows.
Eigen::Matrix4d joint_covariance(const DriveRegressions& data, const RegressionEstimate& first,
                                 const RegressionEstimate& second) {
  estimation::RowMatrix both(data.first.rows(), 4);
  both << influence(data.first, first), influence(data.second, second);
  const auto segments = estimation::segment_ranges(data.first.rows(), data.first.segment);
  const Eigen::Index window = std::max(first.lag_window, second.lag_window);
  const Eigen::Matrix4d S = estimation::long_run_covariance(both, segments, window).matrix;
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  P.topLeftCorner<2, 2>() = first.covariance.topLeftCorner(2, 2);
  P.bottomRightCorner<2, 2>() = second.covariance.topLeftCorner(2, 2);
  for (Eigen::Index i = 0; i < 2; ++i) {
    for (Eigen::Index j = 2; j < 4; ++j) {
      const double norm = std::sqrt(S(i, i) * S(j, j));
      if (!(norm > 0.0)) continue;
      P(i, j) = P(j, i) = std::clamp(S(i, j) / norm, -0.99, 0.99) * std::sqrt(P(i, i) * P(j, j));
    }
  }
  // Corners from two sources may together be indefinite: then their correlation is taken down.
  for (double share = 1.0; share > 0.05; share *= 0.8) {
    Eigen::Matrix4d Q = P;
    Q.topRightCorner<2, 2>() *= share;
    Q.bottomLeftCorner<2, 2>() *= share;
    const Eigen::Vector4d scale = Q.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
    if (numerics::PivotedCholesky(scale.asDiagonal() * Q * scale.asDiagonal()).smallest_pivot() > 1e-6) return Q;
  }
  P.topRightCorner<2, 2>().setZero();
  P.bottomLeftCorner<2, 2>().setZero();
  return P;
}

/// The four coefficients of the regressions, and their derivatives with respect to C_f, C_r and I_z.
struct BicycleCoefficients {
  Eigen::Vector4d value;
  Eigen::Matrix<double, 4, 3> slope;
};

/// Those of the bicycle with x = (C_f, C_r, I_z).
BicycleCoefficients coefficients(const Eigen::Vector3d& x, const VehicleParameters<double>& p, bool direct) {
  const double m = p.mass, a = p.a, b = p.b, L = p.wheelbase();
  const double C_f = x(0), C_r = x(1), I = x(2);
  BicycleCoefficients out;
  Eigen::Vector4d& f = out.value;
  Eigen::Matrix<double, 4, 3>& J = out.slope;
  if (direct) {
    f << 2.0 * C_f / m, 2.0 * C_r / m, 2.0 * a * C_f / I, -2.0 * b * C_r / I;
    J << 2.0 / m, 0.0, 0.0,           //
        0.0, 2.0 / m, 0.0,            //
        2.0 * a / I, 0.0, -f(2) / I,  //
        0.0, -2.0 * b / I, -f(3) / I;
    return out;
  }
  const double g_f = 0.5 / (L * C_f), g_r = 0.5 / (L * C_r);
  f << m * (b * g_f - a * g_r), I * (g_f + g_r), m * a * g_r, I * g_r;
  J << -m * b * g_f / C_f, m * a * g_r / C_r, 0.0,  //
      -I * g_f / C_f, -I * g_r / C_r, g_f + g_r,    //
      0.0, -m * a * g_r / C_r, 0.0,                 //
      0.0, -I * g_r / C_r, g_r;
  return out;
}

/// A bicycle (C_f, C_r, I_z) from coefficients, exact where they are consistent.
Eigen::Vector3d bicycle_of(const Eigen::Vector4d& theta, const VehicleParameters<double>& p, bool direct) {
  const double m = p.mass, a = p.a, b = p.b, L = p.wheelbase();
  if (direct)
    return {0.5 * m * theta(0), 0.5 * m * theta(1), 0.5 * m * (a * theta(0) / theta(2) - b * theta(1) / theta(3))};
  const double g_r = theta(2) / (m * a), g_f = (theta(0) + theta(2)) / (m * b);
  return {0.5 / (L * g_f), 0.5 / (L * g_r), theta(3) / g_r};
}

/// The bicycle nearest to four coefficients under their covariance.
struct NearestBicycle {
  Eigen::Vector3d value;       ///< C_f, C_r, I_z
  Eigen::Matrix3d covariance;  ///< of value
  double chi_square = 0.0;     ///< of what the coefficients are off by, small angles allowed for
};

/// By Gauss-Newton from `start`, in units of it; the consistency equation is one, so few steps.
NearestBicycle nearest_bicycle(const Eigen::Vector4d& theta, const Eigen::Matrix4d& P, const Eigen::Vector3d& start,
                               const VehicleParameters<double>& p, bool direct) {
  const Eigen::Vector4d scale = P.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const numerics::PivotedCholesky factor(scale.asDiagonal() * P * scale.asDiagonal());
  Eigen::Vector3d x = start;
  Eigen::Matrix3d normal;
  for (int step = 0; step < 30; ++step) {
    const BicycleCoefficients at = coefficients(x, p, direct);
    const Eigen::Matrix<double, 4, 3> A = scale.asDiagonal() * at.slope * start.asDiagonal();
    const Eigen::Vector4d e = scale.asDiagonal() * (theta - at.value);
    normal = A.transpose() * factor.solve(Eigen::MatrixXd(A));
    const Eigen::Vector3d move =
        numerics::solve_symmetric(normal, Eigen::VectorXd(A.transpose() * factor.solve(Eigen::VectorXd(e))));
    Eigen::Vector3d next = x + start.cwiseProduct(move);
    for (int halving = 0; halving < 20 && !(next.minCoeff() > 0.0); ++halving) next = 0.5 * (next + x);
    const double moved = (next - x).cwiseQuotient(start).cwiseAbs().maxCoeff();
    x = next;
    if (moved < 1e-12) break;
  }
  const Eigen::Vector4d e = scale.asDiagonal() * (theta - coefficients(x, p, direct).value);
  // The error of the small angles is no contradiction.
  const Eigen::Vector4d small_angles =
      kSmallAngleError * Eigen::Vector4d(direct ? theta(0) : theta(2), theta(1), theta(2), theta(3));
  Eigen::Matrix4d widened = P;
  widened.diagonal() += small_angles.cwiseAbs2();
  const numerics::PivotedCholesky allowed(scale.asDiagonal() * widened * scale.asDiagonal());
  return {x, start.asDiagonal() * normal.inverse() * start.asDiagonal(), e.dot(allowed.solve(Eigen::VectorXd(e)))};
}

/// What (1) alone determines: the understeer gradient and the steer bias.
AxleEstimate understeer_of(const DriveRegressions& data, const RegressionEstimate& first) {
  AxleEstimate out;
  out.method = first.method;
  out.covariance.setConstant(kInfinity);
  out.understeer_sigma = out.steer_bias_sigma = kInfinity;
  if (!first.usable() || data.direct) return out;
  out.understeer = first.theta(0);
  out.understeer_sigma = std::sqrt(first.covariance(0, 0));
  out.steer_bias = first.theta(2);
  out.steer_bias_sigma = std::sqrt(first.covariance(2, 2));
  out.understeer_only = true;
  out.degrees_of_freedom = first.degrees_of_freedom;
  return out;
}

AxleEstimate axles_of(const DriveRegressions& data, const RegressionEstimate& first, const RegressionEstimate& second,
                      const VehicleParameters<double>& p) {
  AxleEstimate out = understeer_of(data, first);
  if (!first.usable() || !second.usable()) {
    out.message = first.usable() ? second.message : first.message;
    return out;
  }
  const auto unexcited = [](const RegressionEstimate& e) {
    return std::max(e.parameters[0].unexcited_share, e.parameters[1].unexcited_share) > 0.05;
  };
  Eigen::Vector4d theta;
  theta << first.theta.head(2), second.theta.head(2);
  const Eigen::Vector3d start = bicycle_of(theta, p, data.direct);
  if (unexcited(first) || unexcited(second)) {
    out.message = fmt::format("not excited: {}{}{}", first.unexcited.empty() ? "" : first.unexcited[0].text,
                              first.unexcited.empty() || second.unexcited.empty() ? "" : ", ",
                              second.unexcited.empty() ? "" : second.unexcited[0].text);
    return out;
  }
  if (!(start.minCoeff() > 0.0) || !start.allFinite()) {
    out.message =
        fmt::format("gives C_f = {:.4g}, C_r = {:.4g}, I_z = {:.4g}: none of a vehicle", start(0), start(1), start(2));
    return out;
  }
  const NearestBicycle nearest = nearest_bicycle(theta, joint_covariance(data, first, second), start, p, data.direct);
  const Eigen::Vector3d& x = nearest.value;
  out.value = x;
  out.covariance = nearest.covariance;
  out.consistency_p =
      std::isfinite(nearest.chi_square) ? numerics::chi_square_upper_p(std::max(0.0, nearest.chi_square), 1.0) : 0.0;
  out.degrees_of_freedom = std::min(first.degrees_of_freedom, second.degrees_of_freedom);
  out.usable = x.allFinite() && x.minCoeff() > 0.0 && out.covariance.allFinite();
  out.understeer_only = false;
  const double m = p.mass, a = p.a, b = p.b, L = p.wheelbase();
  const Eigen::Vector3d slope(-0.5 * m * b / (L * x(0) * x(0)), 0.5 * m * a / (L * x(1) * x(1)), 0.0);
  out.understeer = 0.5 * m / L * (b / x(0) - a / x(1));
  out.understeer_sigma = std::sqrt(slope.dot(out.covariance * slope));
  out.message = fmt::format("{} over {} rows", estimation::to_string(out.method), data.first.rows());
  return out;
}

}  // namespace

const AxleEstimate* DriveRegressionResult::find(Method method) const {
  for (const AxleEstimate& e : axles) {
    if (e.method == method) return &e;
  }
  return nullptr;
}

DriveRegressions drive_regressions(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                   const VehicleParameters<double>& known, double pass_Hz) {
  for (const DriveSignal s : {DriveSignal::kSteer, DriveSignal::kSpeed, DriveSignal::kYawRate, DriveSignal::kAccelY}) {
    if (!signals[s].available()) {
      throw InputError(signals.source, fmt::format("has no {}, which equation error needs", kDriveSignalNames[s]));
    }
  }
  return RegressionRows(signals, spans, known, pass_Hz).run();
}

DriveRegressionResult equation_error(DriveRegressions data, const VehicleParameters<double>& known,
                                     const estimation::RegressionOptions& options) {
  DriveRegressionResult out;
  out.data = std::move(data);
  const auto least = 10 * (out.data.first.parameters() + out.data.second.parameters());
  if (out.data.first.rows() < least) {
    out.reason = fmt::format("{} rows are left within the segments, {} are needed", out.data.first.rows(), least);
    return out;
  }
  out.first = estimation::compare(out.data.first, options);
  out.second = estimation::compare(out.data.second, options);
  for (const RegressionEstimate& first : out.first.estimates) {
    const RegressionEstimate* second = out.second.find(first.method);
    if (second != nullptr) out.axles.push_back(axles_of(out.data, first, *second, known));
  }
  out.recommends = out.first.recommends && out.second.recommends;
  if (out.recommends)
    out.recommended = out.first.recommended == out.second.recommended ? out.first.recommended : Method::kGtls;
  out.reason = out.first.recommends ? out.second.reason : out.first.reason;
  return out;
}

}  // namespace veridyn::vehicle
