#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/aircraft/identification/signals/flight_signals.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/open_loop/open_loop_model.hpp"
#include "veridyn/estimation/output_error/autodiff_model.hpp"

namespace veridyn::aircraft {

/// The aircraft's motion as a parametric model for output error: simulated from measured deflections and thrust, with
/// the parameters of the given coefficients as unknowns and an initial state per segment.
///
/// State Va, alpha, beta, p, q, r, phi, theta. A state is simulated when the coefficient that moves it is among
/// `coefficients` (CD: Va, CL: alpha, CY: beta, Cl: p and phi, Cm: q and theta, Cn: r); the others are driven by their
/// measurement, and a coefficient that is not modelled is taken as measured. With all six it is the full rigid body.
/// Equations: body-axes forces and moments with the inertia tensor, engine and force point as in `flight_dynamics.hpp`,
/// velocity relative to the air,
///
///     v' = F/m + g - omega x v - a_w,    Va' = v.v'/Va, ...
///
/// a_w [m/s^2, body axes] is how fast the air at the aircraft changes its velocity: 0 in uniform air, or the derivative
/// of the reconstructed gust. Outputs: the simulated states, and specific forces where their coefficients are modelled.
/// Fourth-order Runge-Kutta over one or two grid steps (at most 20 ms where the grid allows), inputs at their own
/// samples. Diverged: Va below 2 m/s or an angle of 80 deg.
///
/// For simulations that nothing corrects (see open_loop.hpp) parameters can be fixed, constants added to coefficients,
/// and the integration made as fine as desired (`Simulation`).
class OutputErrorModel : public estimation::AutodiffModel<OutputErrorModel, 8, estimation::OpenLoopModel> {
 public:
  /// View of the parts of a flight that are simulated.
  struct FlownSpans {
    const FlightSignals& signals;
    std::span<const TimeSpan> spans;
    bool gusts = false;     ///< whether the reconstructed gust drives the simulation
    std::string name = {};  ///< of the flight, where there are several
  };
  /// What is simulated, and how finely.
  struct Simulation {
    bool fixed_parameters = false;  ///< parameters stay at their values: only initial conditions are unknowns
    bool stall = false;             ///< CL and CD with the subject's stall blend, as a simulator flies them
    /// The thrust is that at the simulated airspeed, where it was computed from the throttle; false: at the measured
    /// one.
    bool own_thrust = false;
    /// Constants of each segment that are added to these coefficients, where they are modelled; they follow its initial
    /// state among the initial conditions.
    std::vector<Coefficient> offsets = {};
    /// Steps of the integration in each interval of the grid, inputs linear in between; 0: one step over one or two
    /// intervals, inputs at their own samples.
    int steps_per_sample = 0;
  };
  /// Several flights with the same parameters; each segment has its own initial state.
  /// @param flights  on grids of one rate, at least one
  /// @param coefficients terms, with starting values; parameters in this order
  OutputErrorModel(std::span<const FlownSpans> flights, const Subject& subject,
                   std::span<const CoefficientModel> coefficients);
  OutputErrorModel(std::span<const FlownSpans> flights, const Subject& subject,
                   std::span<const CoefficientModel> coefficients, Simulation simulation);
  /// One flight alone.
  OutputErrorModel(const FlightSignals& signals, std::span<const TimeSpan> spans, const Subject& subject,
                   std::span<const CoefficientModel> coefficients, bool gusts);

  [[nodiscard]] std::span<const estimation::ModelParameter> parameters() const override { return parameters_; }
  [[nodiscard]] std::span<const estimation::ModelOutput> outputs() const override { return outputs_; }
  [[nodiscard]] std::size_t segments() const override { return segments_.size(); }
  [[nodiscard]] Eigen::Index samples(std::size_t segment) const override { return segments_[segment].samples; }
  [[nodiscard]] std::span<const estimation::ModelParameter> initial_conditions(std::size_t segment) const override {
    return segments_[segment].initial;
  }
  [[nodiscard]] std::string segment_name(std::size_t segment) const override;

  /// What was measured of the outputs, per segment.
  [[nodiscard]] std::vector<estimation::RowMatrix> measured() const override;
  /// Where a segment lies in its flight.
  [[nodiscard]] TimeSpan segment_span(std::size_t segment) const override;
  /// Between two samples of the outputs [s].
  [[nodiscard]] double sample_interval_s() const override { return step_; }
  /// The states that are simulated, which are the first outputs.
  [[nodiscard]] std::size_t forecast_outputs() const override {
    return static_cast<std::size_t>(std::ranges::count(simulated_, true));
  }
  /// The samples of a segment before it diverges, all where it does not.
  [[nodiscard]] Eigen::Index samples_before_divergence(std::size_t segment,
                                                       const Eigen::VectorXd& theta) const override;
  /// Leaves the first `samples` of a segment. @param samples  at most those that it has
  void shorten(std::size_t segment, Eigen::Index samples) override;
  /// How fast air that is not among the inputs changes its velocity [m/s^2, body axes] in one draw, at points `step_s`
  /// apart from the begin of a segment on; of fewer points the first of the same.
  using AirDraw = std::function<std::vector<std::array<double, 3>>(std::size_t segment, std::size_t draw,
                                                                   std::size_t points, double step_s)>;
  void set_air_draws(std::size_t count, AirDraw draw) {
    air_draws_ = count;
    draw_air_ = std::move(draw);
  }
  [[nodiscard]] std::vector<estimation::RowMatrix> disturbances(std::size_t segment,
                                                                const Eigen::VectorXd& theta) const override;

  template <typename Scalar>
  bool simulate(std::size_t segment, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& theta,
                Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& output) const {
    return simulate_in(segment, theta, {}, simulation_.steps_per_sample, output);
  }

 private:
  static constexpr std::size_t kStates = 8;
  enum StateIndex : std::size_t { kVa, kAlphaState, kBetaState, kPState, kQState, kRState, kPhi, kTheta };
  template <typename Scalar>
  using State = std::array<Scalar, kStates>;
  /// Inputs and measured states at one grid point.
  struct GridInputs {
    State<double> state{};
    double de = 0.0, da = 0.0, dr = 0.0, thrust = 0.0, torque = 0.0, rho = 1.225;
    double thrust_per_airspeed = 0.0;
    AeroCoefficients<double> measured;
    std::array<double, 3> force{};  // specific force, measured
    std::array<double, 3> air_acceleration{};
  };
  struct Segment {
    std::size_t begin = 0;  // into inputs_
    Eigen::Index samples = 0;
    double from_s = 0.0, to_s = 0.0;
    std::string of_flight;  // for its name
    std::vector<estimation::ModelParameter> initial;
  };
  using AirAcceleration = std::array<std::vector<double>, 3>;  // empty in uniform air
  template <typename Scalar>
  struct Rates {
    State<Scalar> state;
    std::array<Scalar, 3> force;  // specific force, body axes
  };

  [[nodiscard]] GridInputs inputs_at(const FlightSignals& signals, const AirAcceleration& air, std::size_t k) const;
  [[nodiscard]] static bool complete(const GridInputs& inputs);
  /// On the line from `a` (share 0) to `b` (share 1).
  [[nodiscard]] static GridInputs between(const GridInputs& a, const GridInputs& b, double share);
  // A stretch of complete samples [begin, end) becomes a segment: its inputs at every half step.
  void add_segment(const FlownSpans& flight, const AirAcceleration& air, std::size_t begin, std::size_t end);
  void add_flight(const FlownSpans& flight);
  /// @param air  acceleration of the air in addition to that of the inputs, at each of them; empty: none
  template <typename Scalar>
  bool simulate_in(std::size_t segment, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& theta,
                   std::span<const std::array<double, 3>> air, int steps_per_sample,
                   Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& output) const;
  /// @param parameters  of all coefficients, then the constants that are added to some
  template <typename Scalar>
  [[nodiscard]] Rates<Scalar> rates(State<Scalar> x, const GridInputs& inputs,
                                    std::span<const Scalar> parameters) const;
  template <typename Scalar>
  [[nodiscard]] State<Scalar> step(const State<Scalar>& x, const Rates<Scalar>& first, const GridInputs& middle,
                                   const GridInputs& end, double step_s, std::span<const Scalar> parameters) const;
  template <typename Scalar>
  void hold_measured(State<Scalar>& x, const GridInputs& inputs) const {
    for (std::size_t i = 0; i < kStates; ++i)
      if (!simulated_[i]) x[i] = Scalar(inputs.state[i]);
  }
  [[nodiscard]] const CoefficientModel* modelled(Coefficient c) const {
    return which_[c] < 0 ? nullptr : &coefficients_[which_[c]];
  }

  Subject subject_;
  std::vector<CoefficientModel> coefficients_;
  EnumArray<Coefficient, int, kCoefficients> which_{};           // index into coefficients_, or -1
  EnumArray<Coefficient, std::size_t, kCoefficients> offset_{};  // of its first parameter
  EnumArray<Coefficient, int, kCoefficients> constant_{};        // index of what is added to it, or -1
  Simulation simulation_;
  std::vector<Coefficient> constants_;  // coefficients that constants are added to
  std::array<bool, kStates> simulated_{};
  std::array<bool, 3> forces_{};  // specific forces among the outputs
  std::vector<estimation::ModelParameter> parameters_;
  std::vector<estimation::ModelOutput> outputs_;
  std::vector<GridInputs> inputs_;
  std::vector<Segment> segments_;
  std::size_t air_draws_ = 0;
  AirDraw draw_air_;
  double step_ = 0.02;  // of the integration [s]
  double gravity_ = kGravity;
};

// ---------------------------------------------------------------------------------------------------------------------

template <typename Scalar>
OutputErrorModel::Rates<Scalar> OutputErrorModel::rates(State<Scalar> x, const GridInputs& inputs,
                                                        std::span<const Scalar> parameters) const {
  using std::cos;
  using std::sin;
  using std::tan;
  hold_measured(x, inputs);
  const Scalar &Va = x[kVa], &alpha = x[kAlphaState], &beta = x[kBetaState];
  const Scalar &p = x[kPState], &q = x[kQState], &r = x[kRState], &phi = x[kPhi], &theta = x[kTheta];
  const Scalar qS = Scalar(0.5 * inputs.rho * subject_.wing_area) * Va * Va;
  AeroVariables<Scalar> v;
  v.alpha = alpha;
  v.beta = beta;
  v.p_n = p * Scalar(0.5 * subject_.roll_length()) / Va;
  v.q_n = q * Scalar(0.5 * subject_.pitch_length()) / Va;
  v.r_n = r * Scalar(0.5 * subject_.yaw_length()) / Va;
  v.de = Scalar(inputs.de);
  v.da = Scalar(inputs.da);
  v.dr = Scalar(inputs.dr);
  const Scalar T = Scalar(inputs.thrust) + Scalar(inputs.thrust_per_airspeed) * (Va - Scalar(inputs.state[kVa]));
  v.CT = T / qS;
  v.Va = Va;
  const auto value = [&](Coefficient c) -> Scalar {
    const CoefficientModel* model = modelled(c);
    if (model == nullptr) return Scalar(select(inputs.measured, c));
    const Scalar sum = model->linear(v, parameters.subspan(offset_[c], model->size()));
    return constant_[c] < 0 ? sum : sum + parameters[parameters_.size() + constant_[c]];
  };
  Scalar CL = value(Coefficient::kCL), CD = value(Coefficient::kCD);
  const Scalar CY = value(Coefficient::kCY);
  if (simulation_.stall && subject_.model.stall) {
    const auto own = [&](Coefficient c) {
      const CoefficientModel* model = modelled(c);
      return model == nullptr ? Scalar(0.0)
                              : internal::affine_in_alpha(*model, alpha, parameters.subspan(offset_[c], model->size()));
    };
    internal::blend_stall(*subject_.model.stall, alpha,
                          {.lift = modelled(Coefficient::kCL) != nullptr,
                           .drag = modelled(Coefficient::kCD) != nullptr,
                           .affine_lift = own(Coefficient::kCL),
                           .affine_drag = own(Coefficient::kCD)},
                          CL, CD);
  }
  const Scalar ca = cos(alpha), sa = sin(alpha), cb = cos(beta), sb = sin(beta);
  const Scalar cphi = cos(phi), sphi = sin(phi), cth = cos(theta), sth = sin(theta);
  const std::array<Scalar, 3> aero{qS * (CL * sa - CD * ca), qS * CY, qS * (-CD * sa - CL * ca)};
  Rates<Scalar> out;
  const Scalar m(subject_.mass), g(gravity_);
  out.force = {(aero[0] + T) / m, aero[1] / m, aero[2] / m};
  const Scalar u = Va * ca * cb, vb = Va * sb, w = Va * sa * cb;
  const Scalar du = out.force[0] + r * vb - q * w - g * sth - Scalar(inputs.air_acceleration[0]);
  const Scalar dv = out.force[1] + p * w - r * u + g * cth * sphi - Scalar(inputs.air_acceleration[1]);
  const Scalar dw = out.force[2] + q * u - p * vb + g * cth * cphi - Scalar(inputs.air_acceleration[2]);
  const Scalar dVa = (u * du + vb * dv + w * dw) / Va;
  out.state.fill(Scalar(0.0));
  out.state[kVa] = dVa;
  out.state[kAlphaState] = (u * dw - w * du) / (u * u + w * w);
  out.state[kBetaState] = (dv - dVa * sb) / (Va * cb);
  if (subject_.inertia && (simulated_[kPState] || simulated_[kQState] || simulated_[kRState])) {
    const Inertia& J = *subject_.inertia;
    const auto& f = subject_.force_point;
    const auto& e = subject_.propulsion.position;
    const Scalar l = qS * Scalar(subject_.roll_length()) * value(Coefficient::kCl) + Scalar(inputs.torque) +
                     Scalar(f[1]) * aero[2] - Scalar(f[2]) * aero[1];
    const Scalar M = qS * Scalar(subject_.pitch_length()) * value(Coefficient::kCm) + Scalar(f[2]) * aero[0] -
                     Scalar(f[0]) * aero[2] + Scalar(e[2]) * T;
    const Scalar n = qS * Scalar(subject_.yaw_length()) * value(Coefficient::kCn) + Scalar(f[0]) * aero[1] -
                     Scalar(f[1]) * aero[0] - Scalar(e[1]) * T;
    // J omega' = M - omega x (J omega).
    const Scalar hx = Scalar(J.Jx) * p - Scalar(J.Jxz) * r, hy = Scalar(J.Jy) * q,
                 hz = Scalar(J.Jz) * r - Scalar(J.Jxz) * p;
    const Scalar X = l - (q * hz - r * hy), Y = M - (r * hx - p * hz), Z = n - (p * hy - q * hx);
    const Scalar det(J.Jx * J.Jz - J.Jxz * J.Jxz);
    out.state[kPState] = (Scalar(J.Jz) * X + Scalar(J.Jxz) * Z) / det;
    out.state[kQState] = Y / Scalar(J.Jy);
    out.state[kRState] = (Scalar(J.Jxz) * X + Scalar(J.Jx) * Z) / det;
  }
  out.state[kPhi] = p + tan(theta) * (q * sphi + r * cphi);
  out.state[kTheta] = q * cphi - r * sphi;
  return out;
}

/// The fourth-order Runge-Kutta method.
template <typename Scalar>
OutputErrorModel::State<Scalar> OutputErrorModel::step(const State<Scalar>& x, const Rates<Scalar>& first,
                                                       const GridInputs& middle, const GridInputs& end, double step_s,
                                                       std::span<const Scalar> parameters) const {
  const Scalar h(step_s), half(0.5 * step_s), sixth(step_s / 6.0);
  const auto moved = [](const State<Scalar>& from, const State<Scalar>& rate, const Scalar& by) {
    State<Scalar> to;
    for (std::size_t i = 0; i < kStates; ++i) to[i] = from[i] + by * rate[i];
    return to;
  };
  const Rates<Scalar> k2 = rates(moved(x, first.state, half), middle, parameters);
  const Rates<Scalar> k3 = rates(moved(x, k2.state, half), middle, parameters);
  const Rates<Scalar> k4 = rates(moved(x, k3.state, h), end, parameters);
  State<Scalar> next;
  for (std::size_t i = 0; i < kStates; ++i)
    next[i] = x[i] + sixth * (first.state[i] + Scalar(2.0) * k2.state[i] + Scalar(2.0) * k3.state[i] + k4.state[i]);
  return next;
}

template <typename Scalar>
bool OutputErrorModel::simulate_in(
    std::size_t segment, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& theta,
    std::span<const std::array<double, 3>> air, int steps_per_sample,
    Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& output) const {
  constexpr double kLargest_rad = 80.0 * kDegree;
  constexpr double kSlowest_mps = 2.0;
  const Segment& s = segments_[segment];
  const auto shared = signed_index(parameters_.size()), states = signed_index(forecast_outputs());
  // The parameters, and behind them the constants, which stand behind the initial state.
  std::vector<Scalar> values(theta.data(), theta.data() + shared);
  values.insert(values.end(), theta.data() + shared + states, theta.data() + theta.size());
  const std::span<const Scalar> parameters(values);
  State<Scalar> x;
  auto initial = shared;
  for (std::size_t i = 0; i < kStates; ++i) x[i] = simulated_[i] ? theta(initial++) : Scalar(0.0);
  const auto input = [&](std::size_t i) {
    GridInputs in = inputs_[s.begin + i];
    if (!air.empty())
      for (std::size_t axis = 0; axis < 3; ++axis) in.air_acceleration[axis] += air[i][axis];
    return in;
  };
  for (Eigen::Index k = 0; k < s.samples; ++k) {
    const GridInputs now = input(2 * static_cast<std::size_t>(k));
    hold_measured(x, now);
    const bool sane = x[kVa] > Scalar(kSlowest_mps) && x[kAlphaState] < Scalar(kLargest_rad) &&
                      x[kAlphaState] > Scalar(-kLargest_rad) && x[kBetaState] < Scalar(kLargest_rad) &&
                      x[kBetaState] > Scalar(-kLargest_rad) && x[kTheta] < Scalar(kLargest_rad) &&
                      x[kTheta] > Scalar(-kLargest_rad);
    if (!sane) return false;
    const Rates<Scalar> k1 = rates(x, now, parameters);
    Eigen::Index column = 0;
    for (std::size_t i = 0; i < kStates; ++i)
      if (simulated_[i]) output(k, column++) = x[i];
    for (std::size_t i = 0; i < 3; ++i)
      if (forces_[i]) output(k, column++) = k1.force[i];
    if (k + 1 == s.samples) break;
    const GridInputs mid = input(2 * static_cast<std::size_t>(k) + 1);
    const GridInputs next = input(2 * static_cast<std::size_t>(k) + 2);
    const int steps = std::max(1, steps_per_sample);
    if (steps == 1) {
      x = step(x, k1, mid, next, step_, parameters);
      continue;
    }
    const auto at_share = [&](double share) { return between(now, next, share); };
    for (int j = 0; j < steps; ++j) {
      const GridInputs begin = at_share(static_cast<double>(j) / steps);
      const Rates<Scalar> first = j == 0 ? k1 : rates(x, begin, parameters);
      x = step(x, first, at_share((j + 0.5) / steps), at_share((j + 1.0) / steps), step_ / steps, parameters);
    }
  }
  return true;
}

}  // namespace veridyn::aircraft
