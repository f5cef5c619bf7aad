#include "veridyn/muscle/identification/muscle_along_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/actuator/fiber_solver.hpp"
#include "veridyn/muscle/identification/shaped_controls.hpp"
#include "veridyn/muscle/simulation/system_linearization.hpp"
#include "veridyn/numerics/additive_runge_kutta.hpp"

namespace veridyn::muscle {
namespace {

using Kind = PathMuscleColumn::Kind;

/// Directions of the jets: activation, fibre length, excitation, then numbers of the muscle.
constexpr int kActivationSlot = 0, kFiberSlot = 1, kExcitationSlot = 2, kFirstField = 3, kFieldsPerPass = 3;

/// A state of one muscle with the derivatives of its rates and its force.
struct Linearised {
  double activation_rate = 0.0, fiber_velocity = 0.0, force = 0.0;
  std::array<double, 3> activation_by{}, velocity_by{}, force_by{};   ///< by activation, fibre, excitation
  std::vector<double> activation_field, velocity_field, force_field;  ///< by column; 0 unless it is a field
};

/// View of one muscle on its path.
class PathSimulation {
 public:
  PathSimulation(const MuscleAlongPath& m, std::span<const PathMuscleColumn> columns)
      : m_(m),
        columns_(columns),
        n_(columns.size()),
        muscle_(m.muscle.with<double>({&m.parameters, 1})),
        elastic_(m.muscle.has_fiber_state(0)),
        controls_(m.controls, 0, {m.gain}, {m.delay}),
        solver_(1),
        stepper_({0, static_cast<char>(elastic_ ? 1 : 0)}, n_),
        x_(2 * (1 + n_), 0.0),
        between_(x_.size()),
        weight_(n_, 0.0) {
    for (auto* list : {&now_.activation_field, &now_.velocity_field, &now_.force_field}) list->assign(n_, 0.0);
    for (const PathMuscleColumn& c : columns) unit_.push_back(unit_of(c));
    // Where a forcing begins or turns a corner within a step, no step is short enough for a tangent that was zero.
    if (n_ > 0) controls_.split_at_samples(0);
    for (const PathMuscleColumn& c : columns) {
      if (c.kind != Kind::kError) continue;
      breaks_.push_back(c.knot - c.spacing + m.delay);
      breaks_.push_back(c.knot + c.spacing + m.delay);
    }
    std::sort(breaks_.begin(), breaks_.end());
    make_passes();
  }

  bool run(PathMuscleResponse& out) {
    out.force.assign(m_.time.size(), 0.0);
    out.fiber_length.assign(m_.time.size(), 0.0);
    out.force_by.setZero(m_.time.size(), n_);
    out.fiber_by.setZero(m_.time.size(), n_);
    response_ = &out;
    out.trouble.clear();
    double t = m_.begin;
    begin_piece(t);
    if (!start(t)) return diverges(t);
    while (row_ < m_.time.size() && m_.time[row_] <= t) write(m_.time[row_], x_.data());
    const double end = m_.time.empty() ? t : m_.time.back();
    const auto derivative = [&](double time, double step, double* x, double* rate) {
      return rates(time, step, x, rate);
    };
    const auto on_step = [&](double, double to) {
      while (row_ < m_.time.size() && m_.time[row_] <= to) {
        stepper_.interpolate(m_.time[row_], between_.data());
        write(m_.time[row_], between_.data());
      }
      return true;
    };
    // Fibres are stiff, and the method's estimate of their error is larger than the error (see SystemStepper).
    const std::array<double, 2> scales{0.01, 0.1 * m_.parameters.optimal_fiber_length};
    const numerics::StepControl control{.tolerance = 10.0 * m_.accuracy,
                                        .derivative_tolerance = std::max(10.0 * m_.accuracy, 1e-6),
                                        .least_derivative = 1.0,
                                        .smallest_step = 1e-12,
                                        .max_steps = 1000000};
    while (t < end) {
      if (stepper_.advance(derivative, t, x_.data(), std::min(end, piece_end_), scales, control, on_step) !=
          numerics::IntegrationEnd::kReached)
        return diverges(t);
      if (!(t < end)) break;
      begin_piece(t);
      stepper_.restart(true);
    }
    return row_ == m_.time.size() || diverges(t);
  }

 private:
  bool diverges(double time) {
    response_->trouble = fmt::format("the simulation diverges at {:.6g} s: activation {:.3g}, fibre length {:.4g} m",
                                     time, x_[0], x_[1]);
    return false;
  }

  /// Passes of jets, each with the columns whose fields it carries.
  struct Pass {
    MuscleGroup<SimulationJet> muscle;
    MusculotendonParameters<SimulationJet> parameters;
    std::vector<std::size_t> column;
  };

  void make_passes() {
    if (n_ == 0) return;
    std::vector<std::size_t> fields;
    for (std::size_t j = 0; j < n_; ++j)
      if (columns_[j].kind == Kind::kField) fields.push_back(j);
    for (std::size_t first = 0; first == 0 || first < fields.size(); first += kFieldsPerPass) {
      Pass pass;
      pass.parameters = m_.parameters.cast<SimulationJet>();
      for (std::size_t i = first; i < std::min(fields.size(), first + kFieldsPerPass); ++i) {
        field_of(pass.parameters, columns_[fields[i]].field).v(kFirstField + signed_index(i - first)) =
            unit_[fields[i]];
        pass.column.push_back(fields[i]);
      }
      pass.muscle = m_.muscle.with<SimulationJet>({&pass.parameters, 1});
      passes_.push_back(std::move(pass));
    }
  }

  void begin_piece(double time) {
    // Knots of neighbours are the same but for rounding, and a piece of that length is none.
    constexpr double kShortest = 1e-9;
    controls_.begin_piece(time);
    piece_end_ = controls_.piece_end(time + kShortest);
    const auto next = std::upper_bound(breaks_.begin(), breaks_.end(), time + kShortest);
    if (next != breaks_.end()) piece_end_ = std::min(piece_end_, *next);
  }

  /// u at an instant, and d(u)/d(column) in `weight_`. At the end of a piece the one that ends counts.
  double excitation(double time) {
    constexpr double kBefore = 1e-10;
    const double t = std::min(time, piece_end_ - kBefore);
    const double raw = controls_.at(t).excitation[0];
    const double least = m_.muscle.settings(0).minimum_activation;
    const double u = std::clamp(raw, least, 1.0);
    const bool free = u == raw;
    const double e = controls_.by_gain(0);
    for (std::size_t j = 0; j < n_; ++j) {
      const PathMuscleColumn& c = columns_[j];
      weight_[j] = 0.0;
      if (!free) continue;
      if (c.kind == Kind::kGain) weight_[j] = unit_[j] * e;
      if (c.kind == Kind::kDelay) weight_[j] = unit_[j] * controls_.by_delay(0);
      if (c.kind != Kind::kError) continue;
      const double away = (t - m_.delay - c.knot) / c.spacing;
      if (std::abs(away) < 1.0)
        weight_[j] = m_.gain * std::hypot(c.relative * e, c.absolute) * std::cos(0.5 * kPi * away);
    }
    return u;
  }

  void linearise(double u, double a, double l, double length, double speed) {
    for (std::size_t p = 0; p < passes_.size(); ++p) {
      const Pass& pass = passes_[p];
      const SimulationJet excitation(u, kExcitationSlot), activation(a, kActivationSlot), fiber(l, kFiberSlot),
          path(length), path_speed(speed);
      SimulationJet rate, velocity, force;
      muscle_rates(pass.muscle, {{&excitation, 1}, {&activation, 1}, {&fiber, 1}, {&path, 1}, {&path_speed, 1}},
                   {{&rate, 1}, {&velocity, 1}, {&force, 1}});
      if (p == 0) {
        now_.activation_rate = rate.a;
        now_.fiber_velocity = velocity.a;
        now_.force = force.a;
        for (std::size_t i = 0; i < 3; ++i) {
          now_.activation_by[i] = rate.v(i);
          now_.velocity_by[i] = velocity.v(i);
          now_.force_by[i] = force.v(i);
        }
      }
      for (std::size_t i = 0; i < pass.column.size(); ++i) {
        const Eigen::Index slot = kFirstField + signed_index(i);
        now_.activation_field[pass.column[i]] = rate.v(slot);
        now_.velocity_field[pass.column[i]] = velocity.v(slot);
        now_.force_field[pass.column[i]] = force.v(slot);
      }
    }
  }

  /// x' of activation and fibre length, then those of their tangents; a stage of the implicit method where `step` > 0.
  bool rates(double time, double step, double* x, double* rate) {
    const double u = excitation(time);
    const numerics::FunctionValue<double> path = m_.length.evaluate(time);
    double velocity = 0.0, activation_rate = 0.0, force = 0.0;
    const MuscleInputs<double> in{{&u, 1}, {x, 1}, {x + 1, 1}, {&path.value, 1}, {&path.slope, 1}};
    const MuscleOutputs<double> out{{&activation_rate, 1}, {&velocity, 1}, {&force, 1}};
    if (step > 0.0 && elastic_) {
      if (!solver_.solve(muscle_, step, in, {x + 1, 1}, out)) return false;
    } else {
      muscle_.rates(in, out);
    }
    rate[0] = activation_rate;
    rate[1] = velocity;
    if (n_ == 0) return std::isfinite(velocity);
    linearise(u, x[0], x[1], path.value, path.slope);
    double *Sa = x + 2, *Sl = Sa + n_, *Ra = rate + 2, *Rl = Ra + n_;
    const double implicit = elastic_ ? step : 0.0;
    for (std::size_t j = 0; j < n_; ++j) {
      Ra[j] = now_.activation_by[0] * Sa[j] + now_.activation_by[2] * weight_[j] + now_.activation_field[j];
      const double forced = now_.velocity_by[0] * Sa[j] + now_.velocity_by[2] * weight_[j] + now_.velocity_field[j];
      if (implicit > 0.0) Sl[j] = (Sl[j] + implicit * forced) / (1.0 - implicit * now_.velocity_by[1]);
      Rl[j] = forced + now_.velocity_by[1] * Sl[j];
    }
    return std::isfinite(velocity);
  }

  bool start(double time) {
    const double u = excitation(time), length = m_.length.evaluate(time).value;
    x_[0] = u;
    muscle_.equilibrium({&u, 1}, {&length, 1}, {x_.data() + 1, 1});
    if (!elastic_) x_[1] = 0.0;
    for (std::size_t j = 0; j < n_; ++j) x_[2 + j] = weight_[j];
    for (const Pass& pass : passes_) {
      if (!elastic_) break;
      const SimulationJet activation(u, kActivationSlot), path(length);
      SimulationJet fiber;
      pass.muscle.equilibrium({&activation, 1}, {&path, 1}, {&fiber, 1});
      if (&pass == &passes_.front())
        for (std::size_t j = 0; j < n_; ++j) x_[2 + n_ + j] = fiber.v(kActivationSlot) * weight_[j];
      for (std::size_t i = 0; i < pass.column.size(); ++i)
        x_[2 + n_ + pass.column[i]] += fiber.v(kFirstField + signed_index(i));
    }
    return std::isfinite(x_[1]);
  }

  void write(double time, const double* x) {
    PathMuscleResponse& out = *response_;
    const double u = excitation(time);
    const numerics::FunctionValue<double> path = m_.length.evaluate(time);
    const std::size_t k = row_++;
    if (n_ == 0) {
      double force = 0.0;
      muscle_.tendon_forces({{&u, 1}, {x, 1}, {x + 1, 1}, {&path.value, 1}, {&path.slope, 1}}, {&force, 1});
      out.force[k] = force;
      out.fiber_length[k] = elastic_ ? x[1] : rigid_fiber(m_.parameters, path.value);
      return;
    }
    linearise(u, x[0], x[1], path.value, path.slope);
    out.force[k] = now_.force;
    out.fiber_length[k] = elastic_ ? x[1] : rigid_fiber(m_.parameters, path.value);
    const double *Sa = x + 2, *Sl = Sa + n_;
    for (std::size_t j = 0; j < n_; ++j) {
      const double by =
          now_.force_by[0] * Sa[j] + now_.force_by[1] * Sl[j] + now_.force_by[2] * weight_[j] + now_.force_field[j];
      out.force_by(k, j) = by / unit_[j];
      if (elastic_) out.fiber_by(k, j) = Sl[j] / unit_[j];
    }
    for (const Pass& pass : passes_) {
      if (elastic_) break;
      const SimulationJet fiber = rigid_fiber(pass.parameters, SimulationJet(path.value));
      for (std::size_t i = 0; i < pass.column.size(); ++i)
        out.fiber_by(k, pass.column[i]) = fiber.v(kFirstField + signed_index(i)) / unit_[pass.column[i]];
    }
  }

  /// Tangents are integrated in units in which they are of the size of the states' scales.
  [[nodiscard]] double unit_of(const PathMuscleColumn& c) const {
    constexpr double kDelay_s = 0.05;
    if (c.kind == Kind::kDelay) return kDelay_s;
    if (c.kind != Kind::kField) return 1.0;
    const double value = field_of(m_.parameters, c.field);
    return value > 0.0 ? value : 1.0;
  }

  template <typename Scalar>
  static Scalar rigid_fiber(const MusculotendonParameters<Scalar>& p, const Scalar& path) {
    using std::sin;
    using std::sqrt;
    Scalar along = path - p.tendon_slack_length;
    if (!(along > Scalar(0.0))) along = Scalar(0.0);
    const Scalar height = p.optimal_fiber_length * sin(p.pennation_angle_at_optimal);
    const Scalar square = along * along + height * height;
    return square > Scalar(0.0) ? Scalar(sqrt(square)) : Scalar(0.0);
  }

  const MuscleAlongPath& m_;
  std::span<const PathMuscleColumn> columns_;
  std::size_t n_;
  MuscleGroup<double> muscle_;
  bool elastic_;
  ShapedControls controls_;
  FiberSolver solver_;
  numerics::AdditiveRungeKutta stepper_;
  std::vector<double> x_, between_;
  std::vector<double> weight_, breaks_, unit_;
  std::vector<Pass> passes_;
  Linearised now_;
  double piece_end_ = kInfinity;
  PathMuscleResponse* response_ = nullptr;
  std::size_t row_ = 0;
};

}  // namespace

bool simulate_along_path(const MuscleAlongPath& muscle, std::span<const PathMuscleColumn> columns,
                         PathMuscleResponse& response) {
  return PathSimulation(muscle, columns).run(response);
}

}  // namespace veridyn::muscle
