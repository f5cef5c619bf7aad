#include "veridyn/cueing/washout/optimal_washout.hpp"

#include <Eigen/LU>

#include "veridyn/numerics/linear_systems/riccati.hpp"
#include "veridyn/numerics/linear_systems/state_space.hpp"

namespace veridyn::cueing {
namespace {

using numerics::StateSpace;

/// Costs of the inputs themselves, over an acceleration of 1 m/s^2 and a rate of 10 deg/s: small, so that they only
/// keep the control finite.
constexpr double kShiftInput = 0.3, kTurnInput = 0.03;
/// Of shift's rate and integral, over range and second, against that of the shift.
constexpr double kShiftRate = 0.1, kShiftIntegral = 0.3;

double range_of(const Platform& platform, PlatformAxis axis) {
  return 0.5 * (platform.limits[axis].highest - platform.limits[axis].lowest);
}

}  // namespace

std::vector<Knob> OptimalDesign::knobs() {
  return {
      {"force_gain", "1", force_gain, "stronger pushes", true, 0.1, 1.2},
      {"rate_gain", "1", rate_gain, "the vehicle's own roll and pitch more like the real ones", true, 0.0, 1.2},
      {"heave_gain", "1", {&heave_gain, 1}, "harder bumps", true, 0.1, 1.2},
      {"yaw_gain", "1", {&yaw_gain, 1}, "the vehicle's own yaw more like the real one", true, 0.0, 1.2},
      {"force_weight",
       "1",
       {&force_weight, 1},
       "forces more like the vehicle's, with more tilting",
       false,
       0.01,
       100.0},
      {"rate_weight", "1", {&rate_weight, 1}, "less of a turn where the vehicle does not turn", false, 0.01, 100.0},
      {"shift_weight", "1", {&shift_weight, 1}, "less travel", false, 0.1, 1000.0},
      {"tilt_weight", "1", {&tilt_weight, 1}, "weaker lasting forces", false, 0.01, 100.0},
      {"force_change", "rad/s", {&force_change, 1}, "quicker answers to short pushes", false, 0.1, 10.0},
      {"rate_change", "rad/s", {&rate_change, 1}, "quicker answers to short turns", false, 0.1, 10.0},
      {"tilt_rate", "rad/s", {&tilt_rate, 1}, "lasting forces that come earlier; above 3 deg/s the tilting is felt"}};
}

std::unique_ptr<Washout> OptimalDesign::make(const Platform& platform) const {
  return std::make_unique<OptimalWashout>(*this, platform);
}

OptimalChannel::OptimalChannel(const Options& o) : turns_(o.turns), shifts_(o.shifts), most_rate_(o.most_rate) {
  const StateSpace otoliths = numerics::realise(o.model->otoliths), canal = numerics::realise(o.model->canals[o.canal]);
  const Eigen::Index no = otoliths.states(), nc = canal.states(), n = no + nc + (turns_ ? 1 : 0) + (shifts_ ? 3 : 0);
  const Eigen::Index angle = no + nc, shift = angle + (turns_ ? 1 : 0);
  A_.setZero(n, n);
  of_platform_.setZero(n, 2);
  of_vehicle_.setZero(n, 2);
  A_.topLeftCorner(no, no) = otoliths.A;
  A_.block(no, no, nc, nc) = canal.A;
  of_vehicle_.block(0, 0, no, 1) = -otoliths.B;
  of_vehicle_.block(no, 1, nc, 1) = -canal.B;
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(n + 2, n + 2);
  const auto cost = [&](const Eigen::RowVectorXd& row, double weight) { Q += weight * row.transpose() * row; };
  Eigen::RowVectorXd felt = Eigen::RowVectorXd::Zero(n + 2);
  felt.head(no) = otoliths.C.row(0) / o.felt_force;
  cost(felt, o.weights.force_weight);
  felt.setZero();
  felt.segment(no, nc) = canal.C.row(0) / o.felt_rate;
  cost(felt, o.weights.rate_weight);
  if (turns_) {
    of_platform_.block(no, 0, nc, 1) = canal.B;
    of_platform_(angle, 0) = 1.0;
    if (o.tilts) A_.block(0, angle, no, 1) = kGravity * otoliths.B;
    Q(angle, angle) += o.weights.tilt_weight / (o.angle_range * o.angle_range);
  }
  if (shifts_) {
    of_platform_.block(0, 1, no, 1) = otoliths.B;
    A_(shift, shift + 1) = of_platform_(shift + 1, 1) = A_(shift + 2, shift) = 1.0;
    const double weight = o.weights.shift_weight / (o.shift_range * o.shift_range);
    Q(shift, shift) += weight;
    Q(shift + 1, shift + 1) += kShiftRate * weight;
    Q(shift + 2, shift + 2) += kShiftIntegral * weight;
  }
  // The vehicle's force and rate are states of the design: noise through a low-pass of first order.
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + 2, n + 2);
  A.topLeftCorner(n, n) = A_;
  A.topRightCorner(n, 2) = of_vehicle_;
  A(n, n) = -o.weights.force_change;
  A(n + 1, n + 1) = -o.weights.rate_change;
  std::vector<Eigen::Index> inputs;
  if (turns_) inputs.push_back(0);
  if (shifts_) inputs.push_back(1);
  const auto m = static_cast<Eigen::Index>(inputs.size());
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(n + 2, m), R = Eigen::MatrixXd::Zero(m, m);
  for (Eigen::Index k = 0; k < m; ++k) {
    const Eigen::Index input = inputs[k];
    B.col(k).head(n) = of_platform_.col(input);
    R(k, k) = input == 0 ? kTurnInput / std::pow(10.0 * kDegree, 2) : kShiftInput;
  }
  K_.setZero(2, n);
  K_vehicle_.setZero();
  by_force_.setZero(n);
  by_rate_.setZero(n);
  if (m == 0) return;
  const numerics::LinearQuadratic lq = numerics::linear_quadratic(A, B, Q, R);
  for (Eigen::Index k = 0; k < m; ++k) {
    const Eigen::Index input = inputs[k];
    K_.row(input) = lq.K.row(k).head(n);
    K_vehicle_.row(input) = lq.K.row(k).tail(2);
  }
}

OptimalChannel::Input OptimalChannel::control(const State& x, const Input& vehicle) const {
  return -(K_.lazyProduct(x) + K_vehicle_ * vehicle);
}

OptimalChannel::State OptimalChannel::next(const State& x, const Input& before, const Input& now, double step,
                                           bool limited) const {
  return integrated(x, before, now, step, [&](const State& at, const Input& vehicle) {
    Input u = control(at, vehicle);
    if (limited) u(0) = std::clamp(u(0), -most_rate_, most_rate_);
    return State(A_.lazyProduct(at) + of_platform_.lazyProduct(u) + of_vehicle_.lazyProduct(vehicle));
  });
}

PairedOutput OptimalChannel::step(const Input& input, SampleStep step) {
  const auto force = [](const Input& v) { return Input(v(0), 0.0); };
  const auto rate = [](const Input& v) { return Input(0.0, v(1)); };
  if (!step) {
    by_force_.setZero();
    by_rate_.setZero();
  } else {
    by_force_ = next(by_force_, force(vehicle_), force(input), *step, true);
    by_rate_ = next(by_rate_, rate(vehicle_), rate(input), *step, false);
  }
  vehicle_ = input;
  Input of_force = control(by_force_, force(input));
  of_force(0) = std::clamp(of_force(0), -most_rate_, most_rate_);
  const Input u = of_force + control(by_rate_, rate(input));
  const State x = by_force_ + by_rate_;
  PairedOutput out;
  const Eigen::Index n = x.size();
  if (shifts_) {
    out.shift = x(n - 3);
    out.acceleration = u(1);
  }
  if (turns_) {
    out.tilt = x(n - 1 - (shifts_ ? 3 : 0));
    out.tilt_rate = u(0);
  }
  return out;
}

Eigen::Matrix2cd OptimalChannel::response(double omega) const {
  const Eigen::MatrixXd closed = A_ - of_platform_ * K_;
  const Eigen::MatrixXcd s =
      std::complex<double>(0.0, omega) * Eigen::MatrixXcd::Identity(closed.rows(), closed.cols());
  const Eigen::MatrixXcd x =
      (s - closed)
          .partialPivLu()
          .solve(Eigen::MatrixXcd((of_vehicle_ - of_platform_ * K_vehicle_).cast<std::complex<double>>()));
  return -(K_.cast<std::complex<double>>() * x + K_vehicle_.cast<std::complex<double>>());
}

OptimalWashout::OptimalWashout(const OptimalDesign& d, const Platform& platform) : design_(checked(d)) {
  const VestibularModel& model = vestibular_model(d.perception);
  const MotionThresholds felt = usual_thresholds();
  OptimalChannel::Options o{.model = &model, .weights = d};
  for (Eigen::Index pair = 0; pair < 2; ++pair) {
    const auto i = static_cast<std::size_t>(pair);
    o.canal = i;
    o.turns = platform.limits[tilt_axis(pair)].moves();
    o.shifts = platform.limits[shift_axis(pair)].moves();
    o.angle_range = range_of(platform, tilt_axis(pair));
    o.shift_range = range_of(platform, shift_axis(pair));
    o.most_rate = d.tilt_rate;
    o.felt_rate = felt.rate[i];
    o.felt_force = felt.force[1 - i];
    channels_.emplace_back(o);
  }
  o.tilts = false;
  o.most_rate = kInfinity;
  o.turns = false;
  o.shifts = platform.limits[PlatformAxis::kHeave].moves();
  o.shift_range = range_of(platform, PlatformAxis::kHeave);
  o.felt_force = felt.force[2];
  channels_.emplace_back(o);
  o.canal = 2;
  o.turns = platform.limits[PlatformAxis::kYaw].moves();
  o.shifts = false;
  o.angle_range = range_of(platform, PlatformAxis::kYaw);
  o.felt_rate = felt.rate[2];
  channels_.emplace_back(o);
}

PlatformCommand OptimalWashout::next(const VehicleMotion& motion, SampleStep step) {
  PlatformCommand command;
  const Eigen::Vector3d& a = motion.acceleration;
  const Eigen::Vector2d force = tilted_force(motion.force);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto pair = static_cast<std::size_t>(i);
    PairedOutput o =
        channels_[pair].step({design_.force_gain[1 - pair] * force(i), design_.rate_gain[pair] * motion.rate(i)}, step);
    // The design takes g times the angle for the force.
    o.tilt = std::asin(std::clamp(o.tilt, -1.0, 1.0));
    add_paired(command, o, i);
  }
  const PairedOutput heave = channels_[2].step({-design_.heave_gain * a.z(), 0.0}, step);
  command.shift.z() = heave.shift;
  command.acceleration.z() = heave.acceleration;
  const PairedOutput yaw = channels_[3].step({0.0, design_.yaw_gain * motion.rate.z()}, step);
  command.angle.z() = yaw.tilt;
  command.rate.z() = yaw.tilt_rate;
  return command;
}

}  // namespace veridyn::cueing
