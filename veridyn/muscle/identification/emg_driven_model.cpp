#include "veridyn/muscle/identification/emg_driven_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/muscle_along_path.hpp"
#include "veridyn/muscle/identification/muscle_values.hpp"
#include "veridyn/muscle/simulation/motion_analysis.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

/// A derivative of one muscle and the unknown that it belongs to.
struct ChainedColumn {
  std::size_t to = 0;
  double weight = 1.0;  ///< d(parameter)/d(unknown)
};

/// View of a segment: columns of the response by one muscle's columns, an output's share of force or fibre length.
class MuscleShare {
 public:
  MuscleShare(const EmgSegment& segment, std::span<const MuscleOutput> outputs, std::size_t muscles)
      : segment_(segment), outputs_(outputs), muscles_(muscles) {}

  /// Calls `add(row, factor, force)` for every output of every sample that the muscle moves: with its force where
  /// `force`, else its fibre length.
  template <typename Add>
  void for_each(std::size_t muscle, const Add& add) const {
    for (std::size_t k = 0; k < segment_.time.size(); ++k) {
      for (std::size_t o = 0; o < outputs_.size(); ++o) {
        const MuscleOutput& output = outputs_[o];
        const std::size_t row = k * outputs_.size() + o;
        if (output.kind == MuscleOutputKind::kMoment) {
          add(k, row, segment_.arm(k, o * muscles_ + muscle), true);
        } else if (at(output.index) == muscle) {
          add(k, row, 1.0, output.kind == MuscleOutputKind::kTendonForce);
        }
      }
    }
  }

 private:
  const EmgSegment& segment_;
  std::span<const MuscleOutput> outputs_;
  std::size_t muscles_;
};

}  // namespace

EmgSegment along_motion(const MusculoskeletalSystem& system, const Motion& motion, const Eigen::VectorXd& rest,
                        double begin, std::vector<double> time, std::span<const MuscleOutput> outputs) {
  constexpr double kRate_Hz = 500.0;
  if (time.empty() || time.front() < begin || !std::is_sorted(time.begin(), time.end(), std::less_equal<>()))
    throw std::invalid_argument("along_motion: times must increase from the beginning on");
  EmgSegment segment;
  segment.begin = begin;
  segment.time = std::move(time);
  // Evenly from end to end: beyond its last sample a motion stands still, and a spline through the corner would ring.
  const double span = segment.time.back() - begin;
  const auto steps = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(span * kRate_Hz - 1e-6)));
  std::vector<double> grid;
  for (std::size_t i = 0; i <= steps; ++i)
    grid.push_back(i == steps ? segment.time.back()
                              : begin + span * static_cast<double>(i) / static_cast<double>(steps));
  if (!(span > 0.0)) grid.resize(1);
  const MotionAnalysis table = analyse_motion(system, motion, rest, grid);
  const std::size_t muscles = system.muscles().size();
  for (std::size_t m = 0; m < muscles; ++m) {
    const std::vector<double> length(table.path_length.col(m).begin(), table.path_length.col(m).end());
    segment.length.push_back(numerics::PiecewisePolynomial::quintic_spline(grid, length));
  }
  const MotionAnalysis poses = analyse_motion(system, motion, rest, segment.time);
  segment.arm.setZero(segment.time.size(), outputs.size() * muscles);
  SystemEvaluator<double> evaluator(system);
  for (Eigen::Index k = 0; k < segment.arm.rows(); ++k) {
    evaluator.set_all(poses.q.row(k).data(), poses.qdot.row(k).data());
    const Eigen::VectorXd slope = coupled_slopes(poses.q.row(k).transpose(), system.reduction());
    for (std::size_t o = 0; o < outputs.size(); ++o) {
      if (outputs[o].kind != MuscleOutputKind::kMoment) continue;
      for (std::size_t p = 0; p < system.pairs().size(); ++p) {
        const auto& pair = system.pairs()[p];
        segment.arm(k, o * muscles + at(pair.muscle)) -=
            evaluator.path_gradient()[p] * system.reduction().share_in(pair.coordinate, outputs[o].index, slope.data());
      }
    }
  }
  return segment;
}

EmgDrivenModel::EmgDrivenModel(const MusculoskeletalSystem& system, std::vector<MuscleUnknown> unknowns,
                               std::vector<EmgSegment> segments, std::vector<MuscleOutput> outputs,
                               std::vector<int> signal_of, double accuracy, const EmgError& error)
    : system_(&system),
      unknowns_(std::move(unknowns)),
      segments_(std::move(segments)),
      chosen_(std::move(outputs)),
      signal_of_(std::move(signal_of)),
      accuracy_(accuracy),
      error_(error) {
  const Model& model = system.model();
  check_unknowns(model, unknowns_, model.name);
  for (const MuscleOutput& output : chosen_) {
    if (output.kind == MuscleOutputKind::kValue || output.kind == MuscleOutputKind::kSpeed)
      throw InputError(model.name,
                       fmt::format("output '{}' is what this model is given: with EMG, outputs are moments, "
                                   "fibre lengths and tendon forces",
                                   output_name(model, output)));
    outputs_.push_back({output_name(model, output), output_unit(model, output)});
  }
  for (std::size_t m = 0; m < model.muscles.size(); ++m) {
    alone_.emplace_back(std::span<const MuscleParameters>(&system.muscles().settings(m), 1));
    least_.push_back({ControlSignals({system.muscles().settings(m).minimum_activation}), {}});
  }
  parameters_ = model_parameters(unknowns_);
  double early = 0.0, late = 0.0;
  for (const MuscleUnknown& u : unknowns_) {
    if (!u.is_delay()) continue;
    early = std::min(early, u.fixed ? u.start : u.low);
    late = std::max(late, u.fixed ? u.start : u.high);
  }
  for (const EmgSegment& s : segments_) shapes_.push_back(error_shapes(error_, s.begin - late, s.time.back() - early));
}

Eigen::Index EmgDrivenModel::errors(std::size_t segment) const {
  return signed_index(shapes_[segment].size() * segments_[segment].emg.size());
}

std::vector<int> EmgDrivenModel::error_parts(std::size_t segment) const {
  std::vector<int> parts;
  for (std::size_t i = 0; i < segments_[segment].emg.size(); ++i)
    for (const EmgErrorShape& shape : shapes_[segment]) parts.push_back(shape.part);
  return parts;
}

std::vector<MuscleControls> EmgDrivenModel::signals_at(std::size_t segment, const Eigen::VectorXd& theta) const {
  std::vector<MuscleControls> signals = segments_[segment].emg;
  if (theta.size() == signed_index(parameters_.size())) return signals;
  const Eigen::Index each = signed_index(shapes_[segment].size());
  for (std::size_t i = 0; i < signals.size(); ++i)
    signals[i].excitation = without_errors(signals[i].excitation, error_, shapes_[segment],
                                           theta.segment(signed_index(parameters_.size() + i * at(each)), each));
  return signals;
}

bool EmgDrivenModel::acts(std::size_t segment, std::size_t muscle) const {
  for (std::size_t o = 0; o < chosen_.size(); ++o) {
    if (chosen_[o].kind != MuscleOutputKind::kMoment && at(chosen_[o].index) == muscle) return true;
    if (chosen_[o].kind == MuscleOutputKind::kMoment &&
        !segments_[segment].arm.col(o * alone_.size() + muscle).isZero(0.0))
      return true;
  }
  return false;
}

MuscleAlongPath EmgDrivenModel::along(std::size_t segment, std::size_t m, const MuscleValues& values,
                                      const std::vector<MuscleControls>& signals) const {
  const EmgSegment& s = segments_[segment];
  const MuscleControls& controls = signal_of_[m] >= 0 ? signals[signal_of_[m]] : least_[m];
  return {alone_[m], s.length[m],       controls,       s.begin,        s.time,
          accuracy_, values.muscles[m], values.gain[m], values.delay[m]};
}

std::string EmgDrivenModel::trouble(std::size_t segment, const Eigen::VectorXd& theta) const {
  const MuscleValues values = values_at(system_->muscles(), unknowns_, theta);
  if (!values.possible()) return "a muscle cannot have these parameters";
  PathMuscleResponse out;
  for (std::size_t m = 0; m < alone_.size(); ++m) {
    if (acts(segment, m) && !simulate_along_path(along(segment, m, values, segments_[segment].emg), {}, out))
      return fmt::format("{}: {}", system_->model().muscles[m].name(), out.trouble);
  }
  return {};
}

bool EmgDrivenModel::respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             estimation::ModelResponse& response) const {
  const EmgSegment& s = segments_[segment];
  const auto outputs = signed_index(chosen_.size());
  response.output.setZero(samples(segment), outputs);
  response.sensitivity.setZero(samples(segment) * outputs, active.size());
  const MuscleValues values = values_at(system_->muscles(), unknowns_, theta);
  if (!values.possible()) return false;
  const std::vector<MuscleControls> signals = signals_at(segment, theta);
  const MuscleShare share(s, chosen_, alone_.size());
  PathMuscleResponse out;
  for (std::size_t m = 0; m < alone_.size(); ++m) {
    if (!acts(segment, m)) continue;
    std::vector<PathMuscleColumn> columns;
    std::vector<ChainedColumn> chained, by_strength;
    for (std::size_t c = 0; c < active.size(); ++c) {
      const MuscleUnknown& u = unknowns_[active[c]];
      for (const MuscleParameterName& name : u.parameters) {
        if (at(name.muscle) != m) continue;
        const bool scaled = u.factor && !name.of_excitation();
        const double weight = scaled ? field_of(system_->muscles().settings(m).musculotendon, name.field) : 1.0;
        // Everything but the force is independent of F0, which it is proportional to.
        if (name.field == 0) {
          by_strength.push_back({c, weight / values.muscles[m].max_isometric_force});
          continue;
        }
        chained.push_back({c, weight});
        columns.push_back({.kind = name.field == MuscleParameterName::kGain    ? PathMuscleColumn::Kind::kGain
                                   : name.field == MuscleParameterName::kDelay ? PathMuscleColumn::Kind::kDelay
                                                                               : PathMuscleColumn::Kind::kField,
                           .field = name.field});
      }
    }
    if (!simulate_along_path(along(segment, m, values, signals), columns, out)) return false;
    share.for_each(m, [&](std::size_t k, std::size_t row, double factor, bool of_force) {
      response.output.data()[row] += factor * (of_force ? out.force[k] : out.fiber_length[k]);
      auto to = response.sensitivity.row(row);
      const estimation::RowMatrix& by = of_force ? out.force_by : out.fiber_by;
      for (std::size_t j = 0; j < chained.size(); ++j) to(chained[j].to) += factor * chained[j].weight * by(k, j);
      for (const ChainedColumn& c : by_strength)
        if (of_force) to(c.to) += factor * c.weight * out.force[k];
    });
  }
  return response.output.allFinite() && response.sensitivity.allFinite();
}

bool EmgDrivenModel::error_response(std::size_t segment, const Eigen::VectorXd& theta,
                                    estimation::RowMatrix& response) const {
  const EmgSegment& s = segments_[segment];
  const MuscleValues values = values_at(system_->muscles(), unknowns_, theta);
  if (!values.possible()) return false;
  std::vector<PathMuscleColumn> columns;
  for (const EmgErrorShape& shape : shapes_[segment])
    columns.push_back({.kind = PathMuscleColumn::Kind::kError,
                       .knot = shape.knot,
                       .spacing = shape.spacing,
                       .relative = error_.relative,
                       .absolute = error_.absolute});
  const Eigen::Index knots = signed_index(columns.size());
  const auto rows = samples(segment) * signed_index(chosen_.size());
  response.setZero(rows, knots * signed_index(s.emg.size()));
  if (knots == 0) return true;
  const std::vector<MuscleControls> signals = signals_at(segment, theta);
  const MuscleShare share(s, chosen_, alone_.size());
  PathMuscleResponse out;
  for (std::size_t m = 0; m < alone_.size(); ++m) {
    if (signal_of_[m] < 0 || !acts(segment, m)) continue;
    if (!simulate_along_path(along(segment, m, values, signals), columns, out)) return false;
    share.for_each(m, [&](std::size_t k, std::size_t row, double factor, bool of_force) {
      const estimation::RowMatrix& by = of_force ? out.force_by : out.fiber_by;
      response.row(row).segment(knots * signal_of_[m], knots) += factor * by.row(k);
    });
  }
  return response.allFinite();
}

std::vector<double> EmgDrivenModel::saturation(std::size_t segment, const Eigen::VectorXd& theta) const {
  const EmgSegment& s = segments_[segment];
  const MuscleValues values = values_at(system_->muscles(), unknowns_, theta);
  std::vector<double> share(alone_.size(), 0.0);
  for (std::size_t m = 0; m < alone_.size(); ++m) {
    if (signal_of_[m] < 0) continue;
    for (const double t : s.time) {
      double e = 0.0;
      s.emg[signal_of_[m]].excitation.evaluate(t - values.delay[m], &e);
      if (values.gain[m] * e > 1.0) share[m] += 1.0 / static_cast<double>(s.time.size());
    }
  }
  return share;
}

}  // namespace veridyn::muscle
