#pragma once

#include <string>

#include "veridyn/report/document/document.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

namespace veridyn::report {

/// The report of `veridyn simulate` of a vehicle: path, time histories, g-g diagram, metrics of the manoeuvre, and the
/// linear analysis at the drive's speed with frequency responses.
[[nodiscard]] Document vehicle_report(const vehicle::SimulationStudy& study, const vehicle::SimulationRun& run,
                                      const std::string& program);

/// The numbers of a vehicle as a table, with what was assumed.
[[nodiscard]] Table vehicle_table(const vehicle::VehicleParameters<double>& parameters);

/// Gain and phase of yaw rate, lateral acceleration and sideslip to steer, one line a vehicle.
struct NamedBicycle {
  std::string name;
  vehicle::LinearBicycle<double> bicycle;
  Role role = Role::kEstimate;
};
[[nodiscard]] std::vector<Block> frequency_response_figures(std::span<const NamedBicycle> bicycles);

/// A number in the unit that people read: angles in deg, understeer gradients in deg/g, and what its name calls a
/// frequency or bandwidth in Hz.
struct ReadableNumber {
  double value = 0.0;
  std::string unit;
};
[[nodiscard]] ReadableNumber readable(double value, const std::string& unit, std::string_view name = {});

}  // namespace veridyn::report
