#pragma once

#include <algorithm>
#include <vector>

#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"

namespace veridyn::aircraft {

/// A check of the recording, and which coefficients rest on what it checked.
struct FlightEvidence {
  estimation::Evidence row;
  std::vector<Coefficient> affects = {};  ///< empty: all

  [[nodiscard]] bool bears_on(Coefficient c) const {
    return affects.empty() || std::ranges::find(affects, c) != affects.end();
  }
};

}  // namespace veridyn::aircraft
