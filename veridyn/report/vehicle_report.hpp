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

/// A linear bicycle as a line of a figure.
struct NamedBicycle {
  std::string name;
  vehicle::LinearBicycle<double> bicycle;
  Role role = Role::kEstimate;
};
/// Gain and phase of yaw rate, lateral acceleration and sideslip to steer, one line per vehicle.
[[nodiscard]] std::vector<Block> frequency_response_figures(std::span<const NamedBicycle> bicycles);

}  // namespace veridyn::report
