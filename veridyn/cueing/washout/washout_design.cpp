#include "veridyn/cueing/washout/washout_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/cueing/washout/adaptive_washout.hpp"
#include "veridyn/cueing/washout/classical_washout.hpp"
#include "veridyn/cueing/washout/fuzzy_washout.hpp"
#include "veridyn/cueing/washout/moving_origin_washout.hpp"
#include "veridyn/cueing/washout/optimal_washout.hpp"
#include "veridyn/cueing/washout/predictive_washout.hpp"
#include "veridyn/cueing/washout/return_washout.hpp"
#include "veridyn/cueing/washout/three_axis_washout.hpp"
#include "veridyn/cueing/washout/tilt_washout.hpp"

namespace veridyn::cueing {
namespace {

template <typename Design>
std::unique_ptr<WashoutDesign> design() {
  return std::make_unique<Design>();
}

/// A new algorithm is a line here.
constexpr std::array kAlgorithms = {
    WashoutAlgorithm{"tilt", "tilt coordination alone", &design<TiltDesign>},
    WashoutAlgorithm{"classical", "filters and tilt coordination (Reid & Nahon 1985)", &design<ClassicalDesign>},
    WashoutAlgorithm{"three_axis", "the same where tilt renders the onset too", &design<ThreeAxisDesign>},
    WashoutAlgorithm{"return", "tilt without a low-pass, and a return to neutral (You et al. 2005)",
                     &design<ReturnDesign>},
    WashoutAlgorithm{"optimal", "least perceived error of a linear rider (Sivan 1982)", &design<OptimalDesign>},
    WashoutAlgorithm{"adaptive", "gains by steepest descent (Nahon & Reid 1990)", &design<AdaptiveDesign>},
    WashoutAlgorithm{"fuzzy", "gains by the room that is left (Hwang et al. 2009)", &design<FuzzyDesign>},
    WashoutAlgorithm{"moving_origin", "the neutral place makes room for what is foreseen", &design<MovingOriginDesign>},
    WashoutAlgorithm{"mpc", "plans ahead within the platform's limits (Dagdelen et al. 2009)",
                     &design<PredictiveDesign>},
};

}  // namespace

void read_knobs(const StudyTable& table, std::span<const Knob> knobs) {
  for (const Knob& knob : knobs) {
    if (!table.has(knob.name)) continue;
    const std::vector<double> given = table.numbers(knob.name, knob.unit);
    if (given.size() != knob.values.size())
      table.fail(knob.name, fmt::format("takes {} value{}, has {}", knob.values.size(),
                                        knob.values.size() == 1 ? "" : "s", given.size()));
    for (const double v : given) {
      if (!(v > 0.0 || (knob.zero && v == 0.0)))
        table.fail(knob.name, fmt::format("is {}; must be {} 0", v, knob.zero ? "at least" : "above"));
    }
    std::copy(given.begin(), given.end(), knob.values.begin());
  }
}

void check_knobs(std::span<const Knob> knobs) {
  for (const Knob& knob : knobs) {
    for (const double v : knob.values) {
      if (!std::isfinite(v) || !(v > 0.0 || (knob.zero && v == 0.0)))
        throw InputError(fmt::format("washout.{}", knob.name),
                         fmt::format("is {}; must be {} 0", v, knob.zero ? "at least" : "above"));
    }
  }
}

std::span<const WashoutAlgorithm> washout_algorithms() { return kAlgorithms; }

const WashoutAlgorithm& washout_algorithm(std::string_view name) {
  std::vector<std::string> names;
  for (const WashoutAlgorithm& a : kAlgorithms) {
    if (a.name == name) return a;
    names.emplace_back(a.name);
  }
  throw InputError("washout", fmt::format("there is no algorithm '{}'{}", name, suggestion(name, names)));
}

}  // namespace veridyn::cueing
