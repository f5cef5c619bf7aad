#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <complex>
#include <string_view>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/model/bicycle_model.hpp"

namespace veridyn::vehicle {

/// The bicycle model about straight running at a constant speed u, for any tyre: x' = A x + B delta, y = C x + D delta
/// with x = (v, r), y = (r, a_y, beta = v/u). Cornering stiffnesses are those at the static loads. u > 0.
template <typename Scalar>
struct LinearBicycle {
  Scalar mass{0.0}, I_z{0.0}, a{0.0}, b{0.0};
  Scalar C_f{0.0}, C_r{0.0};  ///< of one tyre [N/rad]
  Scalar u{0.0};

  [[nodiscard]] Scalar wheelbase() const { return a + b; }
  /// Matrices of x' = A x + B delta, y = C x + D delta.
  [[nodiscard]] Eigen::Matrix<Scalar, 2, 2> A() const;
  [[nodiscard]] Eigen::Matrix<Scalar, 2, 1> B() const;
  [[nodiscard]] Eigen::Matrix<Scalar, 3, 2> C() const;
  [[nodiscard]] Eigen::Matrix<Scalar, 3, 1> D() const;
};

/// The linear bicycle about straight running at the speed u [m/s].
template <typename Scalar, typename Tyre>
[[nodiscard]] LinearBicycle<Scalar> linearise(const BicycleModel<Scalar, Tyre>& model, const Scalar& u) {
  const VehicleParameters<Scalar>& p = model.parameters;
  const PerWheel<Scalar> load = static_loads(p, model.gravity);
  return {p.mass,
          p.I_z,
          p.a,
          p.b,
          Scalar(model.front.cornering_stiffness(load[kFrontLeft])),
          Scalar(model.rear.cornering_stiffness(load[kRearLeft])),
          u};
}

/// The numbers by which the handling of a vehicle is described, of the linear bicycle (Milliken & Milliken 1995, ch. 5;
/// Gillespie 1992, ch. 6; terms of ISO 8855). Those that do not exist for a vehicle are infinite or NaN, as said.
template <typename Scalar>
struct BicycleCharacteristics {
  /// K = m (b/C_f - a/C_r)/(2 L) [rad s^2/m]: steer at the road wheels per lateral acceleration beyond the Ackermann
  /// angle; positive is understeer. Times 9.80665 and 180/pi: deg/g. 0.858 deg/g for the reference car.
  Scalar understeer_gradient{0.0};
  Scalar characteristic_speed{0.0};       ///< sqrt(L/K) [m/s]; infinite unless understeering
  Scalar critical_speed{0.0};             ///< sqrt(-L/K) [m/s], above it unstable; infinite unless oversteering
  Scalar neutral_steer_point{0.0};        ///< behind the centre of gravity [m]: (b C_r - a C_f)/(C_f + C_r)
  Scalar static_margin{0.0};              ///< neutral_steer_point/L
  Scalar yaw_rate_gain{0.0};              ///< r/delta = u/(L + K u^2) [1/s]
  Scalar lateral_acceleration_gain{0.0};  ///< a_y/delta = u r/delta [m/s^2/rad]
  Scalar sideslip_gain{0.0};              ///< beta/delta = (b - a m u^2/(2 C_r L))/(L + K u^2)
  Scalar curvature_gain{0.0};             ///< 1/(R delta) = 1/(L + K u^2) [1/m]
  Scalar natural_frequency{0.0};          ///< sqrt(det A) [rad/s]; NaN when the determinant is negative (unstable)
  Scalar damping_ratio{0.0};              ///< -tr A/(2 sqrt(det A)); above 1: two real eigenvalues
  Scalar yaw_rate_zero_time{0.0};         ///< T of the zero in r/delta = gain (1 + T s)/(1 + 2 zeta s/w + s^2/w^2) [s]
  /// Where the yaw rate gain has fallen to 1/sqrt(2) of its steady value [rad/s].
  Scalar bandwidth{0.0};
  Scalar peak_frequency{0.0};  ///< of the yaw rate gain [rad/s]; 0 when it falls from the beginning
  Scalar peak_ratio{0.0};      ///< its height over the steady value, >= 1
  /// 1/omega where the phase of the yaw rate is -45 deg: the time constant of a first-order lag with that phase [s].
  Scalar equivalent_time{0.0};
};
/// How many of them there are.
inline constexpr std::size_t kBicycleCharacteristics = 16;

/// The characteristics of a linear bicycle.
template <typename Scalar>
[[nodiscard]] BicycleCharacteristics<Scalar> characteristics(const LinearBicycle<Scalar>& bicycle);

/// Name and unit of each number, in the order of the struct.
struct CharacteristicField {
  const char* name;
  const char* unit;
};
/// Of all characteristics.
extern const std::array<CharacteristicField, kBicycleCharacteristics> kBicycleCharacteristicFields;
/// The characteristics in the order of `kBicycleCharacteristicFields`.
template <typename Scalar>
[[nodiscard]] std::array<Scalar, kBicycleCharacteristics> to_array(const BicycleCharacteristics<Scalar>& c) {
  return {
      c.understeer_gradient, c.characteristic_speed,      c.critical_speed, c.neutral_steer_point, c.static_margin,
      c.yaw_rate_gain,       c.lateral_acceleration_gain, c.sideslip_gain,  c.curvature_gain,      c.natural_frequency,
      c.damping_ratio,       c.yaw_rate_zero_time,        c.bandwidth,      c.peak_frequency,      c.peak_ratio,
      c.equivalent_time};
}

/// A mode of a linear system.
struct Mode {
  std::complex<double> eigenvalue;  ///< [1/s]; of a pair the one with the positive imaginary part
  double frequency_Hz = 0.0;        ///< |eigenvalue|/(2 pi), undamped
  double damping_ratio = 1.0;       ///< -Re/|eigenvalue|; negative: grows
  bool oscillates = false;
  bool stable = true;
};
/// Modes of any real matrix, slowest first.
[[nodiscard]] std::vector<Mode> modes(const Eigen::MatrixXd& A);

/// Response of yaw rate, lateral acceleration and sideslip angle to steer at one frequency.
struct BicycleResponse {
  double frequency_Hz = 0.0;
  std::complex<double> yaw_rate;              ///< [1/s]
  std::complex<double> lateral_acceleration;  ///< [m/s^2/rad]
  std::complex<double> sideslip;              ///< [1]
};
/// At one frequency [Hz].
[[nodiscard]] BicycleResponse frequency_response(const LinearBicycle<double>& bicycle, double frequency_Hz);
/// At `count` frequencies in equal ratios from `low_Hz` to `high_Hz`.
[[nodiscard]] std::vector<BicycleResponse> frequency_response(const LinearBicycle<double>& bicycle, double low_Hz,
                                                              double high_Hz, std::size_t count);

// ---- Templates ----

template <typename Scalar>
Eigen::Matrix<Scalar, 2, 2> LinearBicycle<Scalar>::A() const {
  Eigen::Matrix<Scalar, 2, 2> A;
  const Scalar first_moment = 2.0 * (a * C_f - b * C_r);
  A << -2.0 * (C_f + C_r) / (mass * u), -first_moment / (mass * u) - u, -first_moment / (I_z * u),
      -2.0 * (a * a * C_f + b * b * C_r) / (I_z * u);
  return A;
}

template <typename Scalar>
Eigen::Matrix<Scalar, 2, 1> LinearBicycle<Scalar>::B() const {
  return {2.0 * C_f / mass, 2.0 * a * C_f / I_z};
}

template <typename Scalar>
Eigen::Matrix<Scalar, 3, 2> LinearBicycle<Scalar>::C() const {
  const Eigen::Matrix<Scalar, 2, 2> rates = A();
  Eigen::Matrix<Scalar, 3, 2> C;
  C << Scalar(0.0), Scalar(1.0), rates(0, 0), rates(0, 1) + u, 1.0 / u, Scalar(0.0);
  return C;
}

template <typename Scalar>
Eigen::Matrix<Scalar, 3, 1> LinearBicycle<Scalar>::D() const {
  return {Scalar(0.0), B()(0), Scalar(0.0)};
}

namespace internal {

/// Peak, bandwidth and equivalent time of (1 + T s)/(1 + 2 zeta s/w + s^2/w^2), all from closed forms; x = frequency
/// squared.
template <typename Scalar>
BicycleCharacteristics<Scalar> with_yaw_frequencies(BicycleCharacteristics<Scalar> c) {
  using std::sqrt;
  const Scalar w2 = c.natural_frequency * c.natural_frequency;
  const Scalar T2 = c.yaw_rate_zero_time * c.yaw_rate_zero_time;
  // |H|^2 = (1 + T2 x)/(1 + p x + q x^2)
  const Scalar q = 1.0 / (w2 * w2);
  const Scalar p = (4.0 * c.damping_ratio * c.damping_ratio - 2.0) / w2;
  // |H|^2 = 1/2: q x^2 + (p - 2 T2) x - 1 = 0 has one positive root.
  const Scalar half = 0.5 * (p - 2.0 * T2);
  c.bandwidth = sqrt(2.0 * (half > 0.0 ? Scalar(0.5 / (half + sqrt(half * half + q)))
                                       : Scalar(0.5 * (sqrt(half * half + q) - half) / q)));
  // d|H|^2/dx = 0: T2 - p - 2 q x - T2 q x^2 = 0
  if (T2 - p > 0.0) {
    const Scalar x = (T2 - p) / (q + sqrt(q * q + T2 * q * (T2 - p)));
    c.peak_frequency = sqrt(x);
    c.peak_ratio = sqrt((1.0 + T2 * x) / (1.0 + p * x + q * x * x));
  } else {
    c.peak_frequency = Scalar(0.0);
    c.peak_ratio = Scalar(1.0);
  }
  // Phase -45 deg: Im = -Re of (1 + j T w)(1 - w^2/w_n^2 - 2 j zeta w/w_n), a cubic with one positive root (the phase
  // falls from 0 to -90 deg). Bisection finds it; a Newton step in Scalar carries its derivatives.
  const Scalar lag = 2.0 * c.damping_ratio / c.natural_frequency;
  const auto value = [&](const auto& w, const auto& T, const auto& L, const auto& square) {
    return 1.0 - w * w / square + L * T * w * w + T * w * (1.0 - w * w / square) - L * w;
  };
  const auto plain = [](const Scalar& s) {
    if constexpr (std::is_same_v<Scalar, double>) {
      return s;
    } else {
      return s.a;
    }
  };
  const double T = plain(c.yaw_rate_zero_time), L = plain(lag), square = plain(w2);
  double low = 0.0, high = std::sqrt(square);
  while (value(high, T, L, square) > 0.0 && high < 1e9) high *= 2.0;
  if (!(high < 1e9)) {
    c.equivalent_time = Scalar(0.0);
    return c;
  }
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (value(middle, T, L, square) > 0.0 ? low : high) = middle;
  }
  const double slope = -2.0 * low / square + 2.0 * L * T * low + T - 3.0 * T * low * low / square - L;
  const Scalar w = low - value(Scalar(low), c.yaw_rate_zero_time, lag, w2) / slope;
  c.equivalent_time = 1.0 / w;
  return c;
}

}  // namespace internal

template <typename Scalar>
BicycleCharacteristics<Scalar> characteristics(const LinearBicycle<Scalar>& s) {
  using std::sqrt;
  const Scalar L = s.wheelbase();
  BicycleCharacteristics<Scalar> c;
  c.understeer_gradient = s.mass * (s.b / s.C_f - s.a / s.C_r) / (2.0 * L);
  const Scalar& K = c.understeer_gradient;
  c.characteristic_speed = K > 0.0 ? Scalar(sqrt(L / K)) : Scalar(kInfinity);
  c.critical_speed = K < 0.0 ? Scalar(sqrt(-L / K)) : Scalar(kInfinity);
  c.neutral_steer_point = (s.b * s.C_r - s.a * s.C_f) / (s.C_f + s.C_r);
  c.static_margin = c.neutral_steer_point / L;
  const Scalar denominator = L + K * s.u * s.u;
  c.curvature_gain = 1.0 / denominator;
  c.yaw_rate_gain = s.u / denominator;
  c.lateral_acceleration_gain = s.u * s.u / denominator;
  c.sideslip_gain = (s.b - s.a * s.mass * s.u * s.u / (2.0 * s.C_r * L)) / denominator;
  const Eigen::Matrix<Scalar, 2, 2> A = s.A();
  const Scalar trace = A(0, 0) + A(1, 1);
  const Scalar determinant = A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0);
  c.yaw_rate_zero_time = s.mass * s.a * s.u / (2.0 * s.C_r * L);
  if (determinant > 0.0) {
    c.natural_frequency = sqrt(determinant);
    c.damping_ratio = -trace / (2.0 * c.natural_frequency);
    return internal::with_yaw_frequencies(c);
  }
  const Scalar none(kNaN);
  c.natural_frequency = c.damping_ratio = c.bandwidth = c.peak_frequency = c.peak_ratio = c.equivalent_time = none;
  return c;
}

}  // namespace veridyn::vehicle
