#include "veridyn/cueing/washout/predictive_washout.hpp"

#include <fmt/format.h>

#include "veridyn/cueing/perception/felt_pair.hpp"
#include "veridyn/numerics/linear_systems/discretisation.hpp"

namespace veridyn::cueing {
namespace {

constexpr Eigen::Index kAtAngle = FeltPair::kAngle, kAtAngleRate = FeltPair::kAngleRate, kAtShift = FeltPair::kShift,
                       kAtShiftRate = FeltPair::kShiftRate;

/// Costs of the inputs over the platform's own limits, and of the shift's rate: small, they only settle what the rest
/// leaves open.
constexpr double kAngleEffort = 0.02, kShiftEffort = 0.02, kShiftSpeed = 0.05;
/// Iterations of one plan.
constexpr int kIterations = 30;

}  // namespace

std::vector<Knob> PredictiveDesign::knobs() {
  std::vector<Knob> all = {
      {"force_weight", "1", {&force_weight, 1}, "forces more like the vehicle's, with more tilting", false, 0.05, 20.0},
      {"rate_weight", "1", {&rate_weight, 1}, "less of a turn where the vehicle does not turn", false, 0.01, 20.0},
      {"shift_weight", "1", {&shift_weight, 1}, "less travel", false, 0.1, 100.0},
      {"tilt_weight", "1", {&tilt_weight, 1}, "weaker lasting forces", false, 0.01, 10.0},
      {"fades", "s", {&fades, 1}, "more made of long pushes, less of short ones", false, 0.1, 10.0},
      {"use", "1", {&use, 1}, "less room kept at the ends"}};
  shared.add_to(all);
  return all;
}

std::unique_ptr<Washout> PredictiveDesign::make(const Platform& platform) const {
  return std::make_unique<PredictiveWashout>(*this, platform);
}

template <int kStates, int kInputs>
PlannedPair<kStates, kInputs>::PlannedPair(const PredictiveDesign& d, const Platform& platform, Eigen::Index pair)
    : programme_(kSteps), tail_(kSteps, Input::Zero()) {
  constexpr bool shifts = kInputs == 2;
  const numerics::StateSpace model =
      felt_pair(vestibular_model(d.perception), usual_thresholds(), pair, shifts, -platform.rider.z()).system;
  A_ = model.A;
  B_ = model.B.leftCols(kInputs);
  of_force_ = model.B.col(FeltPair::kForce);
  const AxisLimits& angle = platform.limits[tilt_axis(pair)];
  const AxisLimits& shift = platform.limits[shift_axis(pair)];
  typename Programme::Stage stage;
  stage.Q = (d.force_weight * model.C.row(0).transpose() * model.C.row(0) +
             d.rate_weight * model.C.row(1).transpose() * model.C.row(1));
  const auto squared = [](double v) { return v * v; };
  const double angle_range = 0.5 * (angle.highest - angle.lowest), most_rate = std::min(d.shared.tilt_rate, angle.rate);
  stage.Q(kAtAngle, kAtAngle) += d.tilt_weight / squared(angle_range);
  stage.R.setZero();
  stage.R(0, 0) = kAngleEffort / squared(angle.acceleration);
  stage.x_low(kAtAngle) = d.use * angle.lowest;
  stage.x_high(kAtAngle) = d.use * angle.highest;
  stage.x_low(kAtAngleRate) = -most_rate;
  stage.x_high(kAtAngleRate) = most_rate;
  stage.u_low(0) = -angle.acceleration;
  stage.u_high(0) = angle.acceleration;
  if constexpr (shifts) {
    const double range = 0.5 * (shift.highest - shift.lowest);
    stage.Q(kAtShift, kAtShift) += d.shift_weight / squared(range);
    stage.Q(kAtShiftRate, kAtShiftRate) += d.shift_weight * kShiftSpeed / squared(range);
    stage.R(1, 1) = kShiftEffort / squared(shift.acceleration);
    // Of sway everything is to the left.
    stage.x_low(kAtShift) = d.use * (pair == 0 ? -shift.highest : shift.lowest);
    stage.x_high(kAtShift) = d.use * (pair == 0 ? -shift.lowest : shift.highest);
    stage.x_low(kAtShiftRate) = -shift.rate;
    stage.x_high(kAtShiftRate) = shift.rate;
    stage.u_low(1) = -shift.acceleration;
    stage.u_high(1) = shift.acceleration;
  }
  for (std::size_t k = 0; k < kSteps; ++k) {
    const double step = kForeseenTimes[k + 1] - kForeseenTimes[k];
    const numerics::HeldSystem held = numerics::held(model, step, numerics::Hold::kZeroOrder);
    typename Programme::Stage& of_step = programme_.stages[k] = stage;
    of_step.A = held.Phi;
    of_step.B = held.Gamma.leftCols(kInputs);
    held_force_[k] = held.Gamma.col(FeltPair::kForce);
    fade_[k] = std::exp(-foreseen_middle(k) / d.fades);
    // The state at the end of a step counts for its length.
    of_step.Q *= step / kForeseenTimes.back();
    of_step.R *= step / kForeseenTimes.back();
  }
  // It ends slowly: what comes after the horizon can still be stopped.
  programme_.stages.back().Q *= 3.0;
}

template <int kStates, int kInputs>
void PlannedPair<kStates, kInputs>::foresee(double now, const std::array<double, kSteps>& then) {
  foreseen_now_ = now;
  foreseen_ = then;
}

template <int kStates, int kInputs>
void PlannedPair<kStates, kInputs>::plan(double force) {
  bool all_zero = true;
  for (std::size_t k = 0; k < kSteps; ++k) {
    const double then = foreseen_[k] + fade_[k] * (force - foreseen_now_);
    programme_.stages[k].b = held_force_[k] * then;
    all_zero = all_zero && then == 0.0;
  }
  if (x_.isZero(0.0) && all_zero) {
    std::fill(tail_.begin(), tail_.end(), Input::Zero());
    since_plan_ = 0.0;
    has_plan_ = true;
    return;
  }
  planned_from_ = x_;
  const numerics::ProgrammeResult r =
      programme_.solve(x_, {.iterations = kIterations, .tolerance = 1e-6}, has_plan_ && counts_.plans > 0);
  ++counts_.plans;
  counts_.iterations += r.iterations;
  counts_.most = std::max<long>(counts_.most, r.iterations);
  constexpr double kGoodEnough = 1e-4;  // of a plan that ran out of iterations: its bounds hold
  if (r.end == numerics::ProgrammeEnd::kInfeasible || r.violation > kGoodEnough) {
    ++counts_.late;
    return;
  }
  std::copy(programme_.inputs().begin(), programme_.inputs().end(), tail_.begin());
  since_plan_ = 0.0;
  has_plan_ = true;
}

template <int kStates, int kInputs>
typename PlannedPair<kStates, kInputs>::Input PlannedPair<kStates, kInputs>::planned(const PairedOutput& fallback) {
  std::size_t at = 0;
  while (at < kSteps && since_plan_ >= kForeseenTimes[at + 1]) ++at;
  if (has_plan_ && at < kSteps) return tail_[at];
  ++counts_.classical;
  constexpr double kFollows = 4.0;  // [rad/s], critically damped
  const auto follow = [&](double to, double is, double speed) {
    return kFollows * kFollows * (to - is) - 2.0 * kFollows * speed;
  };
  const typename Programme::Stage& s = programme_.stages.front();
  Input u;
  u(0) = follow(fallback.tilt, x_(kAtAngle), x_(kAtAngleRate));
  if constexpr (kInputs == 2) u(1) = follow(fallback.shift, x_(kAtShift), x_(kAtShiftRate));
  return u.cwiseMax(s.u_low).cwiseMin(s.u_high);
}

template <int kStates, int kInputs>
PairedOutput PlannedPair<kStates, kInputs>::step(double force, const PairedOutput& fallback, SampleStep step) {
  if (!step) {
    x_.setZero();
    force_ = since_plan_ = 0.0;
    has_plan_ = false;
    counts_ = {};
  } else if (*step > 0.0) {
    // Long steps in pieces of the plan's, each with its own input.
    const double pieces = std::ceil(*step / kFirstForeseenStep * (1.0 - 1e-9)), h = *step / pieces;
    for (double k = 0.0; k < pieces; ++k) {
      if (!has_plan_ || since_plan_ >= kReplan) plan(force_);
      const Input u = planned(fallback);
      const Eigen::Matrix<double, 1, 1> before(force_ + k / pieces * (force - force_)),
          now(force_ + (k + 1.0) / pieces * (force - force_));
      x_ = integrated(x_, before, now, h, [&](const State& x, const Eigen::Matrix<double, 1, 1>& f) {
        return State(A_ * x + B_ * u + of_force_ * f(0));
      });
      const typename Programme::Stage& s = programme_.stages.front();
      x_ = x_.cwiseMax(s.x_low).cwiseMin(s.x_high);
      since_plan_ += h;
    }
    force_ = force;
  }
  PairedOutput out{.tilt = x_(kAtAngle), .tilt_rate = x_(kAtAngleRate)};
  if constexpr (kInputs == 2) {
    out.shift = x_(kAtShift);
    out.acceleration = has_plan_ ? tail_[0](1) : 0.0;
  }
  return out;
}

PredictiveWashout::PredictiveWashout(const PredictiveDesign& d, const Platform& platform)
    : design_(checked(d)),
      shared_(d.shared),
      low_pass_{numerics::CausalFilter(numerics::low_pass(2.0, 1.0)),
                numerics::CausalFilter(numerics::low_pass(2.0, 1.0))},
      shift_{ShiftChannel(1.0, 1.0, 0.0), ShiftChannel(1.0, 1.0, 0.0)} {
  for (Eigen::Index i = 0; i < 2; ++i) {
    shifts_[i] = platform.limits[shift_axis(i)].moves();
    if (shifts_[i]) {
      shifting_.emplace_back(d, platform, i);
    } else {
      tilting_.emplace_back(d, platform, i);
    }
  }
}

PlanCounts PredictiveWashout::counts() const {
  PlanCounts all;
  const auto add = [&](const PlanCounts& c) {
    all.plans += c.plans;
    all.iterations += c.iterations;
    all.most = std::max(all.most, c.most);
    all.late += c.late;
    all.classical += c.classical;
  };
  for (const auto& p : tilting_) add(p.counts());
  for (const auto& p : shifting_) add(p.counts());
  return all;
}

std::string PredictiveWashout::account() const {
  const PlanCounts c = counts();
  if (c.plans == 0) return {};
  std::string text = fmt::format(
      "{} plans of {:.1f} iterations, {} at most; {} not ready in time: the plan before went on; {} moments on the "
      "classical algorithm",
      c.plans, static_cast<double>(c.iterations) / static_cast<double>(c.plans), c.most, c.late, c.classical);
  for (const std::size_t pair : {1U, 0U}) {
    const std::string foresaw =
        design_.foresight ? foresight_account_[pair].text(design_.foresight->from()) : std::string();
    if (!foresaw.empty()) text += fmt::format("; {}: {}", pair == 1 ? "surge" : "sway", foresaw);
  }
  return text;
}

double PredictiveWashout::planned_force(const Eigen::Vector3d& force, Eigen::Index pair) const {
  const double desired = design_.shared.force_gain[1 - pair] * paired_input(force, Eigen::Vector3d::Zero(), pair)(0);
  // The plan takes g times the angle for the force.
  return kGravity * std::asin(std::clamp(desired / kGravity, -1.0, 1.0));
}

void PredictiveWashout::look_ahead(const VehicleMotion& motion, SampleStep step) {
  if (!design_.foresight) return;
  if (!step) {
    design_.foresight->reset();
    for (ForesightAccount& a : foresight_account_) a.reset();
  }
  const bool foreseen = design_.foresight->look(*motion.sample, step.value_or(0.0), foreseen_);
  std::size_t tilting = 0, shifting = 0;
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double now = foreseen ? planned_force(foreseen_.now, i) : 0.0;
    std::array<double, kForeseenSteps> then = {};
    for (std::size_t k = 0; foreseen && k < kForeseenSteps; ++k) then[k] = planned_force(foreseen_.then[k], i);
    if (shifts_[i]) {
      shifting_[shifting++].foresee(now, then);
    } else {
      tilting_[tilting++].foresee(now, then);
    }
    constexpr std::size_t kAhead = ForesightAccount::kStep;
    const double as_force = paired_input(motion.force, Eigen::Vector3d::Zero(), i)(0),
                 known = paired_input(foreseen_.now, Eigen::Vector3d::Zero(), i)(0),
                 comes = paired_input(foreseen_.then[kAhead], Eigen::Vector3d::Zero(), i)(0);
    foresight_account_[i].add(as_force,
                              comes + (as_force - known) * std::exp(-ForesightAccount::kAhead / design_.fades),
                              foreseen, step.value_or(0.0));
  }
}

PlatformCommand PredictiveWashout::next(const VehicleMotion& motion, SampleStep step) {
  PlatformCommand command;
  shared_.add_to(command, motion.acceleration, motion.rate, step);
  look_ahead(motion, step);
  std::size_t tilting = 0, shifting = 0;
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto pair = static_cast<std::size_t>(i);
    const PairedInput now = design_.shared.force_gain[1 - pair] * paired_input(motion.force, motion.acceleration, i);
    const ChannelOutput s = shift_[pair].step(now(1), step);
    const ChannelOutput t =
        tilt_[pair].step(cueing::next(low_pass_[pair], now(0), step), design_.shared.tilt_rate, step);
    const PairedOutput classical{s.place, s.change, t.place, t.change};
    const double force = planned_force(motion.force, i);
    add_paired(command,
               shifts_[pair] ? shifting_[shifting++].step(force, classical, step)
                             : tilting_[tilting++].step(force, classical, step),
               i);
  }
  return command;
}

template class PlannedPair<7, 1>;
template class PlannedPair<9, 2>;

}  // namespace veridyn::cueing
