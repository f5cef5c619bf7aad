#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "veridyn/aircraft/identification/budget/sensor_error.hpp"
#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"

namespace veridyn::aircraft {

/// The place of a coefficient among the groups of an analysis.
[[nodiscard]] constexpr std::size_t place_of(Coefficient c) { return static_cast<std::size_t>(c); }
/// What rests on the alpha vane, and on what moves the aircraft longitudinally.
inline constexpr estimation::Groups kByAlpha =
    estimation::Groups::of({place_of(Coefficient::kCL), place_of(Coefficient::kCD), place_of(Coefficient::kCm)});
/// What rests on the beta vane, and on what moves the aircraft laterally.
inline constexpr estimation::Groups kByBeta =
    estimation::Groups::of({place_of(Coefficient::kCY), place_of(Coefficient::kCl), place_of(Coefficient::kCn)});
/// Nothing.
inline constexpr estimation::Groups kByNothing = estimation::Groups();

/// Whether a coefficient rests on what was checked.
[[nodiscard]] inline bool affects(const estimation::Evidence& row, Coefficient c) {
  return row.affects.contains(place_of(c));
}

/// What the checks of a flight's recording found, and what they measured of the errors of its sensors.
struct CheckedFlight {
  std::vector<estimation::Evidence> rows;
  std::vector<SensorError> errors;  ///< independent of each other

  void add(estimation::Evidence row) { rows.push_back(std::move(row)); }
  void add(CheckedFlight more) {
    for (estimation::Evidence& row : more.rows) rows.push_back(std::move(row));
    errors.insert(errors.end(), more.errors.begin(), more.errors.end());
  }
};

}  // namespace veridyn::aircraft
