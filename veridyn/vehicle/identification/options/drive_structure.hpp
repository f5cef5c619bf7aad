#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "veridyn/core/enum_array.hpp"

namespace veridyn::vehicle {

/// What the identified model has.
enum class DriveStructure : std::size_t {
  kBicycle,      ///< lateral velocity and yaw rate
  kScaledAccel,  ///< the same, and an accelerometer whose scale is wrong: what roll must be distinguishable from
  kRoll,         ///< and the body's roll on its springs
  kRelaxation,   ///< and tyres whose slip follows after a relaxation length
  /// And tyres whose stiffness falls with their force (Fiala), with the load that moves from one wheel to the other;
  /// relaxation length 0: slip at once
  kSaturation,
  /// The same with the reduced Magic Formula, whose stiffness falls later and more, and with what an axle loses by the
  /// load that moves
  kMagicFormula
};
/// How many there are.
inline constexpr std::size_t kDriveStructures = 6;
/// Their names in studies and results, in the order of the enum.
inline constexpr EnumArray<DriveStructure, std::string_view, kDriveStructures> kDriveStructureNames{
    "bicycle",
    "bicycle, accel_y scaled",
    "roll",
    "roll and relaxation",
    "roll, relaxation and saturation",
    "roll, relaxation and Magic Formula"};
/// As study files and estimates name it.
[[nodiscard]] constexpr std::string_view to_string(DriveStructure structure) { return kDriveStructureNames[structure]; }

/// What road, air and pedals of a racing car add to any structure, where the recording can tell.
enum class DriveEffect : std::size_t {
  kBank,       ///< a road that leans sideways, by an angle for each segment
  kDownforce,  ///< axles whose forces grow with the square of the speed
  kPedals      ///< and with the load that braking and driving move from one to the other
};
/// How many there are.
inline constexpr std::size_t kDriveEffectCount = 3;
/// All of them, in the order in which they are tried.
inline constexpr auto kAllDriveEffects = enumerators<DriveEffect, kDriveEffectCount>();
/// Which of them a model has.
using DriveEffects = EnumArray<DriveEffect, bool, kDriveEffectCount>;
/// Their names in studies and results, in the order of the enum.
inline constexpr EnumArray<DriveEffect, std::string_view, kDriveEffectCount> kDriveEffectNames{
    "banked road", "downforce", "load moved by pedals"};
/// A structure with what is added to it: "roll, banked road".
[[nodiscard]] std::string name_of(DriveStructure structure, const DriveEffects& effects);

/// Whether its body rolls.
[[nodiscard]] constexpr bool has_roll(DriveStructure structure) { return structure >= DriveStructure::kRoll; }
/// Whether the slip of its tyres may lag.
[[nodiscard]] constexpr bool has_relaxation(DriveStructure structure) {
  return structure >= DriveStructure::kRelaxation;
}

/// Whether its tyres have a friction limit.
[[nodiscard]] constexpr bool saturates(DriveStructure structure) { return structure >= DriveStructure::kSaturation; }

}  // namespace veridyn::vehicle
