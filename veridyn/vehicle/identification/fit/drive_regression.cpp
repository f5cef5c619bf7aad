#include "veridyn/vehicle/identification/fit/drive_regression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/filtered_noise.hpp"
#include "veridyn/numerics/modulating_kernel.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::RegressionData;

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
    // One made of a course may be late, and of a heading turned: only the drive model knows of that.
    out_.direct = s_[DriveSignal::kLateralVelocity].available() && !s_.lateral_by_course;
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
    numerics::FilteredNoise noise(kColumns, variance_, kernel_.smooth.taps.size());
    for (Eigen::Index j = 0; j < kColumns; ++j)
      for (const NoiseTerm& term : columns[j]) noise.add(j, term.source, term.coefficient, *term.kernel);
    return noise.covariance();
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
      data.parameter_names.emplace_back(described.name[i]);
      data.parameter_units.emplace_back(described.unit[i]);
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

}  // namespace

DriveRegressions drive_regressions(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                   const VehicleParameters<double>& known, double pass_Hz) {
  for (const DriveSignal s : {DriveSignal::kSteer, DriveSignal::kSpeed, DriveSignal::kYawRate, DriveSignal::kAccelY}) {
    if (!signals[s].available()) {
      throw InputError(signals.source, fmt::format("has no {}, which equation error needs", kDriveSignalNames[s]));
    }
  }
  return RegressionRows(signals, spans, known, pass_Hz).run();
}

}  // namespace veridyn::vehicle
