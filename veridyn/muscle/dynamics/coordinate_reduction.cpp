#include "veridyn/muscle/dynamics/coordinate_reduction.hpp"

#include <fmt/format.h>

#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::muscle {
CoordinateReduction::CoordinateReduction(const Model& model, std::span<const int> prescribed)
    : roles_(model.coordinates.size(), CoordinateRole::kFree),
      free_root_(model.coordinates.size(), -1),
      follows_driven_(model.coordinates.size(), 0) {
  const auto place = [&model](int c) { return fmt::format("coordinate '{}'", model.coordinates[c].name); };
  for (std::size_t c = 0; c < roles_.size(); ++c) {
    if (model.coordinates[c].locked) roles_[c] = CoordinateRole::kDriven;
  }
  for (const int c : prescribed) roles_[c] = CoordinateRole::kDriven;

  std::vector<const CoordinateCoupler*> setter(roles_.size(), nullptr);
  for (const CoordinateCoupler& coupler : model.couplers) {
    const int c = coupler.dependent;
    if (const CoordinateCoupler* other = setter[c]; other != nullptr) {
      throw InputError(place(c), fmt::format("couplers '{}' and '{}' both set it", other->name, coupler.name));
    }
    if (roles_[c] == CoordinateRole::kDriven) {
      throw InputError(place(c), fmt::format("it is {} and coupler '{}' sets it too: remove one of them",
                                             model.coordinates[c].locked ? "locked" : "prescribed", coupler.name));
    }
    setter[c] = &coupler;
  }
  for (std::size_t c = 0; c < roles_.size(); ++c) {
    if (setter[c] != nullptr) roles_[c] = CoordinateRole::kCoupled;
  }
  for (std::size_t c = 0; c < roles_.size(); ++c) {
    if (roles_[c] == CoordinateRole::kFree) {
      free_root_[c] = static_cast<int>(free_.size());
      free_.push_back(static_cast<int>(c));
    } else if (roles_[c] == CoordinateRole::kDriven) {
      follows_driven_[c] = 1;
      driven_.push_back(static_cast<int>(c));
      defaults_.push_back(model.coordinates[c].default_value);
    }
  }
  // Couplers whose independent coordinate is known already, until none is left.
  std::vector<bool> known(roles_.size());
  for (std::size_t c = 0; c < roles_.size(); ++c) known[c] = setter[c] == nullptr;
  for (std::size_t left = model.couplers.size(); left > 0;) {
    const std::size_t before = left;
    for (const CoordinateCoupler& coupler : model.couplers) {
      const std::size_t from = at(coupler.independent), to = at(coupler.dependent);
      if (known[to] || !known[from]) continue;
      known[to] = true;
      --left;
      free_root_[to] = free_root_[from];
      follows_driven_[to] = follows_driven_[from];
      if (free_root_[to] >= 0) free_are_uncoupled_ = false;
      couplers_.push_back({coupler.independent, coupler.dependent, coupler.function});
    }
    if (left < before) continue;
    // Backwards from any coordinate that is left, the walk ends in the circle.
    std::size_t c = 0;
    while (known[c]) ++c;
    for (std::size_t step = 0; step < roles_.size(); ++step) c = at(setter[c]->independent);
    throw InputError(place(static_cast<int>(c)),
                     fmt::format("coupler '{}' makes it depend on itself", setter[c]->name));
  }
}

std::vector<DrivenMotion<double>> CoordinateReduction::default_motion() const {
  std::vector<DrivenMotion<double>> motion(defaults_.size());
  for (std::size_t i = 0; i < motion.size(); ++i) motion[i].value = defaults_[i];
  return motion;
}

}  // namespace veridyn::muscle
