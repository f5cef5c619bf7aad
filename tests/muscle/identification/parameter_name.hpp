#pragma once

#include <string>
#include <string_view>

#include "veridyn/muscle/identification/muscle_unknowns.hpp"

namespace veridyn::muscle::test {

/// The parameter that "MUSCLE.field" names.
inline MuscleParameterName parameter_named(const Model& model, std::string_view name) {
  const std::size_t dot = name.find('.');
  const MuscleUnknownSpec spec{.muscles = {std::string(name.substr(0, dot))},
                               .fields = {std::string(name.substr(dot + 1))}};
  return make_unknown(model, spec, "test").parameters.front();
}

}  // namespace veridyn::muscle::test
