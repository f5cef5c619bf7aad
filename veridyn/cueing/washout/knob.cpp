#include "veridyn/cueing/washout/knob.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {

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

}  // namespace veridyn::cueing
