#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/model/four_wheel_models.hpp"
#include "veridyn/vehicle/model/longitudinal.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// The tyres of both axles, as mounted on the left.
template <typename Tyre>
struct AxleTyres {
  Tyre front;
  Tyre rear;
};

/// The tyres of a vehicle by its numbers alone: cornering stiffnesses, friction, and where the tyre has it the static
/// load as the nominal one. The slip stiffness is 1.3 times that of cornering, as of common tyres.
template <typename Tyre>
[[nodiscard]] AxleTyres<Tyre> tyres_by_numbers(const VehicleParameters<double>& p) {
  const PerWheel<double> load = static_loads(p, kGravity);
  const auto axle = [&](double C, double nominal) {
    Tyre tyre;
    tyre.stiffness = C;
    tyre.slip_stiffness = 1.3 * C;
    tyre.mu = p.mu;
    if constexpr (requires { tyre.nominal_load; }) tyre.nominal_load = nominal;
    return tyre;
  };
  return {axle(p.C_f, load[kFrontLeft]), axle(p.C_r, load[kRearLeft])};
}

/// Tyres of any kind, both axles of the same.
using VehicleTyres = AllTyres::Variant<AxleTyres>;

/// The physical vehicle: what is measured in the workshop, and its tyres as far as known.
struct Vehicle {
  std::string name;
  std::string description;  ///< source of the numbers, in words
  VehicleParameters<double> parameters;
  VehicleTyres tyres;
  std::string tyre_text = "linear";  ///< "linear", "Magic Formula of car.tir"
  LongitudinalParameters longitudinal;
  double ackermann = 0.0;          ///< 0: front wheels steered equally, 1: Ackermann
  double camber_per_roll = 0.0;    ///< inclination of the wheels as a share of the body's roll
  double relaxation_length = 0.0;  ///< of the tyres [m]; 0: forces follow at once
  bool aligning_moment = false;    ///< whether the tyres' moments turn the vehicle
  AxleSuspension suspension_f, suspension_r;
  AerodynamicLift lift;
  std::optional<double> speed;  ///< of a built-in vehicle's published drive [m/s]
  /// Numbers that the study does not give and nothing here depends on; "track_f = 1.35 m (0.6 L)".
  std::vector<std::string> assumed;
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> inputs;  ///< files read
};

/// The four-wheel model's options that the vehicle itself decides, with its longitudinal dynamics.
[[nodiscard]] FourWheelOptions four_wheel_options(const Vehicle& vehicle);

/// The use of a vehicle decides which numbers it must have.
enum class VehicleNeeds {
  kGeometry,  ///< mass, a, b: identification finds the rest
  kBicycle,   ///< and I_z, and tyres: C_f, C_r where they are not described otherwise
  kFourWheel  ///< and all others but mu and anti-roll bars
};

/// Whether a study is of a vehicle: its `[subject]` says `kind = "vehicle"`; where it says no kind, a built-in vehicle,
/// a number that only vehicles have (`a`, `C_f`), a `[drive]`, or a steering channel in `[data.map]`.
[[nodiscard]] bool is_vehicle_study(const StudyTable& root);

/// Reads a vehicle from `[subject]`, or a table of the same keys: subject_keys.hpp.
///
/// Numbers that `needs` does not ask for are assumed where they are missing, and listed. Where more than geometry is
/// needed, parameters that their identification rejected are refused (`estimation::grades_warning`).
/// @throws InputError with file, line and key: what no vehicle can have, what is missing.
[[nodiscard]] Vehicle read_vehicle(const StudyTable& subject, VehicleNeeds needs);

/// Left and right tyres of both axles; those of the right are mirrored where sides differ.
template <typename Tyre>
[[nodiscard]] PerWheel<Tyre> mounted(const AxleTyres<Tyre>& tyres) {
  if constexpr (requires { tyres.front.on_other_side(); }) {
    return {tyres.front, tyres.front.on_other_side(), tyres.rear, tyres.rear.on_other_side()};
  } else {
    return {tyres.front, tyres.front, tyres.rear, tyres.rear};
  }
}

/// The tyres that the bicycle takes: those without shifts, as its one tyre stands for left and right.
template <typename Tyre>
[[nodiscard]] Tyre symmetric_tyre(const Tyre& tyre) {
  if constexpr (requires { tyre.symmetric(); }) {
    return tyre.symmetric();
  } else {
    return tyre;
  }
}

/// Cornering stiffnesses of one tyre at its static load, front and rear [N/rad].
[[nodiscard]] std::array<double, 2> cornering_stiffnesses(const Vehicle& vehicle, double gravity = kGravity);

/// The vehicle as the TOML of a `[subject]`, to be read again by `read_vehicle`; tyre files by their absolute path.
[[nodiscard]] std::string write_vehicle_toml(const Vehicle& vehicle);

}  // namespace veridyn::vehicle
