#include "veridyn/muscle/identification/muscle_parametric_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/muscle/identification/muscle_simulation.hpp"

namespace veridyn::muscle {
namespace {

std::vector<MuscleUnknown> unknowns_of(const Model& model, const std::vector<MuscleParameterName>& names) {
  std::vector<MuscleUnknown> unknowns;
  for (const MuscleParameterName& name : names) unknowns.push_back(unknown_of(model, name));
  return unknowns;
}

}  // namespace

MuscleParametricModel::MuscleParametricModel(const MusculoskeletalSystem& system,
                                             const std::vector<MuscleParameterName>& names,
                                             std::vector<MotionSegment> segments, double accuracy, bool estimate_start)
    : MuscleParametricModel(system, unknowns_of(system.model(), names), std::move(segments),
                            {.accuracy = accuracy, .estimate_start = estimate_start}) {}

MuscleParametricModel::MuscleParametricModel(const MusculoskeletalSystem& system, std::vector<MuscleUnknown> unknowns,
                                             std::vector<MotionSegment> segments, const MuscleModelOptions& options)
    : system_(&system), unknowns_(std::move(unknowns)), segments_(std::move(segments)), accuracy_(options.accuracy) {
  check_unknowns(system.model(), unknowns_, system.model().name);
  check_systems();
  parameters_ = model_parameters(unknowns_);
  list_outputs(options.outputs);
  list_initial_conditions(options.estimate_start);
}

std::string MuscleParametricModel::segment_name(std::size_t segment) const {
  const std::string& name = segments_[segment].name;
  return name.empty() ? ParametricModel::segment_name(segment) : name;
}

void MuscleParametricModel::check_systems() const {
  const Model& own = system_->model();
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    const Model& other = system_of(s).model();
    const std::string place = fmt::format("system of {}", segment_name(s));
    if (other.muscles.size() != own.muscles.size())
      throw InputError(place, fmt::format("has {} muscles, the model '{}' has {}", other.muscles.size(), own.name,
                                          own.muscles.size()));
    for (std::size_t m = 0; m < own.muscles.size(); ++m) {
      if (other.muscles[m].name() != own.muscles[m].name())
        throw InputError(place, fmt::format("muscle {} is '{}' where the model '{}' has '{}'", m + 1,
                                            other.muscles[m].name(), own.name, own.muscles[m].name()));
    }
    if (other.coordinates.size() != own.coordinates.size())
      throw InputError(place, fmt::format("has {} coordinates, the model '{}' has {}", other.coordinates.size(),
                                          own.name, own.coordinates.size()));
    for (std::size_t c = 0; c < own.coordinates.size(); ++c) {
      if (other.coordinates[c].name != own.coordinates[c].name)
        throw InputError(place, fmt::format("coordinate {} is '{}' where the model '{}' has '{}'", c + 1,
                                            other.coordinates[c].name, own.name, own.coordinates[c].name));
    }
    if (system_of(s).path_source() == PathSource::kAsOpenSim)
      throw InputError(place, "has paths as OpenSim's, which have no derivatives; take exact or fitted ones");
  }
}

void MuscleParametricModel::list_outputs(const std::vector<MuscleOutput>& chosen) {
  const Model& model = system_->model();
  chosen_ = chosen;
  for (std::size_t c = 0; c < model.coordinates.size() && chosen.empty(); ++c) {
    bool free = segments_.empty() && system_->reduction().role(static_cast<int>(c)) == CoordinateRole::kFree;
    for (std::size_t s = 0; s < segments_.size(); ++s)
      free = free || system_of(s).reduction().role(static_cast<int>(c)) == CoordinateRole::kFree;
    if (free) chosen_.push_back({MuscleOutputKind::kValue, static_cast<int>(c), 0.0});
  }
  for (const MuscleOutput& output : chosen_) {
    const bool motion = output.kind == MuscleOutputKind::kValue || output.kind == MuscleOutputKind::kSpeed;
    for (std::size_t s = 0; s < segments_.size() && motion; ++s) {
      if (system_of(s).reduction().role(output.index) == CoordinateRole::kCoupled)
        throw InputError(model.name, fmt::format("output '{}' follows another coordinate; take that one",
                                                 output_name(model, output)));
    }
  }
  for (const MuscleOutput& output : chosen_)
    outputs_.push_back({output_name(model, output), output_unit(model, output)});
}

void MuscleParametricModel::list_initial_conditions(bool estimate) {
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    std::vector<estimation::ModelParameter> initial;
    for (const bool speed : {false, true}) {
      for (const int c : system_of(s).reduction().free()) {
        const Coordinate& coordinate = system_->model().coordinates[c];
        initial.push_back({.name = coordinate.name + (speed ? ".start_speed" : ".start"),
                           .unit = coordinate.unit() + (speed ? "/s" : ""),
                           .start = speed ? segments_[s].start.qdot(c) : segments_[s].start.q(c),
                           .fixed = !estimate});
      }
    }
    initial_.push_back(std::move(initial));
  }
}

Eigen::VectorXd MuscleParametricModel::output_noise() const {
  Eigen::VectorXd noise(chosen_.size());
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    if (!(chosen_[i].noise_sd > 0.0)) return {};
    noise(i) = chosen_[i].noise_sd;
  }
  return noise;
}

bool MuscleParametricModel::respond(std::size_t segment, const Eigen::VectorXd& theta,
                                    std::span<const Eigen::Index> active, estimation::ModelResponse& response) const {
  const auto outputs = signed_index(chosen_.size());
  response.output.resize(samples(segment), outputs);
  response.sensitivity.resize(samples(segment) * outputs, active.size());
  const internal::MuscleTask task{&system_of(segment), &segments_[segment], unknowns_, chosen_, accuracy_};
  const bool usable = active.empty() ? internal::simulate_values(task, theta, response)
                                     : internal::simulate_tangents(task, theta, active, response);
  return usable && response.output.allFinite() && response.sensitivity.allFinite();
}

std::string MuscleParametricModel::trouble(std::size_t segment, const Eigen::VectorXd& theta) const {
  Eigen::VectorXd all(parameters_.size() + initial_[segment].size());
  all.head(parameters_.size()) = theta.head(parameters_.size());
  for (std::size_t i = 0; i < initial_[segment].size(); ++i) all(parameters_.size() + i) = initial_[segment][i].start;
  estimation::ModelResponse response;
  response.output.resize(samples(segment), chosen_.size());
  const internal::MuscleTask task{&system_of(segment), &segments_[segment], unknowns_, chosen_, accuracy_};
  std::string why;
  return internal::simulate_values(task, all, response, &why) ? std::string() : why;
}

}  // namespace veridyn::muscle
