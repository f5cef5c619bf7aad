#include "veridyn/muscle/simulation/forward_simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/simulation/assembly.hpp"
#include "veridyn/muscle/simulation/driven_integration.hpp"

namespace veridyn::muscle {
namespace {

/// View of a system, which must outlive it: collects rows and events of its trajectory while the integrator advances.
class Recorder {
 public:
  Recorder(const MusculoskeletalSystem& system, const ForwardOptions& options)
      : system_(system),
        between_(system),
        begin_(options.begin),
        rate_Hz_(options.rate_Hz),
        state_(system.layout().size),
        rate_(state_.size()),
        before_(2 * system.muscles().size()),
        after_(before_.size()),
        middle_(before_.size()) {
    const double span = options.end - options.begin;
    last_row_ =
        options.rate_Hz > 0.0 ? static_cast<std::size_t>(std::floor(span * options.rate_Hz * (1.0 + 1e-12) + 1e-9)) : 0;
  }

  void start(SystemEvaluator<double>& evaluator, const double* x, const SystemInputs& inputs) {
    between_ = evaluator;
    static_cast<void>(between_.derivative(x, inputs, rate_.data()));
    append(begin_, between_, inputs);
    event_functions(between_, before_);
  }

  /// After an accepted step, at whose end `evaluator` was evaluated last.
  void step(const SystemStepper& stepper, const SystemEvaluator<double>& evaluator, ControlsAtInstant& controls,
            double begin, double end) {
    if (rate_Hz_ > 0.0) {
      while (t_.time.size() <= last_row_) {
        const double sample = begin_ + static_cast<double>(t_.time.size()) / rate_Hz_;
        if (sample > end + 1e-12) break;
        const SystemInputs inputs = controls.at(std::min(sample, end));
        evaluate_between(stepper, std::min(sample, end), inputs);
        append(sample, between_, inputs);
      }
    } else {
      append(end, evaluator, controls.at(end));
    }
    event_functions(evaluator, after_);
    for (std::size_t k = 0; k < after_.size(); ++k) {
      if ((before_[k] > 0.0) != (after_[k] > 0.0)) locate(stepper, controls, k, begin, end);
    }
    std::swap(before_, after_);
  }

  /// The trajectory's rows and events.
  [[nodiscard]] MuscleTrajectory finish() {
    // Rows were collected one after the other; here they become matrices.
    const auto n = static_cast<Eigen::Index>(system_.coordinates()), m = signed_index(system_.muscles().size());
    const auto rows = signed_index(t_.time.size());
    const auto fill = [&](estimation::RowMatrix& matrix, const std::vector<double>& values, Eigen::Index columns) {
      matrix = Eigen::Map<const estimation::RowMatrix>(values.data(), rows, columns);
    };
    fill(t_.q, q_, n);
    fill(t_.qdot, qdot_, n);
    fill(t_.reserve, reserve_, n);
    fill(t_.excitation, excitation_, m);
    fill(t_.activation, activation_, m);
    fill(t_.fiber_length, fiber_, m);
    fill(t_.tendon_force, force_, m);
    fill(t_.path_length, path_, m);
    return std::move(t_);
  }

 private:
  void evaluate_between(const SystemStepper& stepper, double time, const SystemInputs& inputs) {
    stepper.interpolate(time, state_.data());
    static_cast<void>(between_.derivative(state_.data(), inputs, rate_.data()));
  }

  void append(double time, const SystemEvaluator<double>& e, const SystemInputs& inputs) {
    const std::size_t n = system_.coordinates();
    t_.time.push_back(time);
    q_.insert(q_.end(), e.q(), e.q() + n);
    qdot_.insert(qdot_.end(), e.qdot(), e.qdot() + n);
    const auto add = [](std::vector<double>& to, std::span<const double> from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    if (inputs.coordinate_force.empty()) {
      reserve_.resize(reserve_.size() + n, 0.0);
    } else {
      add(reserve_, inputs.coordinate_force);
    }
    add(excitation_, inputs.excitation);
    add(activation_, e.activation());
    add(force_, e.tendon_force());
    add(path_, e.path_length());
    for (std::size_t m = 0; m < system_.muscles().size(); ++m) {
      fiber_.push_back(system_.muscles().has_fiber_state(m) ? e.fiber_length()[m] : rigid_fiber(m, e.path_length()[m]));
    }
  }

  /// What a rigid tendon leaves of the path to the fibre.
  [[nodiscard]] double rigid_fiber(std::size_t m, double path) const {
    const MusculotendonParameters<double>& p = system_.muscles().settings(m).musculotendon;
    return std::hypot(std::max(0.0, path - p.tendon_slack_length),
                      p.optimal_fiber_length * std::sin(p.pennation_angle_at_optimal));
  }

  void event_functions(const SystemEvaluator<double>& e, std::vector<double>& value) const {
    system_.muscles().events({{}, e.activation(), e.fiber_length(), e.path_length(), e.path_speed()}, value);
    for (std::size_t m = 0; m < system_.muscles().size(); ++m) {
      if (!system_.muscles().has_fiber_state(m)) value[2 * m] = 1.0;  // of a rigid tendon both are the same
    }
  }

  /// Bisection on the integrator's interpolant.
  void locate(const SystemStepper& stepper, ControlsAtInstant& controls, std::size_t k, double begin, double end) {
    constexpr std::size_t kMostEvents = 10000;
    if (t_.events.size() >= kMostEvents) return;
    double a = begin, b = end;
    for (int i = 0; i < 40 && b - a > 1e-12; ++i) {
      const double middle = 0.5 * (a + b);
      evaluate_between(stepper, middle, controls.at(middle));
      event_functions(between_, middle_);
      ((middle_[k] > 0.0) == (before_[k] > 0.0) ? a : b) = middle;
    }
    using Kind = MuscleEvent::Kind;
    const bool positive = after_[k] > 0.0;
    const Kind kind = k % 2 == 0 ? (positive ? Kind::kFiberFree : Kind::kFiberShortest)
                                 : (positive ? Kind::kTendonTaut : Kind::kTendonSlack);
    t_.events.push_back({b, static_cast<int>(k / 2), kind});
  }

  const MusculoskeletalSystem& system_;
  SystemEvaluator<double> between_;
  double begin_, rate_Hz_;
  MuscleTrajectory t_;
  std::size_t last_row_ = 0;
  std::vector<double> state_, rate_, before_, after_, middle_;
  std::vector<double> q_, qdot_, reserve_, excitation_, activation_, fiber_, force_, path_;
};

void check_start(const Model& model, const StartState& start) {
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    const Coordinate& c = model.coordinates[i];
    const double q = start.q(i), speed = start.qdot(i);
    if (!std::isfinite(q) || !std::isfinite(speed)) {
      throw InputError(model.name, fmt::format("start of coordinate '{}' is not a finite number", c.name));
    }
    // Coupled ones are where their couplers put them, whatever the file says of their range.
    const bool coupled = std::any_of(model.couplers.begin(), model.couplers.end(),
                                     [i](const CoordinateCoupler& k) { return k.dependent == static_cast<int>(i); });
    if (!coupled && !c.in_range(q)) throw InputError(model.name, fmt::format("start of {}", c.outside_range(q)));
  }
}

MotionEnd end_of(numerics::IntegrationEnd end) {
  switch (end) {
    case numerics::IntegrationEnd::kReached:
      return MotionEnd::kCompleted;
    case numerics::IntegrationEnd::kStepLimit:
      return MotionEnd::kStepLimit;
    case numerics::IntegrationEnd::kStepSize:
      return MotionEnd::kStepSize;
    case numerics::IntegrationEnd::kNotFinite:
      break;
  }
  return MotionEnd::kDiverged;
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
    case MotionEnd::kCompleted:
      return fmt::format("simulated to {:.6g} s", end_time);
    case MotionEnd::kDiverged:
      return fmt::format("the simulation diverged at {:.6g} s: {}", end_time, trouble);
    case MotionEnd::kStepSize:
      return fmt::format("no step is small enough at {:.6g} s: {}", end_time, trouble);
    case MotionEnd::kStepLimit:
      return fmt::format("the limit of {} steps was reached at {:.6g} s: {}", steps, end_time, trouble);
    case MotionEnd::kInterrupted:
      break;
  }
  return fmt::format("interrupted at {:.6g} s", end_time);
}

std::string largest_state(const MusculoskeletalSystem& system, const double* x) {
  std::size_t worst = 0;
  double largest = -1.0;
  for (std::size_t i = 0; i < system.layout().size; ++i) {
    const double size = std::abs(x[i]) / system.scales()[i];
    if (!(size <= largest)) {
      largest = size;
      worst = i;
    }
    if (std::isnan(size)) break;
  }
  return fmt::format("{} is {:.4g}", system.state_name(worst), x[worst]);
}

StartState default_start(const Model& model) {
  StartState start;
  start.q = model.default_pose();
  start.qdot.setZero(start.q.size());
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    start.qdot(i) = model.coordinates[i].default_speed;
  }
  return start;
}

MuscleTrajectory simulate_forward(const MusculoskeletalSystem& system, const StartState& start,
                                  const MuscleControls& controls, const ForwardOptions& options, Progress& progress) {
  check_start(system.model(), start);
  Assembly closed = assemble(system, start.q, start.qdot);
  const StateLayout& layout = system.layout();
  ControlsAtInstant signals(controls, system.muscles().size(), system.coordinates());
  SystemEvaluator<double> evaluator(system);
  Eigen::VectorXd x(layout.size);
  for (std::size_t i = 0; i < layout.free; ++i) {
    x(i) = closed.q(system.reduction().free()[i]);
    x(layout.free + i) = closed.qdot(system.reduction().free()[i]);
  }
  evaluator.hold(start.q.data());
  evaluator.set_motion(x.data(), x.data() + layout.free);
  signals.begin_piece(options.begin);
  evaluator.start_muscles(
      start.activation.size() > 0 ? start.activation.data() : signals.at(options.begin).excitation.data(), x.data());
  for (std::size_t m = 0; m < system.muscles().size() && start.fiber_length.size() > 0; ++m) {
    if (layout.fiber_length[m] >= 0) x(layout.fiber_length[m]) = start.fiber_length(m);
  }

  Recorder recorder(system, options);
  recorder.start(evaluator, x.data(), signals.at(options.begin));
  const double span = options.end - options.begin;
  const numerics::StepControl control{
      .tolerance = options.accuracy, .smallest_step = 1e-12 * span, .max_steps = options.max_steps};
  constexpr double kFarAway = 1e4;
  MotionEnd stopped = MotionEnd::kCompleted;
  double shown = options.begin;
  double t = options.begin;
  SystemStepper stepper(system, control);
  const numerics::IntegrationEnd end =
      integrate_driven(evaluator, signals, stepper, t, x.data(), options.end, [&](double from, double to) {
        recorder.step(stepper, evaluator, signals, from, to);
        for (std::size_t i = 0; i < layout.free; ++i) {
          if (std::abs(evaluator.q()[system.reduction().free()[i]]) > kFarAway) stopped = MotionEnd::kDiverged;
        }
        if (to - shown > 0.01 * span) {
          shown = to;
          if (!progress.update((to - options.begin) / span)) stopped = MotionEnd::kInterrupted;
        }
        return stopped == MotionEnd::kCompleted;
      });
  MuscleTrajectory result = recorder.finish();
  result.end = end == numerics::IntegrationEnd::kReached ? stopped : end_of(end);
  result.end_time = t;
  result.steps = stepper.steps();
  result.evaluations = evaluator.evaluations();
  result.final_state = x;
  result.assembly = std::move(closed);
  if (!result.usable()) result.trouble = largest_state(system, x.data());
  return result;
}

}  // namespace veridyn::muscle
