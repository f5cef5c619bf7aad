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
    along.function = path.function;
    model.muscles.push_back(std::move(along));
  }
  return model;
}

}  // namespace

PassiveForces::PassiveForces(const Model& model, const Mechanism& mechanism)
    : bodies_(model.body_forces), expressions_(model.expression_forces) {
  for (const PassivePath& path : model.passive_paths) laws_.push_back(path.law);
  if (!laws_.empty()) paths_ = std::make_shared<const MusclePaths>(with_passive_paths(model), mechanism);
}

void PassiveForces::add_to_links(const Mechanism& mechanism, const Kinematics<double>& kinematics, const double* q,
                                 const double* qdot, std::span<SpatialVector<double>> by_link) const {
  if (!bodies_.empty()) add_body_forces(bodies_, mechanism, kinematics, by_link.data());
  if (!expressions_.empty()) {
    const ExpressionForces own = expressions_;
    add_body_expressions(own, mechanism, kinematics, by_link.data());
  }
  if (!paths_) return;
  PathWorkspace<double> lengths(*paths_), pulling(*paths_);
  paths_->evaluate(kinematics, q, lengths);
  std::vector<double> speed(laws_.size());
  paths_->speeds(lengths, qdot, speed.data());
  for (std::size_t m = 0; m < laws_.size(); ++m)  // nothing of paths by functions, which pull at no place
    paths_->add_tension(kinematics, q, static_cast<int>(m), passive_tension(laws_[m], lengths.length[m], speed[m]),
                        pulling, by_link);
}

}  // namespace veridyn::muscle
