#include "veridyn/muscle/identification/muscle_simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/muscle_values.hpp"
#include "veridyn/muscle/identification/shaped_controls.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"
#include "veridyn/muscle/simulation/system_linearization.hpp"
#include "veridyn/muscle/simulation/system_stepper.hpp"

namespace veridyn::muscle::internal {
namespace {

numerics::StepControl step_control(double accuracy) {
  // Rounding leaves no more.
  constexpr double kFinest = 1e-8;
  // Where all of an unknown would move the state by less than a thousandth of its scale.
  constexpr double kLeastDerivative = 1e-3;
  return {.tolerance = accuracy,
          .derivative_tolerance = std::max(10.0 * accuracy, kFinest),
          .least_derivative = kLeastDerivative,
          .smallest_step = 1e-12,
          .max_steps = 200000};
}

/// The size of an unknown, a power of two, so that it costs no rounding: tangents are integrated as those by the
/// unknown over its size, so that all are of the order of the state.
double size_of(const MuscleTask& task, Eigen::Index unknown) {
  if (at(unknown) >= task.unknowns.size()) return 1.0;
  const MuscleUnknown& u = task.unknowns[unknown];
  // A start may be next to nothing, as that of a delay.
  constexpr double kOfRange = 0.1;
  const double range = u.high - u.low;
  const double size = std::max(std::abs(u.start), std::isfinite(range) ? kOfRange * range : 0.0);
  return size > 0.0 && std::isfinite(size) ? std::exp2(std::round(std::log2(size))) : 1.0;
}

/// Initial motion, and the activations that muscles start with.
void set_start(const MuscleTask& task, const Eigen::VectorXd& theta, std::vector<double>& x) {
  const std::size_t free = task.system->layout().free;
  for (std::size_t i = 0; i < 2 * free; ++i) x[i] = theta(task.unknowns.size() + i);
}

const double* start_activation(const MuscleTask& task, ShapedControls& controls) {
  const Eigen::VectorXd& given = task.segment->start.activation;
  return given.size() > 0 ? given.data() : controls.at(task.segment->time.front()).excitation.data();
}

/// Integrates from the first sample to the last, changing `t`; `on_jump(t)` is called where held signals have jumped.
template <typename OnStep, typename OnJump>
bool integrate(const MuscleTask& task, ShapedControls& controls, SystemStepper& stepper,
               const SystemStepper::Derivative& derivative, double& t, double* x, const OnStep& on_step,
               const OnJump& on_jump) {
  const double end = task.segment->time.back();
  const SystemStepper::OnStep step = [&](double, double to) {
    on_step(to);
    return true;
  };
  while (t < end) {
    if (stepper.advance(derivative, t, x, std::min(end, controls.piece_end(t)), step) !=
        numerics::IntegrationEnd::kReached)
      return false;
    if (!(t < end)) break;
    controls.begin_piece(t);
    on_jump(t);
    stepper.restart(true);
  }
  return true;
}

bool states_suffice(std::span<const MuscleOutput> outputs) {
  return std::all_of(outputs.begin(), outputs.end(), [](const MuscleOutput& o) {
    return o.kind == MuscleOutputKind::kValue || o.kind == MuscleOutputKind::kSpeed;
  });
}

/// Moment of the muscles about a coordinate, with those that follow it.
double muscle_moment(SystemEvaluator<double>& e, const MusculoskeletalSystem& system, int coordinate) {
  const auto pairs = system.pairs();
  const double* slope = e.dynamics().state().slope.data();
  double moment = 0.0;
  for (std::size_t p = 0; p < pairs.size(); ++p)
    moment -= e.tendon_force()[pairs[p].muscle] * e.path_gradient()[p] *
              system.reduction().share_in(pairs[p].coordinate, coordinate, slope);
  return moment;
}

double fiber_length_of(const SystemEvaluator<double>& e, const MusculoskeletalSystem& system,
                       const MuscleValues& parameters, int muscle) {
  if (system.layout().fiber_length[muscle] >= 0) return e.fiber_length()[muscle];
  const MusculotendonParameters<double>& p = parameters.muscles[muscle];
  return std::hypot(std::max(0.0, e.path_length()[muscle] - p.tendon_slack_length),
                    p.optimal_fiber_length * std::sin(p.pennation_angle_at_optimal));
}

/// The forcings of the tangents by unknowns of the muscles, and which unknown each belongs to.
struct Forcings {
  std::vector<TangentForcing> list;
  std::vector<MuscleParameterName> of;  ///< the parameter behind each
  std::vector<double> factor;           ///< d(parameter)/d(unknown over its size)
};

Forcings forcings_of(const MuscleTask& task, std::span<const Eigen::Index> active) {
  Forcings result;
  for (std::size_t column = 0; column < active.size(); ++column) {
    const std::size_t i = at(active[column]);
    if (i >= task.unknowns.size()) continue;
    const MuscleUnknown& u = task.unknowns[i];
    for (const MuscleParameterName& name : u.parameters) {
      double weight = size_of(task, active[column]);
      if (u.factor && !name.of_excitation())
        weight *= field_of(task.system->muscles().settings(at(name.muscle)).musculotendon, name.field);
      result.list.push_back({column, at(name.muscle), name.of_excitation() ? TangentForcing::kExcitation : name.field,
                             name.of_excitation() ? 0.0 : weight});
      result.of.push_back(name);
      result.factor.push_back(weight);
    }
  }
  return result;
}

/// View of one task with its linearisation: simulates it with tangents.
class TangentSimulation {
 public:
  TangentSimulation(const MuscleTask& task, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                    MuscleValues parameters, estimation::ModelResponse& response)
      : task_(task),
        system_(*task.system),
        columns_(active.size()),
        size_(system_.layout().size),
        forcings_(forcings_of(task, active)),
        linearization_(system_, parameters.muscles, forcings_.list, columns_),
        controls_(task.segment->controls, system_.coordinates(), std::move(parameters.gain),
                  std::move(parameters.delay)),
        stepper_(system_, step_control(task.accuracy), columns_),
        x_(size_ * (1 + columns_), 0.0),
        between_(x_.size()),
        rate_(size_),
        simple_outputs_(states_suffice(task.outputs)),
        response_(response) {
    set_start(task, theta, x_);
    for (const MuscleParameterName& name : forcings_.of) {
      if (name.field == MuscleParameterName::kDelay) controls_.split_at_samples(at(name.muscle));
    }
    for (std::size_t j = 0; j < columns_; ++j) {
      const std::size_t i = at(active[j]);
      column_size_.push_back(size_of(task, active[j]));
      if (i >= task.unknowns.size()) x_[size_ + (i - task.unknowns.size()) * columns_ + j] = 1.0;
    }
  }

  bool run() {
    const double begin = task_.segment->time.front();
    linearization_.hold(task_.segment->start.q.data());
    controls_.begin_piece(begin);
    static_cast<void>(inputs(begin));
    linearization_.start_muscles(start_activation(task_, controls_), task_.segment->start.activation.size() == 0,
                                 x_.data(), x_.data() + size_);
    if (!write(begin, x_.data())) return false;
    bool good = true;
    const auto derivative = [&](double t, double step, double* x, double* rate) {
      if (!linearization_.stage(step, x, inputs(t), rate)) return false;
      linearization_.tangent_rate(step, x + size_, rate + size_);
      return true;
    };
    const auto on_step = [&](double to) {
      const std::vector<double>& time = task_.segment->time;
      while (row_ < time.size() && time[row_] <= to) {
        stepper_.interpolate(time[row_], between_.data());
        good = write(time[row_], between_.data()) && good;
      }
    };
    double reached_s = begin;
    const bool reached = integrate(task_, controls_, stepper_, derivative, reached_s, x_.data(), on_step,
                                   [&](double t) { add_jumps(t); });
    for (std::size_t j = 0; j < columns_; ++j) response_.sensitivity.col(j) /= column_size_[j];
    return reached && good && row_ == task_.segment->time.size();
  }

 private:
  SystemInputs inputs(double time) {
    const SystemInputs in = controls_.at(time);
    for (std::size_t i = 0; i < forcings_.of.size(); ++i) {
      const MuscleParameterName& name = forcings_.of[i];
      if (!name.of_excitation()) continue;
      linearization_.set_weight(
          i, forcings_.factor[i] * (name.field == MuscleParameterName::kGain ? controls_.by_gain(at(name.muscle))
                                                                             : controls_.by_delay(at(name.muscle))));
    }
    return in;
  }

  /// Where an excitation that is held jumps, a delay moves the instant: the tangent jumps by the rate before less the
  /// rate after.
  void add_jumps(double time) {
    const SystemInputs after = inputs(time);
    bool any = false;
    for (const MuscleParameterName& name : forcings_.of)
      any = any || (name.field == MuscleParameterName::kDelay && controls_.jumped(at(name.muscle)));
    if (any) {
      std::vector<double> u(last_excitation_), rate_before(size_);
      if (!linearization_.derivative(x_.data(), {u, after.coordinate_force}, rate_before.data())) return;
      for (std::size_t i = 0; i < forcings_.of.size(); ++i) {
        const std::size_t m = at(forcings_.of[i].muscle);
        if (forcings_.of[i].field != MuscleParameterName::kDelay || !controls_.jumped(m)) continue;
        u[m] = after.excitation[m];
        if (!linearization_.derivative(x_.data(), {u, after.coordinate_force}, rate_.data())) return;
        u[m] = last_excitation_[m];
        for (std::size_t s = 0; s < size_; ++s)
          x_[size_ + s * columns_ + forcings_.list[i].column] += forcings_.factor[i] * (rate_before[s] - rate_[s]);
      }
    }
    last_excitation_.assign(after.excitation.begin(), after.excitation.end());
  }

  bool write(double time, const double* x) {
    const double* const S = x + size_;
    const SystemInputs in = inputs(time);
    if (row_ == 0) last_excitation_.assign(in.excitation.begin(), in.excitation.end());
    if (!simple_outputs_ && !linearization_.derivative(x, in, rate_.data())) return false;
    const CoordinateReduction& reduction = system_.reduction();
    for (std::size_t o = 0; o < task_.outputs.size(); ++o) {
      const MuscleOutput& output = task_.outputs[o];
      const std::size_t at_row = row_ * task_.outputs.size() + o;
      double* const row = response_.sensitivity.data() + at_row * columns_;
      double& value = response_.output(row_, o);
      const std::size_t index = at(output.index);
      if (output.kind == MuscleOutputKind::kTendonForce) {
        value = linearization_.tendon_force(index);
        linearization_.tendon_force_row(index, S, row);
        continue;
      }
      if (output.kind == MuscleOutputKind::kFiberLength) {
        value = linearization_.fiber_length(index, x);
        linearization_.fiber_length_row(index, S, row);
        continue;
      }
      const int root = reduction.role(output.index) == CoordinateRole::kFree ? reduction.free_root(output.index) : -1;
      if (root < 0 && output.kind != MuscleOutputKind::kMoment) {
        value = output.kind == MuscleOutputKind::kValue ? task_.segment->start.q(output.index) : 0.0;
        std::fill(row, row + columns_, 0.0);
        continue;
      }
      if (output.kind == MuscleOutputKind::kMoment) {
        value = linearization_.muscle_moment(output.index);
        linearization_.muscle_moment_row(output.index, S, row);
        continue;
      }
      const std::size_t state = at(root) + (output.kind == MuscleOutputKind::kSpeed ? system_.layout().free : 0);
      value = x[state];
      std::copy(S + state * columns_, S + (state + 1) * columns_, row);
    }
    ++row_;
    return true;
  }

  const MuscleTask& task_;
  const MusculoskeletalSystem& system_;
  std::size_t columns_, size_;
  Forcings forcings_;
  SystemLinearization linearization_;
  ShapedControls controls_;
  SystemStepper stepper_;
  std::vector<double> x_, between_, rate_, last_excitation_;
  std::vector<double> column_size_;  ///< of each column's unknown
  bool simple_outputs_;
  estimation::ModelResponse& response_;
  std::size_t row_ = 0;
};

}  // namespace

bool simulate_values(const MuscleTask& task, const Eigen::VectorXd& theta, estimation::ModelResponse& response,
                     std::string* trouble) {
  MuscleValues parameters = values_at(task.system->muscles(), task.unknowns, theta);
  if (!parameters.possible()) {
    if (trouble != nullptr) *trouble = "a muscle cannot have these parameters";
    return false;
  }
  const MusculoskeletalSystem& system = *task.system;
  const StateLayout& layout = system.layout();
  SystemEvaluator<double> evaluator(system, system.muscles().with<double>(parameters.muscles));
  evaluator.hold(task.segment->start.q.data());
  ShapedControls controls(task.segment->controls, system.coordinates(), parameters.gain, parameters.delay);
  const std::vector<double>& time = task.segment->time;
  controls.begin_piece(time.front());
  std::vector<double> x(layout.size), between(x.size()), rate(x.size());
  set_start(task, theta, x);
  evaluator.set_motion(x.data(), x.data() + layout.free);
  evaluator.start_muscles(start_activation(task, controls), x.data());
  const bool simple = states_suffice(task.outputs);
  std::optional<SystemEvaluator<double>> at_sample;
  if (!simple) at_sample = evaluator;
  std::size_t row = 0;
  bool good = true;
  const auto write = [&](double t, const double* state) {
    if (!simple && !at_sample->derivative(state, controls.at(t), rate.data())) good = false;
    for (std::size_t o = 0; o < task.outputs.size(); ++o) {
      const MuscleOutput& output = task.outputs[o];
      double& value = response.output(row, o);
      switch (output.kind) {
        case MuscleOutputKind::kTendonForce:
          value = at_sample->tendon_force()[output.index];
          continue;
        case MuscleOutputKind::kFiberLength:
          value = fiber_length_of(*at_sample, system, parameters, output.index);
          continue;
        case MuscleOutputKind::kMoment:
          value = muscle_moment(*at_sample, system, output.index);
          continue;
        case MuscleOutputKind::kValue:
        case MuscleOutputKind::kSpeed:
          break;
      }
      const bool speed = output.kind == MuscleOutputKind::kSpeed;
      const bool free = system.reduction().role(output.index) == CoordinateRole::kFree;
      const std::size_t root = free ? at(system.reduction().free_root(output.index)) : 0;
      value = free ? state[root + (speed ? layout.free : 0)] : speed ? 0.0 : task.segment->start.q(output.index);
    }
    ++row;
  };
  write(time.front(), x.data());
  SystemStepper stepper(system, step_control(task.accuracy));
  const auto derivative = [&](double t, double step, double* state, double* out) {
    return evaluator.stage(step, state, controls.at(t), out);
  };
  const auto on_step = [&](double to) {
    while (row < time.size() && time[row] <= to) {
      stepper.interpolate(time[row], between.data());
      write(time[row], between.data());
    }
  };
  double t = time.front();
  const bool reached = integrate(task, controls, stepper, derivative, t, x.data(), on_step, [](double) {});
  const bool complete = reached && good && row == time.size() && response.output.allFinite();
  if (!complete && trouble != nullptr)
    *trouble = fmt::format("the simulation diverges at {:.6g} s: {}", t, largest_state(system, x.data()));
  return complete;
}

bool simulate_tangents(const MuscleTask& task, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                       estimation::ModelResponse& response) {
  MuscleValues parameters = values_at(task.system->muscles(), task.unknowns, theta);
  if (!parameters.possible()) return false;
  return TangentSimulation(task, theta, active, std::move(parameters), response).run();
}

}  // namespace veridyn::muscle::internal
