#include "veridyn/muscle/forward_simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/dormand_prince.hpp"

namespace veridyn::muscle {
namespace {

/// Fills the rows of a trajectory and finds its events while the integrator goes along.
class Recorder {
 public:
  Recorder(const MusculoskeletalSystem& system, const ForwardOptions& options, MuscleTrajectory& trajectory)
      : system_(system), evaluator_(system), options_(options), t_(trajectory), state_(system.layout().size) {
    const auto rows = static_cast<Eigen::Index>(std::floor((options.end - options.begin) * options.rate_Hz + 1e-9)) + 1;
    const auto n = static_cast<Eigen::Index>(system.coordinates());
    const auto m = static_cast<Eigen::Index>(system.muscles().size());
    for (auto* matrix : {&t_.q, &t_.qdot, &t_.reserve}) matrix->setZero(rows, n);
    for (auto* matrix : {&t_.excitation, &t_.activation, &t_.fiber_length, &t_.tendon_force, &t_.path_length}) {
      matrix->setZero(rows, m);
    }
    t_.time.reserve(static_cast<std::size_t>(rows));
    rows_ = static_cast<std::size_t>(rows);
    events_.resize(2 * system.muscles().size());
    before_.resize(events_.size());
  }

  [[nodiscard]] double next_time() const {
    if (t_.time.size() == rows_) return std::numeric_limits<double>::infinity();
    return options_.begin + static_cast<double>(t_.time.size()) / options_.rate_Hz;
  }

  void row(double time, const double* x, std::span<const double> excitation, std::span<const double> reserve) {
    evaluate(x, excitation, reserve);
    const auto i = static_cast<Eigen::Index>(t_.time.size());
    t_.time.push_back(time);
    const auto copy = [i](estimation::RowMatrix& to, std::span<const double> from) {
      for (std::size_t k = 0; k < from.size(); ++k) to(i, static_cast<Eigen::Index>(k)) = from[k];
    };
    copy(t_.q, evaluator_.q());
    copy(t_.qdot, evaluator_.qdot());
    copy(t_.excitation, excitation);
    copy(t_.activation, evaluator_.activation());
    copy(t_.fiber_length, evaluator_.fiber_length());
    copy(t_.tendon_force, evaluator_.tendon_force());
    copy(t_.path_length, evaluator_.path_length());
    copy(t_.reserve, reserve);
  }

  /// Signs of the event functions at the beginning of everything.
  void arm(const double* x, std::span<const double> excitation, std::span<const double> reserve) {
    event_functions(x, excitation, reserve);
    before_ = events_;
  }

  /// Looks for changes of sign over a step; the instant comes from bisection on the integrator's interpolant.
  template <typename Stepper>
  void look_for_events(const Stepper& stepper, double begin, double end, const double* x_end,
                       std::span<const double> excitation, std::span<const double> reserve) {
    event_functions(x_end, excitation, reserve);
    const std::vector<double> after = events_;
    for (std::size_t k = 0; k < after.size(); ++k) {
      if ((before_[k] > 0.0) == (after[k] > 0.0)) continue;
      double a = begin, b = end;
      for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (a + b);
        stepper.interpolate(middle, state_.data());
        event_functions(state_.data(), excitation, reserve);
        ((events_[k] > 0.0) == (before_[k] > 0.0) ? a : b) = middle;
      }
      const bool now_positive = after[k] > 0.0;
      using Kind = MuscleEvent::Kind;
      const Kind kind = k % 2 == 0 ? (now_positive ? Kind::kFiberFree : Kind::kFiberShortest)
                                   : (now_positive ? Kind::kTendonTaut : Kind::kTendonSlack);
      constexpr std::size_t kMostEvents = 10000;
      if (t_.events.size() < kMostEvents) t_.events.push_back({b, static_cast<int>(k / 2), kind});
    }
    before_ = after;
  }

  double* scratch() { return state_.data(); }

 private:
  void evaluate(const double* x, std::span<const double> excitation, std::span<const double> reserve) {
    rate_.resize(state_.size());
    static_cast<void>(evaluator_.derivative(x, {excitation, {}, reserve}, rate_.data()));
  }

  void event_functions(const double* x, std::span<const double> excitation, std::span<const double> reserve) {
    evaluate(x, excitation, reserve);
    system_.muscles().events(
        {excitation, evaluator_.activation(), evaluator_.fiber_length(), evaluator_.path_length(), evaluator_.path_speed()},
        events_);
    // A rigid tendon has one event, not two.
    for (std::size_t m = 0; m < system_.muscles().size(); ++m) {
      if (!system_.muscles().has_fiber_state(m)) events_[2 * m] = 1.0;
    }
  }

  const MusculoskeletalSystem& system_;
  SystemEvaluator<double> evaluator_;
  const ForwardOptions& options_;
  MuscleTrajectory& t_;
  std::size_t rows_ = 0;
  std::vector<double> state_, rate_, events_, before_;
};

void check_start(const Model& model, const StartState& start) {
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    const Coordinate& c = model.coordinates[i];
    const double q = start.q(static_cast<Eigen::Index>(i)), v = start.qdot(static_cast<Eigen::Index>(i));
    if (!std::isfinite(q) || !std::isfinite(v)) throw InputError(model.name, fmt::format("start of coordinate '{}' is not a finite number", c.name));
    const double slack = 1e-6 * (1.0 + c.high - c.low);
    if (q < c.low - slack || q > c.high + slack) {
      throw InputError(model.name, fmt::format("start of coordinate '{}' = {:.6g} {} is outside its range {:.6g} .. {:.6g}", c.name, q,
                                               c.unit(), c.low, c.high));
    }
  }
}

SimulationEnd end_of(numerics::IntegrationEnd end) {
  switch (end) {
    case numerics::IntegrationEnd::kReached:
      return SimulationEnd::kCompleted;
    case numerics::IntegrationEnd::kStepLimit:
      return SimulationEnd::kStepLimit;
    case numerics::IntegrationEnd::kStepSize:
      return SimulationEnd::kStepSize;
    case numerics::IntegrationEnd::kNotFinite:
      break;
  }
  return SimulationEnd::kDiverged;
}

/// The state furthest out of its usual size, for the message.
std::string worst_state(const MusculoskeletalSystem& system, const Eigen::VectorXd& x) {
  const StateLayout& layout = system.layout();
  double worst = 0.0;
  std::size_t index = 0;
  for (std::size_t i = 0; i < layout.size; ++i) {
    const double size = std::abs(x(static_cast<Eigen::Index>(i))) / system.scales()[i];
    if (size > worst || !std::isfinite(size)) {
      worst = size;
      index = i;
      if (!std::isfinite(size)) break;
    }
  }
  if (index < 2 * layout.free_coordinates) {
    const auto free = static_cast<int>(index % layout.free_coordinates);
    const int c = system.reduction().free_coordinates()[static_cast<std::size_t>(free)];
    return fmt::format("{} of coordinate '{}'", index < layout.free_coordinates ? "value" : "speed",
                       system.model().coordinates[static_cast<std::size_t>(c)].name);
  }
  for (std::size_t m = 0; m < system.muscles().size(); ++m) {
    if (layout.activation[m] == static_cast<int>(index)) return fmt::format("activation of '{}'", system.model().muscles[m].name());
    if (layout.fiber_length[m] == static_cast<int>(index)) return fmt::format("fibre length of '{}'", system.model().muscles[m].name());
  }
  return "a state";
}

}  // namespace

std::string event_text(MuscleEvent::Kind kind) {
  switch (kind) {
    case MuscleEvent::Kind::kTendonSlack:
      return "tendon goes slack";
    case MuscleEvent::Kind::kTendonTaut:
      return "tendon is taut again";
    case MuscleEvent::Kind::kFiberShortest:
      return "fibre at its least length";
    case MuscleEvent::Kind::kFiberFree:
      break;
  }
  return "fibre leaves its least length";
}

std::string MuscleTrajectory::message() const {
  switch (end) {
    case SimulationEnd::kCompleted:
      return fmt::format("simulated to {:.6g} s", end_time);
    case SimulationEnd::kDiverged:
      return fmt::format("the simulation diverged at {:.6g} s: {}", end_time, trouble);
    case SimulationEnd::kStepSize:
      return fmt::format("no step is small enough at {:.6g} s: {}", end_time, trouble);
    case SimulationEnd::kStepLimit:
      return fmt::format("the limit of {} steps was reached at {:.6g} s: {}", steps, end_time, trouble);
    case SimulationEnd::kInterrupted:
      break;
  }
  return fmt::format("interrupted at {:.6g} s", end_time);
}

StartState default_start(const Model& model) {
  StartState start;
  start.q = model.default_pose();
  start.qdot.setZero(start.q.size());
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) start.qdot(static_cast<Eigen::Index>(i)) = model.coordinates[i].default_speed;
  return start;
}

MuscleTrajectory simulate_forward(const MusculoskeletalSystem& system, const StartState& start,
                                  const ControlSignals& excitation, const ForwardOptions& options, Progress& progress) {
  return simulate_forward(system, start, excitation, ControlSignals(std::vector<double>(system.coordinates(), 0.0)), options, progress);
}

MuscleTrajectory simulate_forward(const MusculoskeletalSystem& system, const StartState& start,
                                  const ControlSignals& excitation, const ControlSignals& reserve,
                                  const ForwardOptions& options, Progress& progress) {
  check_start(system.model(), start);
  MuscleTrajectory result;
  const StateLayout& layout = system.layout();
  SystemEvaluator<double> evaluator(system);
  std::vector<double> u(system.muscles().size()), f(system.coordinates());
  excitation.evaluate(options.begin, u.data());
  reserve.evaluate(options.begin, f.data());
  Eigen::VectorXd x(static_cast<Eigen::Index>(layout.size));
  system.reduction().select(start.q.data(), x.data());
  system.reduction().select(start.qdot.data(), x.data() + layout.free_coordinates);
  evaluator.set_motion(x.data(), x.data() + layout.free_coordinates);
  evaluator.start_muscles(start.activation.size() > 0 ? start.activation.data() : u.data(), x.data());
  for (std::size_t m = 0; m < u.size() && start.fiber_length.size() > 0; ++m) {
    if (layout.fiber_length[m] >= 0) x(layout.fiber_length[m]) = start.fiber_length(static_cast<Eigen::Index>(m));
  }

  Recorder recorder(system, options, result);
  recorder.row(options.begin, x.data(), u, f);
  recorder.arm(x.data(), u, f);
  numerics::DormandPrince<double> stepper(layout.size);
  const numerics::StepControl control{.tolerance = options.accuracy, .smallest_step = 1e-12 * (options.end - options.begin), .max_steps = options.max_steps};
  const bool held = excitation.interpolation() == Interpolation::kHold;
  double t = options.begin;
  std::vector<double> now(u.size());
  const auto derivative = [&](double time, const double* state, double* rate) {
    if (!held) {
      excitation.evaluate(time, now.data());
      return evaluator.derivative(state, {now, {}, f}, rate);
    }
    return evaluator.derivative(state, {u, {}, f}, rate);
  };
  constexpr double kFarAway = 1e4;
  double shown = options.begin;
  bool stopped = false;
  while (t < options.end && result.end == SimulationEnd::kCompleted) {
    const double piece_end = std::min({options.end, held ? excitation.next_break(t) : options.end, reserve.next_break(t)});
    const auto on_step = [&](double begin, double end) {
      for (double sample = recorder.next_time(); sample <= end + 1e-12; sample = recorder.next_time()) {
        stepper.interpolate(std::min(sample, end), recorder.scratch());
        if (!held) excitation.evaluate(sample, now.data());
        recorder.row(sample, recorder.scratch(), held ? u : now, f);
      }
      stepper.interpolate(end, recorder.scratch());
      std::vector<double>& state_at_end = final_;
      state_at_end.assign(recorder.scratch(), recorder.scratch() + layout.size);
      recorder.look_for_events(stepper, begin, end, state_at_end.data(), held ? u : now, f);
      for (std::size_t i = 0; i < layout.free_coordinates; ++i) {
        if (std::abs(state_at_end[i]) > kFarAway) result.end = SimulationEnd::kDiverged;
      }
      if (end - shown > 0.01 * (options.end - options.begin)) {
        shown = end;
        stopped = !progress.update((end - options.begin) / (options.end - options.begin));
      }
      return !stopped && result.end == SimulationEnd::kCompleted;
    };
    const numerics::IntegrationEnd end = stepper.advance(derivative, t, x.data(), piece_end, system.scales(), control, on_step);
    if (end != numerics::IntegrationEnd::kReached) result.end = end_of(end);
    if (stopped) result.end = SimulationEnd::kInterrupted;
    if (t >= options.end || result.end != SimulationEnd::kCompleted) break;
    excitation.evaluate(t, u.data());
    reserve.evaluate(t, f.data());
    stepper.restart(true);
  }
  return result;
}

}  // namespace veridyn::muscle
