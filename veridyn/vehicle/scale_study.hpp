#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/vehicle/similarity/similarity.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

namespace veridyn::vehicle {

/// A study of a vehicle and its scaled model.
struct ScaleStudy {
  SimulationStudy simulation;  ///< the prototype and the drive in which both are compared
  SimilaritySubject prototype;
  ScaleRequest request;
  bool requested = true;         ///< false: only the given model is checked, the twin is of its length, mass, speed
  std::optional<Vehicle> given;  ///< a model that is built or planned
  SimilaritySubject given_subject;
  std::vector<std::string> repeating;
};

/// Reads `[subject]`, `[drive]`, `[road]` as read_simulation_study does, and
///
///     [scale]
///     length_ratio = 0.2             # any of these: see ScaleRequest; of the given model when all are left out
///     mass = "8.8 kg"
///     speed = "4 m/s"
///     froude = false                 # true: speed by the square root of the length ratio
///     repeating = ["m", "L", "u"]    # repeating variables of the groups
///     [scale.model]                  # a model to be checked: keys of [subject], and
///     speed = "4 m/s"                # its speed; a built-in vehicle has one; else that of [scale]
///     [[scale.parameter]]            # further quantities: see read_similarity_parameters
///     name = "relaxation_length"
///     value = "0.3 m"                # of the prototype
///     model = "0.06 m"               # of the given model; exactly similar when left out
///
/// `progress` as there. @throws InputError with file, line and key.
[[nodiscard]] ScaleStudy read_scale_study(const StudyTable& root, const Progress& progress);

/// How far a model's motion is from the prototype's, brought to the prototype's size.
struct MotionDifference {
  std::string quantity;  ///< as trajectory_quantities name it; "path"
  std::string unit;
  double largest = 0.0;  ///< of the differences
  double range = 0.0;    ///< largest value of the prototype's, for comparison
};

/// One of the compared drives.
struct ScaledRun {
  std::string name;
  VehicleTrajectory trajectory;  ///< in the model's size
  VehicleTrajectory rescaled;    ///< in the prototype's
  std::vector<MotionDifference> differences;
};

/// A scaled vehicle, how similar it is, and how prototype and models drive.
struct ScaleAnalysis {
  ScaledVehicle scaled;  ///< the exactly similar model
  Vehicle twin;          ///< the same as a vehicle with tyres
  SimilarityReport twin_report;
  std::optional<SimilarityReport> given_report;
  VehicleTrajectory prototype;
  /// The twin under the similar gravity (must be equal to rounding), the twin under the prototype's gravity, and the
  /// given model under it.
  std::vector<ScaledRun> runs;
  bool interrupted = false;

  /// The report on the given model, where there is one, else on the twin.
  [[nodiscard]] const SimilarityReport& judged() const;
  /// Drives that ended before the prototype's did, in sentences: "exact twin: the vehicle rolls ... (at 4.8 s)".
  [[nodiscard]] std::vector<std::string> ended_early() const;
};

/// Scales, compares and drives. @throws InputError as `compare` and `simulate` do.
[[nodiscard]] ScaleAnalysis run_scale_study(const ScaleStudy& study, Progress& progress);

/// Differences of all quantities that both have; both on the prototype's time.
[[nodiscard]] std::vector<MotionDifference> motion_differences(const VehicleTrajectory& prototype,
                                                               const VehicleTrajectory& rescaled);

/// Drives a vehicle through a study's manoeuvre, as the model of `factors` would (1, 1, 1: the size of the study).
[[nodiscard]] VehicleTrajectory simulate_scaled(const SimulationStudy& study, const Vehicle& vehicle,
                                                const ScaleFactors& factors, double gravity, Progress& progress);

}  // namespace veridyn::vehicle
