#include "veridyn/aircraft/reconstruction/information_bound.hpp"

#include <ceres/jet.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

AngleBound bound(double length, double intensity, double airspeed, double vane_sigma, double rate_Hz) {
  using Eigen::Matrix2d, Eigen::Vector2d;
  const double step = airspeed / (length * rate_Hz);
  const double e = std::exp(-step);
  Matrix2d F, Pi;
  F << e, 0.0, step * e, e;
  Pi << 0.5, 0.25, 0.25, 0.25;
  const Matrix2d Q = Pi - F * Pi * F.transpose();
  const double gain = intensity * std::sqrt(3.0) / airspeed;
  const Vector2d H(gain, -gain * (1.0 - 1.0 / std::sqrt(3.0)));

  // Both recursions forget their start within a few correlation times of the gust.
  const int steps = static_cast<int>(std::ceil(40.0 / step));
  Matrix2d before = Pi, after = Pi;
  Vector2d K = Vector2d::Zero();
  double S = 1.0;
  for (int i = 0; i < steps; ++i) {
    S = H.dot(before * H) + vane_sigma * vane_sigma;
    K = before * H / S;
    after = before - S * K * K.transpose();
    before = F * after * F.transpose() + Q;
  }
  const Matrix2d C = Matrix2d::Identity() - K * H.transpose();
  Matrix2d Lambda = Matrix2d::Zero();
  for (int i = 0; i < steps; ++i) {
    Lambda = F.transpose() * (H * H.transpose() / S + C.transpose() * Lambda * C) * F;
  }
  const Matrix2d smoothed = after - after * Lambda * after;
  return {std::sqrt(H.dot(after * H)), std::sqrt(H.dot(smoothed * H))};
}

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

/// Where the aircraft flies: velocity relative to the air, rates (none) and controls.
struct SteadyPoint {
  double alpha = 0.0;
  Controls<double> controls;
  double thrust = 0.0;  ///< added along x where the controls do not make it [N]
  bool usable = false;
};

/// Specific force at v_r = v0 - gust with its derivatives by the gust along the axes.
template <typename S>
numerics::Vector3<S> specific_force(const Subject& s, const numerics::Vector3<S>& v_r, const SteadyPoint& at,
                                    double density) {
  Controls<S> c;
  c.de = S(at.controls.de);
  c.da = S(at.controls.da);
  c.dr = S(at.controls.dr);
  c.throttle = S(at.controls.throttle);
  c.rotor_speed = S(s.propulsion.steady_rotor_speed(at.controls.throttle));
  const numerics::Vector3<S> none = numerics::Vector3<S>::Zero();
  numerics::Vector3<S> a = aero_loads<S>(s, v_r, none, c, S(density)).force * S(1.0 / s.mass);
  a(0) += S(at.thrust / s.mass);
  return a;
}

/// Level flight by the forces alone: L + T sin(alpha) = m g, T cos(alpha) = D, by Newton's method in alpha and T.
SteadyPoint balance_forces(const Subject& s, double airspeed, double density) {
  SteadyPoint at;
  Subject still = s;
  still.propulsion = {};
  double alpha = 0.05, thrust = 0.0;
  for (int i = 0; i < 50; ++i) {
    using Jet = ceres::Jet<double, 2>;
    const Jet a(alpha, 0), T(thrust, 1);
    const numerics::Vector3<Jet> v(cos(a) * airspeed, Jet(0.0), sin(a) * airspeed);
    const auto f = specific_force<Jet>(still, v, SteadyPoint{}, density);
    const Jet along = f(0) + T / s.mass - sin(a) * kGravity;
    const Jet down = f(2) + cos(a) * kGravity;
    Eigen::Matrix2d J;
    J.row(0) = along.v.transpose();
    J.row(1) = down.v.transpose();
    const Eigen::Vector2d step = J.partialPivLu().solve(Eigen::Vector2d(along.a, down.a));
    if (!step.allFinite()) break;
    alpha -= step(0);
    thrust -= step(1);
    at.usable = step.norm() < 1e-9 * (1.0 + std::abs(thrust)) && std::abs(alpha) < 1.0;
    if (at.usable) break;
  }
  at.alpha = alpha;
  at.thrust = thrust;
  return at;
}

SteadyPoint steady_point(const Subject& s, double airspeed, double density) {
  if (s.inertia && s.model.find(Coefficient::kCm) != nullptr && s.model.unknown_parameters().empty() &&
      s.propulsion.kind != PropulsionKind::kNone) {
    const Trim trim = find_trim(s, {.airspeed = airspeed, .density = density});
    if (trim.usable()) return {.alpha = trim.alpha, .controls = trim.controls, .usable = true};
  }
  return balance_forces(s, airspeed, density);
}

/// The gusts' states, as in AirDataModel: transition over a sample, stationary covariance, gust [m/s] per state.
struct GustStates {
  Matrix5 F = Matrix5::Zero();
  Matrix5 Pi = Matrix5::Zero();
  Eigen::Matrix<double, 3, 5> G = Eigen::Matrix<double, 3, 5>::Zero();
};

GustStates gust_states(const DrydenSettings& spectrum, double airspeed, const BoundSensors& sensors) {
  GustStates gusts;
  gusts.F(0, 0) = std::exp(-airspeed / (spectrum.Lu * sensors.rate_Hz));
  gusts.Pi(0, 0) = 1.0;
  gusts.G(0, 0) = sensors.airspeed_known ? 0.0 : spectrum.sigma_u;
  const auto pair = [&](int row, int i, double length, double intensity) {
    const double step = airspeed / (length * sensors.rate_Hz);
    gusts.F.block<2, 2>(i, i) << std::exp(-step), 0.0, step * std::exp(-step), std::exp(-step);
    gusts.Pi.block<2, 2>(i, i) << 0.5, 0.25, 0.25, 0.25;
    gusts.G(row, i) = intensity * std::sqrt(3.0);
    gusts.G(row, i + 1) = -intensity * (std::sqrt(3.0) - 1.0);
  };
  pair(1, 1, spectrum.Lv, spectrum.sigma_v);
  pair(2, 3, spectrum.Lw, spectrum.sigma_w);
  return gusts;
}

}  // namespace

ModelBound information_bound(const DrydenSettings& spectrum, const Subject& subject, double airspeed,
                             const BoundSensors& sensors, double air_density) {
  ModelBound bound;
  Subject forces = subject;
  const SteadyPoint at = steady_point(subject, airspeed, air_density);
  bound.trim_alpha = at.alpha;
  if (!at.usable) return bound;
  if (at.thrust != 0.0) forces.propulsion = {};

  const GustStates gusts = gust_states(spectrum, airspeed, sensors);
  const Matrix5 &F = gusts.F, &Pi = gusts.Pi;
  const auto& G = gusts.G;
  const Matrix5 Q = Pi - F * Pi * F.transpose();

  using Jet = ceres::Jet<double, 3>;
  const Eigen::Vector3d v0(airspeed * std::cos(at.alpha), 0.0, airspeed * std::sin(at.alpha));
  numerics::Vector3<Jet> v;
  for (int i = 0; i < 3; ++i) {
    v(i) = Jet(v0(i));
    v(i).v(i) = -1.0;  // by the gust
  }
  const auto air = air_data(v);
  const auto force = specific_force<Jet>(forces, v, at, air_density);
  std::vector<std::pair<Vector5, double>> measurements;
  const auto measure = [&](const Jet& y, double sigma) {
    Eigen::Vector3d by_gust = y.v;
    if (sensors.airspeed_known) by_gust -= v0 * (v0.dot(by_gust) / v0.squaredNorm());
    if (sigma > 0.0) measurements.emplace_back(G.transpose() * by_gust, sigma * sigma);
  };
  measure(air.alpha, sensors.alpha);
  measure(air.beta, sensors.beta);
  measure(Jet(0.5 * air_density) * air.Va * air.Va, sensors.dynamic_pressure);
  for (int i = sensors.axial_force ? 0 : 1; i < 3; ++i) measure(force(i), sensors.accelerometer);

  // Information form of the update: all measurements of one time at once.
  Matrix5 information = Matrix5::Zero();
  for (const auto& [H, variance] : measurements) information += H * H.transpose() / variance;
  const int steps = static_cast<int>(
      std::ceil(40.0 * std::max({spectrum.Lu, spectrum.Lv, spectrum.Lw}) * sensors.rate_Hz / airspeed));
  Matrix5 before = Pi, after = Pi;
  for (int i = 0; i < steps; ++i) {
    after = (Matrix5::Identity() + before * information).partialPivLu().solve(before);
    after = (0.5 * (after + after.transpose())).eval();
    const Matrix5 next = F * after * F.transpose() + Q;
    const bool settled = (next - before).cwiseAbs().maxCoeff() < 1e-14;
    before = next;
    if (settled) break;
  }
  // Information that comes from the future about the state before a measurement (two-filter form): Lambda satisfies
  // Lambda = F' [(information + Lambda)^-1 + Q]^-1 F, evaluated without inverting what may be singular.
  Matrix5 Lambda = Matrix5::Zero();
  for (int i = 0; i < steps; ++i) {
    const Matrix5 later = information + Lambda;
    const Matrix5 inner = (Matrix5::Identity() + later * Q).partialPivLu().solve(later);
    const Matrix5 next = F.transpose() * inner * F;
    const bool settled = (next - Lambda).cwiseAbs().maxCoeff() < 1e-10 * (1.0 + next.cwiseAbs().maxCoeff());
    Lambda = 0.5 * (next + next.transpose());
    if (settled) break;
  }
  const Matrix5 smoothed = (Matrix5::Identity() + after * Lambda).partialPivLu().solve(after);
  const auto of = [&](const Jet& y) -> AngleBound {
    const Vector5 h = G.transpose() * y.v;
    return {std::sqrt(h.dot(after * h)), std::sqrt(h.dot(smoothed * h))};
  };
  bound.angles = {of(air.alpha), of(air.beta)};
  bound.airspeed = of(air.Va);
  bound.usable = true;
  return bound;
}

InformationBound information_bound(const DrydenSettings& spectrum, double airspeed, double vane_sigma, double rate_Hz) {
  return {bound(spectrum.Lw, spectrum.sigma_w, airspeed, vane_sigma, rate_Hz),
          bound(spectrum.Lv, spectrum.sigma_v, airspeed, vane_sigma, rate_Hz)};
}

}  // namespace veridyn::aircraft
