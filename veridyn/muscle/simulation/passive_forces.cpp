#include "veridyn/muscle/simulation/passive_forces.hpp"

namespace veridyn::muscle {
namespace {

/// The model with its passive paths in the place of its muscles.
Model with_passive_paths(Model model) {
  model.muscles.clear();
  for (const PassivePath& path : model.passive_paths) {
    Muscle along;
    along.parameters.name = path.name;
    along.points = path.points;
    along.wraps = path.wraps;
    model.muscles.push_back(std::move(along));
  }
  return model;
}

}  // namespace

PassiveForces::PassiveForces(const Model& model, const Mechanism& mechanism) : bodies_(model.body_forces) {
  for (const PassivePath& path : model.passive_paths) laws_.push_back(path.law);
  if (!laws_.empty()) paths_ = std::make_shared<const MusclePaths>(with_passive_paths(model), mechanism);
}

}  // namespace veridyn::muscle
