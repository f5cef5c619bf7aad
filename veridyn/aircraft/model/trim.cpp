#include "veridyn/aircraft/model/trim.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

namespace veridyn::aircraft {

namespace {

using numerics::Vector3;
constexpr double kTolerance = 1e-9;

template <typename Scalar>
using State8 = Eigen::Matrix<Scalar, 8, 1>;

/// x' of LinearModel's state; `u` is [de da dr throttle].
template <typename Scalar>
State8<Scalar> body_axes_rate(const Subject& s, const MassProperties& body, const State8<Scalar>& x,
                              const Eigen::Matrix<Scalar, 4, 1>& u, const TrimCondition& at) {
  Controls<Scalar> controls{u(0), u(1), u(2), u(3), Scalar(0.0)};
  controls.rotor_speed = s.propulsion.steady_rotor_speed(controls.throttle);
  const Vector3<Scalar> v = x.template head<3>();
  const Vector3<Scalar> omega = x.template segment<3>(3);
  const AeroLoads<Scalar> loads = aero_loads<Scalar>(s, v, omega, controls, Scalar(at.density));
  const Vector3<Scalar> gravity = numerics::R_body_from_ned(x(6), x(7), Scalar(0.0)) *
                                  Vector3<Scalar>(Scalar(0.0), Scalar(0.0), Scalar(at.gravity));
  const Vector3<Scalar> momentum = body.inertia.cast<Scalar>() * omega;
  State8<Scalar> rate;
  rate.template head<3>() = loads.force / Scalar(body.mass) + gravity - omega.cross(v);
  rate.template segment<3>(3) = body.inverse_inertia.cast<Scalar>() * (loads.moment - omega.cross(momentum));
  rate.template tail<2>() = numerics::euler_rates(x(6), x(7), omega).template head<2>();
  return rate;
}

/// State of steady level flight at given alpha and beta: pitch such that the path is level, rates of the turn.
template <typename Scalar>
State8<Scalar> level_state(const Scalar& alpha, const Scalar& beta, const TrimCondition& at) {
  using std::atan2;
  using std::cos;
  using std::sin;
  const Scalar phi(at.bank);
  const Scalar theta =
      atan2(Scalar(sin(beta) * sin(phi) + sin(alpha) * cos(beta) * cos(phi)), Scalar(cos(alpha) * cos(beta)));
  const double turn = at.gravity * std::tan(at.bank) / at.airspeed;
  State8<Scalar> x;
  x.template head<3>() = air_velocity(Scalar(at.airspeed), alpha, beta);
  x.template segment<3>(3) = numerics::body_rates(phi, theta, Vector3<Scalar>(Scalar(0.0), Scalar(0.0), Scalar(turn)));
  x(6) = phi;
  x(7) = theta;
  return x;
}

template <typename Scalar>
Eigen::Matrix<Scalar, 6, 1> accelerations(const Subject& s, const MassProperties& body,
                                          const Eigen::Matrix<Scalar, 6, 1>& unknown, const TrimCondition& at) {
  const State8<Scalar> x = level_state(unknown(0), unknown(1), at);
  return body_axes_rate<Scalar>(s, body, x, unknown.template tail<4>(), at).template head<6>();
}

}  // namespace

std::string Trim::message() const {
  const std::string where = fmt::format("level flight at {:g} m/s", condition.airspeed);
  const std::string state = fmt::format("alpha {:.2f} deg, elevator {:.2f} deg, throttle {:.3f}", alpha / kDegree,
                                        controls.de / kDegree, controls.throttle);
  switch (end) {
    case TrimEnd::kConverged:
      return fmt::format("{}: {}", where, state);
    case TrimEnd::kNoSolution:
      return fmt::format("{} does not exist for this aircraft: accelerations down to {:.2g} only ({})", where, residual,
                         state);
    case TrimEnd::kLimits:
      return fmt::format("{} needs more than the controls have: {}", where, state);
  }
  return {};
}

Trim find_trim(const Subject& s, const TrimCondition& at) {
  VERIDYN_ASSERT(s.inertia.has_value());
  using Jet = ceres::Jet<double, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const MassProperties body(s.mass, s.inertia->matrix());
  Trim trim;
  trim.condition = at;

  const auto norm_at = [&](const Vector6& x) {
    return accelerations<double>(s, body, x, at).lpNorm<Eigen::Infinity>();
  };
  // Thrust may not depend on throttle at small settings (it is cut at zero), so several starts are tried.
  Vector6 best = Vector6::Zero();
  double best_norm = kInfinity;
  for (const double throttle : {0.5, 0.8, 0.3, 1.0}) {
    for (const double alpha : {0.05, 0.15, -0.05}) {
      Vector6 x;
      x << alpha, 0.0, 0.0, 0.0, 0.0, throttle;
      double norm = norm_at(x);
      for (int iteration = 0; iteration < 60 && norm > 1e-13; ++iteration) {
        ++trim.iterations;
        Eigen::Matrix<Jet, 6, 1> jets;
        for (int i = 0; i < 6; ++i) jets(i) = Jet(x(i), i);
        const auto f = accelerations<Jet>(s, body, jets, at);
        Vector6 value;
        Eigen::Matrix<double, 6, 6> jacobian;
        for (int i = 0; i < 6; ++i) {
          value(i) = f(i).a;
          jacobian.row(i) = f(i).v.transpose();
        }
        if (!value.allFinite() || !jacobian.allFinite()) break;
        const Vector6 step = numerics::shortest_least_squares(jacobian, Eigen::VectorXd(value), 1e-10);
        double scale = std::min(1.0, 0.2 / std::max(1e-12, step.lpNorm<Eigen::Infinity>()));
        bool better = false;
        for (int halving = 0; halving < 30; ++halving, scale *= 0.5) {
          const Vector6 next = x - scale * step;
          const double next_norm = norm_at(next);
          if (next_norm < norm) {
            x = next;
            norm = next_norm;
            better = true;
            break;
          }
        }
        if (!better) break;
      }
      if (norm < best_norm) {
        best_norm = norm;
        best = x;
      }
      if (best_norm < kTolerance) break;
    }
    if (best_norm < kTolerance) break;
  }
  const State8<double> x = level_state(best(0), best(1), at);
  trim.alpha = best(0);
  trim.beta = best(1);
  trim.theta = x(7);
  trim.rates = x.segment<3>(3);
  trim.controls = {best(2), best(3), best(4), best(5), s.propulsion.steady_rotor_speed(best(5))};
  trim.residual = best_norm;
  const auto inside = [](double v, const Actuator& a) { return v >= a.lower - 1e-9 && v <= a.upper + 1e-9; };
  const bool reachable = inside(best(2), s.elevator) && inside(best(3), s.aileron) && inside(best(4), s.rudder) &&
                         inside(best(5), s.throttle);
  trim.end = !(best_norm < kTolerance) ? TrimEnd::kNoSolution : reachable ? TrimEnd::kConverged : TrimEnd::kLimits;
  return trim;
}

LinearModel linearise(const Subject& s, const Trim& trim) {
  VERIDYN_ASSERT(s.inertia.has_value());
  using Jet = ceres::Jet<double, 12>;
  const MassProperties body(s.mass, s.inertia->matrix());
  const State8<double> x0 = level_state(trim.alpha, trim.beta, trim.condition);
  const Eigen::Vector4d u0(trim.controls.de, trim.controls.da, trim.controls.dr, trim.controls.throttle);
  State8<Jet> x;
  Eigen::Matrix<Jet, 4, 1> u;
  for (int i = 0; i < 8; ++i) x(i) = Jet(x0(i), i);
  for (int i = 0; i < 4; ++i) u(i) = Jet(u0(i), 8 + i);
  const State8<Jet> rate = body_axes_rate<Jet>(s, body, x, u, trim.condition);
  LinearModel model;
  for (int i = 0; i < 8; ++i) {
    model.A.row(i) = rate(i).v.head<8>().transpose();
    model.B.row(i) = rate(i).v.tail<4>().transpose();
  }
  return model;
}

}  // namespace veridyn::aircraft
