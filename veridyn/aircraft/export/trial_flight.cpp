#include "veridyn/aircraft/export/trial_flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <utility>

#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/matrix_exponential.hpp"
#include "veridyn/numerics/ode.hpp"

namespace veridyn::aircraft {
namespace {

using Vector8 = Eigen::Matrix<double, 8, 1>;
constexpr double kStep = 0.0025, kPulse = 0.5, kLongest = 20.0;  // s
constexpr std::array<std::string_view, 3> kSurfaces = {"elevator", "aileron", "rudder"};

/// +1, -1, then nothing.
double doublet(double t) { return t < kPulse ? 1.0 : t < 2.0 * kPulse ? -1.0 : 0.0; }

/// How large the linear motion after a doublet of one radian is, in units of what is small: 1 deg, 10 deg/s.
double linear_size(const LinearModel& model, int surface, double airspeed) {
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(9, 9);
  system.topLeftCorner(8, 8) = model.A;
  system.topRightCorner(8, 1) = model.B.col(surface);
  const double h = 0.01;
  const Eigen::MatrixXd step = numerics::matrix_exponential(Eigen::MatrixXd(h * system));
  const double angle = airspeed * kDegree, rate = 10.0 * kDegree;
  Vector8 small;
  small << kInfinity, angle, angle, rate, rate, rate, kInfinity, kInfinity;
  Vector8 x = Vector8::Zero();
  double largest = 0.0;
  for (double t = 0.0; t < 3.0; t += h) {
    x = step.topLeftCorner(8, 8) * x + step.topRightCorner(8, 1) * doublet(t);
    largest = std::max(largest, x.cwiseQuotient(small).cwiseAbs().maxCoeff());
  }
  return largest;
}

/// Deviations [u v w p q r phi theta] from the trim at every step of a flight with a doublet of one surface.
std::vector<Vector8> fly_doublet(const Subject& subject, const Trim& trim, int surface, double amplitude,
                                 double duration) {
  const MassProperties body(subject.mass, subject.inertia->matrix());
  RigidBodyState<double> x = RigidBodyState<double>::Zero();
  const Eigen::Quaterniond attitude = numerics::quaternion_from_euler(0.0, trim.theta, 0.0);
  x.segment<3>(3) = attitude * air_velocity(trim.condition.airspeed, trim.alpha, trim.beta);
  x.segment<4>(6) = attitude.coeffs();
  const auto motion = [](const RigidBodyState<double>& state) {
    Vector8 out;
    const auto euler = numerics::euler_from_quaternion(attitude_of(state));
    out << R_body_from_ned(state) * state.segment<3>(3), state.tail<3>(), euler.phi, euler.theta;
    return out;
  };
  const Vector8 steady = motion(x);
  std::vector<Vector8> flown = {Vector8::Zero()};
  for (int k = 0; k * kStep < duration; ++k) {
    Controls<double> controls = trim.controls;
    double* deflections[] = {&controls.de, &controls.da, &controls.dr};
    *deflections[surface] += amplitude * doublet((k + 0.5) * kStep);
    const auto rate = [&](double, const RigidBodyState<double>& state) {
      return aircraft_rate<double>(subject, body, state, controls, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                   trim.condition.density, trim.condition.gravity);
    };
    x = numerics::runge_kutta_4_step(rate, 0.0, x, kStep);
    if (!x.allFinite()) break;
    normalise_attitude(x);
    flown.push_back(motion(x) - steady);
  }
  return flown;
}

/// Time in which a mode grows or dies away by e [s], as far as it is followed.
double time_constant(const LinearMode& mode) { return 1.0 / std::max(std::abs(mode.s.real()), 1.0 / kLongest); }

/// Slope of the logarithm of a mode's size from the end of the doublet on; nothing where it cannot be followed.
std::optional<double> growth_of(const LinearMode& mode, const std::vector<Vector8>& flown) {
  const double begin = 2.0 * kPulse, end = begin + std::min(2.0 * time_constant(mode), kLongest);
  const auto first = static_cast<std::size_t>(std::ceil(begin / kStep)), last = static_cast<std::size_t>(end / kStep);
  if (last >= flown.size() || last < first + 4) return std::nullopt;
  const double middle = 0.5 * static_cast<double>(first + last);
  double tt = 0.0, ty = 0.0;
  for (std::size_t k = first; k <= last; ++k) {
    const double size = std::abs((mode.left.transpose() * flown[k].cast<std::complex<double>>())(0));
    if (!(size > 0.0)) return std::nullopt;
    const double t = (static_cast<double>(k) - middle) * kStep;
    tt += t * t;
    ty += t * std::log(size);
  }
  return ty / tt;
}

/// Doublets that keep the linear motion small, within half of the travel that is left.
std::array<double, 3> amplitudes_of(const Subject& s, const Trim& trim, const LinearModel& model) {
  std::array<double, 3> amplitudes{};
  const Actuator* actuators[] = {&s.elevator, &s.aileron, &s.rudder};
  const double at[] = {trim.controls.de, trim.controls.da, trim.controls.dr};
  for (int i = 0; i < 3; ++i) {
    const double travel = 0.5 * std::min(actuators[i]->upper - at[i], at[i] - actuators[i]->lower);
    const double size = linear_size(model, i, trim.condition.airspeed);
    amplitudes[i] = size > 0.0 ? std::min(1.0 / size, travel) : 0.0;
  }
  return amplitudes;
}

/// "natural frequency 4.1 rad/s, damping 0.62", "time constant 0.08 s", "doubles in 20 s".
std::string described(const LinearMode& mode) {
  const double size = std::abs(mode.s), rate = mode.s.real();
  if (mode.s.imag() > 0.0) return fmt::format("natural frequency {:.3g} rad/s, damping {:.2g}", size, -rate / size);
  return rate < 0.0 ? fmt::format("time constant {:.3g} s", -1.0 / rate)
                    : fmt::format("doubles in {:.3g} s", std::log(2.0) / rate);
}

std::string said(const FlownMode& mode) {
  const char* model = mode.linear.stable() ? "stable" : "unstable";
  switch (mode.verdict) {
    case ModeVerdict::kAsPredicted:
      return fmt::format("{}, and flies so", model);
    case ModeVerdict::kOtherwise:
      return fmt::format("{} by the model ({:.3g} 1/s), but flown it {} ({:.3g} 1/s)", model, mode.linear.s.real(),
                         mode.growth < 0.0 ? "died away" : "grew", mode.growth);
    case ModeVerdict::kNotSeparated:
      return fmt::format("{} by the model, not seen in flight", model);
  }
  return {};
}

/// The subject without what turns and sideslips it in symmetric flight.
Subject symmetric(Subject s) {
  for (const Coefficient c : {Coefficient::kCY, Coefficient::kCl, Coefficient::kCn}) {
    CoefficientModel* model = s.model.find(c);
    for (std::size_t i = 0; model != nullptr && i < model->size(); ++i)
      if (model->terms[i].constant()) model->values[i] = 0.0;
  }
  return s;
}

}  // namespace

bool TrialFlight::as_predicted() const {
  return trim.usable() &&
         std::ranges::none_of(modes, [](const FlownMode& m) { return m.verdict == ModeVerdict::kOtherwise; });
}

std::vector<std::string> TrialFlight::unstable() const {
  std::vector<std::string> names;
  for (const FlownMode& m : modes)
    if (!m.linear.stable()) names.emplace_back(words_of(m.linear.mode));
  return names;
}

TrialFlight fly_trial(const CompletedSubject& completed) {
  Subject s = completed.subject;
  TrialFlight trial{.condition = completed.condition};
  const TrimCondition at{.airspeed = trial.condition.airspeed, .density = trial.condition.density};
  trial.trim = find_trim(s, at);
  if (trial.trim.end == TrimEnd::kNoSolution) {
    if (const Trim trim = find_trim(symmetric(s), at); trim.usable()) {
      trial.trim = trim;
      trial.without_asymmetry = true;
      s = symmetric(std::move(s));
    }
  }
  if (!trial.trim.usable()) return trial;
  const LinearModel model = linearise(s, trial.trim);
  const std::vector<LinearMode> modes = linear_modes(model);
  double longest = 0.0;
  for (const LinearMode& mode : modes) longest = std::max(longest, std::min(2.0 * time_constant(mode), kLongest));
  const std::array<double, 3> amplitudes = amplitudes_of(s, trial.trim, model);
  std::array<std::vector<Vector8>, 3> flown;
  for (int i = 0; i < 3; ++i)
    if (amplitudes[i] > 0.0) flown[i] = fly_doublet(s, trial.trim, i, amplitudes[i], 2.0 * kPulse + longest + kStep);
  for (const LinearMode& mode : modes) {
    FlownMode out{.linear = mode, .surface = {}};
    double largest = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double moved =
          amplitudes[i] * std::abs((mode.left.transpose() * model.B.col(i).cast<std::complex<double>>())(0));
      if (!(moved > largest)) continue;
      const std::optional<double> growth = growth_of(mode, flown[i]);
      if (!growth) continue;
      largest = moved;
      out.surface = kSurfaces[i];
      out.growth = *growth;
      const double off = std::abs(*growth - mode.s.real());
      out.verdict =
          off < std::max(0.02, 0.25 * std::abs(mode.s.real())) ? ModeVerdict::kAsPredicted : ModeVerdict::kOtherwise;
    }
    trial.modes.push_back(std::move(out));
  }
  return trial;
}

double standard_altitude(double density) {
  double low = -2000.0, high = 20000.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (standard_atmosphere(middle).density > density ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

std::vector<std::string> trial_lines(const TrialFlight& trial) {
  const std::string where =
      fmt::format("{:.4g} m/s and {:.0f} m", trial.condition.airspeed, standard_altitude(trial.condition.density));
  if (!trial.trim.usable()) return {fmt::format("not trimmed at {}: {}", where, trial.trim.message())};
  const Controls<double>& controls = trial.trim.controls;
  std::vector<std::string> lines = {
      fmt::format("trimmed at {} ({}): alpha {:.2f} deg, elevator {:.2f} deg, throttle {:.3f}", where,
                  trial.condition.source, trial.trim.alpha / kDegree, controls.de / kDegree, controls.throttle)};
  if (trial.without_asymmetry)
    lines.front() += ", without CY_0, Cl_0 and Cn_0, which no rudder holds: straight flight takes some bank";
  for (const FlownMode& mode : trial.modes)
    lines.push_back(fmt::format("{:<13} {}: {}", words_of(mode.linear.mode), described(mode.linear), said(mode)));
  return lines;
}

}  // namespace veridyn::aircraft
