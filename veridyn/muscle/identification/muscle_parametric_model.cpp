#include "veridyn/muscle/simulation/muscle_parametric_model.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/simulation/driven_integration.hpp"

namespace veridyn::muscle {

MuscleParameterName parse_parameter_name(const Model& model, std::string_view text, std::string_view place) {
  const std::size_t dot = text.rfind('.');
  const std::string_view muscle = text.substr(0, dot);
  const std::string_view field = dot == std::string_view::npos ? std::string_view() : text.substr(dot + 1);
  MuscleParameterName result{model.muscle(muscle), kMusculotendonFields.size()};
  if (result.muscle < 0) throw InputError(place, fmt::format("'{}': {}", text, model.no_muscle(muscle)));
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kMusculotendonFields.size(); ++i) {
    names.emplace_back(kMusculotendonFields[i].name);
    if (kMusculotendonFields[i].name == field) result.field = i;
  }
  if (result.field == kMusculotendonFields.size()) {
    throw InputError(place,
                     fmt::format("'{}': a muscle has no parameter '{}'{}", text, field, suggestion(field, names)));
  }
  return result;
}

MuscleParametricModel::MuscleParametricModel(const MusculoskeletalSystem& system,
                                             std::vector<MuscleParameterName> names,
                                             std::vector<MotionSegment> segments, double accuracy, bool estimate_start)
    : system_(&system), names_(std::move(names)), segments_(std::move(segments)), accuracy_(accuracy) {
  for (const MuscleParameterName& name : names_) {
    const MuscleParameters& muscle = system.muscles().settings(static_cast<std::size_t>(name.muscle));
    const double value = field_of(muscle.musculotendon, name.field);
    const MusculotendonField& field = kMusculotendonFields[name.field];
    parameters_.push_back({.name = fmt::format("{}.{}", muscle.name, field.name),
                           .unit = std::string(field.unit),
                           .start = value,
                           .low = 0.5 * value,
                           .high = 1.5 * value});
  }
  const std::span<const int> free = system.reduction().free();
  for (const int c : free) {
    const Coordinate& coordinate = system.model().coordinates[static_cast<std::size_t>(c)];
    outputs_.push_back({coordinate.name, coordinate.unit()});
  }
  for (const MotionSegment& segment : segments_) {
    std::vector<estimation::ModelParameter> initial;
    for (const bool speed : {false, true}) {
      for (const int c : free) {
        const Coordinate& coordinate = system.model().coordinates[static_cast<std::size_t>(c)];
        initial.push_back({.name = coordinate.name + (speed ? ".start_speed" : ".start"),
                           .unit = coordinate.unit() + (speed ? "/s" : ""),
                           .start = speed ? segment.start.qdot(c) : segment.start.q(c),
                           .fixed = !estimate_start});
      }
    }
    initial_.push_back(std::move(initial));
  }
}

template <typename Scalar>
bool MuscleParametricModel::simulate(
    std::size_t index, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& theta,
    Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& output) const {
  const MotionSegment& segment = segments_[index];
  const StateLayout& layout = system_->layout();
  const std::size_t muscles = system_->muscles().size();
  std::vector<MusculotendonParameters<Scalar>> parameters;
  for (std::size_t m = 0; m < muscles; ++m) {
    parameters.push_back(system_->muscles().settings(m).musculotendon.template cast<Scalar>());
  }
  for (std::size_t i = 0; i < names_.size(); ++i) {
    field_of(parameters[static_cast<std::size_t>(names_[i].muscle)], names_[i].field) =
        theta(static_cast<Eigen::Index>(i));
  }
  SystemEvaluator<Scalar> evaluator(*system_, system_->muscles().template with<Scalar>(parameters));
  std::vector<Scalar> held(system_->coordinates());
  for (std::size_t c = 0; c < held.size(); ++c) held[c] = Scalar(segment.start.q(static_cast<Eigen::Index>(c)));
  evaluator.hold(held.data());

  DriveState signals(segment.drive, muscles, system_->coordinates());
  std::vector<Scalar> x(layout.size);
  for (std::size_t i = 0; i < 2 * layout.free; ++i) x[i] = theta(static_cast<Eigen::Index>(names_.size() + i));
  signals.begin_piece(segment.time.front());
  evaluator.set_motion(x.data(), x.data() + layout.free);
  const std::span<const double> u = signals.at(segment.time.front()).excitation;
  std::vector<Scalar> activation(muscles);
  for (std::size_t m = 0; m < muscles; ++m) {
    activation[m] =
        Scalar(segment.start.activation.size() > 0 ? segment.start.activation(static_cast<Eigen::Index>(m)) : u[m]);
  }
  evaluator.start_muscles(activation.data(), x.data());

  numerics::DormandPrince<Scalar> stepper(layout.size);
  // Where a curve has a corner (Thelen's force-velocity at rest) derivatives jump: no step is fine enough for less.
  constexpr double kLeast = 1e-6;
  const numerics::StepControl control{.tolerance = accuracy_,
                                      .derivative_tolerance = std::max(10.0 * accuracy_, kLeast),
                                      .smallest_step = 1e-12,
                                      .max_steps = 200000};
  double t = segment.time.front();
  Eigen::Index row = 0;
  const auto write = [&](const Scalar* state) {
    for (std::size_t i = 0; i < layout.free; ++i) output(row, static_cast<Eigen::Index>(i)) = state[i];
    ++row;
  };
  write(x.data());
  std::vector<Scalar> between(layout.size);
  const numerics::IntegrationEnd end =
      integrate_driven(evaluator, system_->scales(), signals, stepper, t, x.data(), segment.time.back(), control,
                       [&](double, double to) {
                         while (row < output.rows() && segment.time[static_cast<std::size_t>(row)] <= to) {
                           stepper.interpolate(segment.time[static_cast<std::size_t>(row)], between.data());
                           write(between.data());
                         }
                         return true;
                       });
  return end == numerics::IntegrationEnd::kReached && row == output.rows();
}

template bool MuscleParametricModel::simulate<double>(std::size_t, const Eigen::VectorXd&,
                                                      estimation::RowMatrix&) const;
template bool MuscleParametricModel::simulate<SimulationJet>(
    std::size_t, const Eigen::Matrix<SimulationJet, Eigen::Dynamic, 1>&,
    Eigen::Matrix<SimulationJet, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>&) const;

}  // namespace veridyn::muscle
