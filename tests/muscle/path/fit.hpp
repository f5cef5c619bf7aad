#pragma once

#include <utility>

#include "veridyn/muscle/path/path_fit.hpp"

namespace veridyn::muscle::test {

/// A model with its exact paths and those that are fitted to them.
struct Fit {
  explicit Fit(Model m, const PathFitOptions& options = {})
      : model(std::move(m)), mechanism(model), exact(model, mechanism), fitted(model, mechanism, exact, options) {}
  Model model;
  Mechanism mechanism;
  MusclePaths exact;
  FittedPaths fitted;
};

}  // namespace veridyn::muscle::test
