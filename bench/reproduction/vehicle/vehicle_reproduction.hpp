#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "veridyn/core/check_outcome.hpp"
#include "veridyn/vehicle/scale_study.hpp"

namespace veridyn::vehicle {

/// A printed number and ours.
struct PublishedNumber {
  std::string run;       ///< "prototype" or "exact twin", each in its size
  std::string quantity;  ///< "yaw_rate", "lateral_force_fl", "radius"
  double time = 0.0;     ///< on the prototype's clock [s]
  std::string printed;   ///< "34.9515 deg/s"
  std::string unit;      ///< as printed
  double published = 0.0;
  double ours = 0.0;       ///< in that unit
  double tolerance = 0.0;  ///< half a unit of the last printed digit
  /// Within half a unit of the last printed digit.
  [[nodiscard]] bool passed() const { return std::abs(ours - published) <= tolerance; }
};

/// A published result compared with ours: one row of `veridyn reproduce vehicle`, described by one study
/// (examples/reproduce/vehicle): that of `veridyn scale`, and
///
///     finding = "what was published, in words"
///     [[published]]
///     quantity = "yaw_rate"          # as in motion.csv; "radius": speed over yaw rate
///     time = 10                      # [s]
///     value = "34.9515 deg/s"        # must be met to its last printed digit
///     run = "prototype"              # or "exact twin"
///     [expect]                       # what must come out; every key is optional
///     mismatch = { C_f = 4.2, I_x = -0.4 }  # of the given model's groups [%], to the printed digit; nothing else
///                                    # above 0.1 %
///     gravity = 400                  # of the gravity group [%], to the printed digit
///     twin_within = 1e-9             # largest difference of the exact twin (under the gravity that makes it exact),
///                                    # as a share of the prototype's largest value, every quantity
struct VehicleReproduction {
  std::string title;
  std::string finding;
  ScaleStudy study;
  ScaleAnalysis analysis;
  std::vector<PublishedNumber> numbers;
  std::vector<CheckOutcome> checks;

  /// All checks.
  [[nodiscard]] bool passed() const;
};

/// Reads the study, drives, compares. @throws InputError naming file, line and key.
[[nodiscard]] VehicleReproduction reproduce_vehicle(const StudyTable& root, Progress& progress);

}  // namespace veridyn::vehicle
