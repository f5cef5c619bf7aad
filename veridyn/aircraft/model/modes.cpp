#include "veridyn/aircraft/model/modes.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "veridyn/aircraft/model/flight_dynamics.hpp"

namespace veridyn::aircraft {
namespace {

using Root = std::complex<double>;

/// Places in the state of LinearModel.
enum MotionState : Eigen::Index { kVelocityX, kVelocityY, kVelocityZ, kRollRate, kPitchRate, kYawRate, kBank, kPitch };

bool is_known(const Subject& s, Coefficient c) {
  const CoefficientModel* model = s.model.find(c);
  return model != nullptr && model->known();
}

/// The subject without the coefficients that are not known.
Subject known_part(Subject s) {
  for (auto& coefficient : s.model.coefficients)
    if (coefficient && !coefficient->known()) coefficient.reset();
  return s;
}

/// What is left of forces [N] and pitching moment [N m] in straight and level flight.
struct LeftOver {
  double x = 0.0, z = 0.0, moment = 0.0;
};

LeftOver left_over(const Subject& s, const Trim& at) {
  const TrimCondition& c = at.condition;
  const numerics::Vector3<double> v = air_velocity(c.airspeed, at.alpha, 0.0);
  const AeroLoads<double> loads = aero_loads<double>(s, v, numerics::Vector3<double>::Zero(), at.controls, c.density);
  const double weight = s.mass * c.gravity, x = loads.force.x() - weight * std::sin(at.alpha);
  // An engine that is not modelled pulls as much as is missing.
  const double engine = s.propulsion.kind == PropulsionKind::kNone ? -x * s.propulsion.position[2] : 0.0;
  return {x, loads.force.z() + weight * std::cos(at.alpha), loads.moment.y() + engine};
}

/// A root of f near x by the secant method; x where there is none.
template <typename Function>
double root_near(double x, const Function& f) {
  constexpr double kStep = 0.01, kFar = 0.3, kTolerance = 1e-10;
  double before = x, f_before = f(x), at = x + kStep;
  for (int i = 0; i < 50; ++i) {
    const double f_at = f(at);
    const double next = at - f_at * (at - before) / (f_at - f_before);
    if (!std::isfinite(next) || std::abs(next - x) > kFar) return x;
    if (std::abs(next - at) < kTolerance) return next;
    before = at;
    f_before = f_at;
    at = next;
  }
  return x;
}

/// Alpha where the lift carries the weight, elevator where nothing pitches; each as it was where there is none near.
void balance(const Subject& s, bool pitch, Trim& at) {
  constexpr int kRounds = 5;  // the elevator carries little
  for (int i = 0; i < kRounds; ++i) {
    Trim tried = at;
    at.alpha = root_near(at.alpha, [&](double alpha) {
      tried.alpha = alpha;
      return left_over(s, tried).z;
    });
    if (!pitch) return;
    tried = at;
    at.controls.de = root_near(at.controls.de, [&](double de) {
      tried.controls.de = de;
      return left_over(s, tried).moment;
    });
  }
}

/// Controls with the throttle where the thrust balances the drag, by bisection; as they were where none does.
Controls<double> balanced_controls(const Subject& s, Trim at) {
  const Controls<double> given = at.controls;
  const auto excess = [&](double throttle) {
    at.controls.throttle = throttle;
    at.controls.rotor_speed = s.propulsion.steady_rotor_speed(throttle);
    return left_over(s, at).x;
  };
  double low = 0.0, high = 1.0;
  if (excess(low) > 0.0 || excess(high) < 0.0) return given;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (excess(middle) > 0.0 ? high : low) = middle;
  }
  excess(0.5 * (low + high));
  return at.controls;
}

void add(const SpeedEffects& effects, const Subject& s, const Trim& at, LinearModel& model) {
  const TrimCondition& c = at.condition;
  model.A(kVelocityZ, kVelocityX) -= 2.0 * effects.lift * c.gravity * std::cos(at.alpha) / c.airspeed;
  if (s.propulsion.kind != PropulsionKind::kNone) return;
  const double thrust_per_airspeed = effects.thrust * left_over(s, at).x / c.airspeed;
  model.A(kVelocityX, kVelocityX) += thrust_per_airspeed / s.mass;
  model.A(kPitchRate, kVelocityX) += s.propulsion.position[2] * thrust_per_airspeed / s.inertia->Jy;
}

/// Of two states alone.
NaturalMode mode_of(const LinearModel& model, MotionState a, MotionState b) {
  const double half = 0.5 * (model.A(a, a) + model.A(b, b));
  const double determinant = model.A(a, a) * model.A(b, b) - model.A(a, b) * model.A(b, a);
  const Root root = std::sqrt(Root(half * half - determinant));
  return {half + root, half - root};
}

/// The roots of a mode of the whole aircraft, where there are as many as the mode has.
std::optional<NaturalMode> natural(Mode mode, const std::vector<LinearMode>& all) {
  std::vector<Root> roots;
  for (const LinearMode& one : all) {
    if (one.mode != mode) continue;
    roots.push_back(one.s);
    if (one.s.imag() != 0.0) roots.push_back(std::conj(one.s));
  }
  if (roots.size() != (has_two_roots(mode) ? 2u : 1u)) return std::nullopt;
  return NaturalMode{roots.front(), roots.back()};
}

}  // namespace

double NaturalMode::frequency() const {
  const double product = (first * second).real();
  return product > 0.0 ? std::sqrt(product) : kNaN;
}

double NaturalMode::damping() const { return -0.5 * (first + second).real() / frequency(); }

double NaturalMode::decay() const { return -std::max(first.real(), second.real()); }

FlightModes flight_modes(const Subject& subject, const Trim& near, const SpeedEffects& effects) {
  FlightModes out;
  out.load_factor_per_alpha = out.control_anticipation = kNaN;
  if (!subject.inertia) return out;
  const auto known = [&](Coefficient c) { return is_known(subject, c); };
  const bool lift = known(Coefficient::kCL), drag = known(Coefficient::kCD), pitch = known(Coefficient::kCm);
  const bool side = known(Coefficient::kCY), roll = known(Coefficient::kCl), yaw = known(Coefficient::kCn);
  const Subject s = known_part(subject);
  Trim at = near;
  at.beta = 0.0;
  at.condition.bank = 0.0;
  if (lift) balance(s, pitch, at);
  if (drag && s.propulsion.kind != PropulsionKind::kNone) at.controls = balanced_controls(s, at);
  LinearModel model = linearise(s, at);
  if (drag) add(effects, s, at, model);
  if (!model.A.allFinite()) return out;
  const std::vector<LinearMode> all = linear_modes(model);
  if (lift) out.load_factor_per_alpha = -at.condition.airspeed * model.A(kVelocityZ, kVelocityZ) / at.condition.gravity;
  if (lift && pitch) {
    out.longitudinal_whole = drag;
    out.modes[Mode::kShortPeriod] = drag ? natural(Mode::kShortPeriod, all) : mode_of(model, kVelocityZ, kPitchRate);
    if (drag) out.modes[Mode::kPhugoid] = natural(Mode::kPhugoid, all);
    if (const auto& found = out.modes[Mode::kShortPeriod])
      out.control_anticipation = std::pow(found->frequency(), 2) / out.load_factor_per_alpha;
  }
  out.lateral_whole = side && roll && yaw;
  if (out.lateral_whole) {
    for (const Mode mode : {Mode::kDutchRoll, Mode::kRoll, Mode::kSpiral}) out.modes[mode] = natural(mode, all);
    return out;
  }
  if (side && yaw) out.modes[Mode::kDutchRoll] = mode_of(model, kVelocityY, kYawRate);
  if (roll) out.modes[Mode::kRoll] = {model.A(kRollRate, kRollRate), model.A(kRollRate, kRollRate)};
  return out;
}

}  // namespace veridyn::aircraft
