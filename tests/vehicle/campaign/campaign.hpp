#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/fault_campaign.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

/// One fault at a time in simulated drives: see `tests/support/fault_campaign.hpp`.
namespace veridyn::vehicle::testing {

/// One thing that is wrong with a drive: what its sensors recorded, or what is said of the vehicle.
struct DriveFault {
  std::string name;               ///< "yaw rate in deg/s"
  std::vector<std::string> rows;  ///< rows about one of these name it
  std::function<void(VehicleStudy&)> apply;
};
/// All faults of the campaign, in the order of its table.
[[nodiscard]] const std::vector<DriveFault>& drive_faults();
/// The fault of that name.
[[nodiscard]] const DriveFault& drive_fault(const std::string& name);

/// Vehicles of the campaign: "reference bicycle" (12 to 24 m/s), "reference_1to5 bicycle" (2.5 to 5.5 m/s),
/// "reference four-wheel" (20 m/s; its body rolls and its wheels are loaded unequally, which the estimated bicycle
/// does not have).
[[nodiscard]] const std::vector<std::string>& campaign_vehicles();

/// A drive of 90 s with reference sensors and positions.
[[nodiscard]] VehicleStudy campaign_drive(const std::string& vehicle, std::uint64_t seed);

/// How much is known of the roll of a body.
enum class RollKnown { kNot, kGiven };

/// A gentle drive of 90 s of a car whose body rolls and whose wheels are loaded unequally, with reference sensors: each
/// number another speed (14 to 25 m/s), steering (1 to 3 m/s^2 of lateral acceleration) and roll stiffness.
[[nodiscard]] VehicleStudy gentle_drive(std::size_t number, RollKnown roll);

/// A drive with its result.
struct IdentifiedDrive {
  bool refused = false;  ///< an InputError; `message` says which
  std::string message;
  VehicleAnalysis analysis;
  test::Confidence confidence;
};
/// Identified on one thread.
[[nodiscard]] IdentifiedDrive identified(const VehicleStudy& study);

/// The drive with a fault, against the same drive without it.
[[nodiscard]] test::Trial try_fault(const VehicleStudy& study, const IdentifiedDrive& clean, const DriveFault& fault);

}  // namespace veridyn::vehicle::testing
