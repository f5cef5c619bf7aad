#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "veridyn/numerics/linear_systems/transfer_function.hpp"

namespace veridyn::cueing {

/// The smallest motion that a person notices.
struct MotionThresholds {
  std::array<double, 3> rate;   ///< roll, pitch, yaw [rad/s]
  std::array<double, 3> force;  ///< specific force along x, y, z [m/s^2]
};
/// 2, 2, 1.6 deg/s; 0.17, 0.17, 0.28 m/s^2.
[[nodiscard]] MotionThresholds usual_thresholds();
/// Of rates those of Reid & Nahon 1985 (UTIAS 296): 3.0, 3.6, 2.6 deg/s.
[[nodiscard]] MotionThresholds reid_nahon_thresholds();

/// How the organs of balance turn motion into what is felt: semicircular canals sense angular rate, otoliths specific
/// force f = a - g. Axes are those of the head; the models have the same otoliths on all three.
struct VestibularModel {
  std::string name;
  std::array<numerics::TransferFunction, 3> canals;  ///< roll, pitch, yaw: felt rate over rate
  numerics::TransferFunction otoliths;               ///< felt specific force over specific force
  std::string felt_rate_unit, felt_force_unit;       ///< over rad/s and m/s^2: "1", or of a nerve's firing rate
  std::string source;
};

/// Canals T_L T_a s^2 / ((1 + T_L s)(1 + T_s s)(1 + T_a s)), T_s 0.1 s (endolymph), T_a 30 s (adaptation), the long
/// time constant T_L [s] that of the axis.
[[nodiscard]] numerics::TransferFunction torsion_pendulum(double long_time_constant);

/// A model by name: "young_meiry" (canals as `torsion_pendulum` with 6.1, 5.3, 10.2 s; the default of all that asks),
/// "telban_cardullo", "telban_cardullo_lead" (with the canals' lead term), "hosman" (otoliths; canals as
/// "young_meiry"), "ormsby". @throws InputError with the nearest name.
[[nodiscard]] const VestibularModel& vestibular_model(std::string_view name);
/// All of them.
[[nodiscard]] std::span<const VestibularModel> vestibular_models();

}  // namespace veridyn::cueing
