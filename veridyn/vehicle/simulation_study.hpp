#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"
#include "veridyn/vehicle/model/bicycle_analysis.hpp"
#include "veridyn/vehicle/model/four_wheel_analysis.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"
#include "veridyn/vehicle/road/road.hpp"
#include "veridyn/vehicle/simulation/drive_sensors.hpp"
#include "veridyn/vehicle/simulation/manoeuvre_metrics.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"

namespace veridyn::vehicle {

/// The models that a study can drive.
enum class VehicleModelKind {
  kLinearBicycle,  ///< bicycle, small angles
  kBicycle,        ///< bicycle, exact geometry
  kFourWheel,
};
/// The word of the study: "linear bicycle", "bicycle", "four-wheel".
[[nodiscard]] std::string_view to_string(VehicleModelKind kind);

/// From `time` on the tyres have that share of their stiffness and friction at the beginning.
struct GripChange {
  double time = 0.0;  ///< [s]
  double front = 1.0, rear = 1.0;
};

/// The keys of `[drive]` for every manoeuvre.
struct DriveKeys {
  VehicleModelKind model = VehicleModelKind::kFourWheel;
  double speed = kNaN;     ///< NaN: that of the built-in vehicle
  double duration = kNaN;  ///< NaN: that of the manoeuvre
  SimulationOptions simulation = {};
  double gravity = kGravity;
  bool longitudinal = false;
  FourWheelConvention convention = FourWheelConvention::kFirstPrinciples;
  BicycleGeometry geometry = BicycleGeometry::kExact;
  std::vector<GripChange> grip = {};
  [[nodiscard]] static const KeyTable<DriveKeys>& keys();
};

/// What a study drives: vehicle, model, manoeuvre and road, read and checked.
struct SimulationStudy {
  std::string title;
  std::uint64_t seed = 1;
  Vehicle vehicle;
  VehicleModelKind model = VehicleModelKind::kFourWheel;
  SimulationOptions simulation;
  FourWheelOptions four_wheel;  ///< gravity counts for all models
  Manoeuvre manoeuvre;
  std::vector<GripChange> grip;      ///< by time
  std::shared_ptr<const Road> road;  ///< null: flat
  std::optional<DriveSensorSet> sensors;
  std::vector<std::filesystem::path> inputs;
};

/// Reads from the root of a study:
///
///     title = "step steer at 100 km/h"
///     seed = 1
///     [subject]   see read_vehicle
///     [drive]     see DriveKeys and read_manoeuvre
///     [road]      see read_road; needs the four-wheel model
///     [sensors]   see read_drive_sensors; with it what sensors record is written too
///
/// Tables of the analysis (`[data]`, `[identify]` ...) are left to others.
/// @throws InputError with file, line and key.
/// An interrupted `progress` ends the preparation of a random steer early.
[[nodiscard]] SimulationStudy read_simulation_study(const StudyTable& root, const Progress& progress);

/// Drives a vehicle with any of the models. @throws InputError for a step too long or controls out of range.
[[nodiscard]] VehicleTrajectory simulate(const Vehicle& vehicle, VehicleModelKind model,
                                         const FourWheelOptions& options, Driver& driver, const Road* road,
                                         const SimulationOptions& simulation, Progress& progress,
                                         std::span<const GripChange> grip = {});

/// What became of a drive.
struct SimulationRun {
  VehicleTrajectory trajectory;
  std::optional<Recording> measured;  ///< what the sensors recorded
  std::vector<Metric> metrics;
  LinearBicycle<double> linear;  ///< the bicycle about straight running at the study's speed
  BicycleCharacteristics<double> characteristics;
  std::vector<Mode> modes;                   ///< of the bicycle
  std::vector<FourWheelMode> vehicle_modes;  ///< of the four-wheel model, where it was driven
  std::optional<SteadyCornering> cornering;  ///< of the same
};

/// Drives; the study's driver begins again. @throws InputError for a step too long or controls out of range.
[[nodiscard]] SimulationRun run_simulation_study(const SimulationStudy& study, Progress& progress);

}  // namespace veridyn::vehicle
