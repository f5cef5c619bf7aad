#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "veridyn/core/enum_array.hpp"

namespace veridyn::live {

/// What the rig does with its platform.
enum class RigState {
  kParked,     ///< in its neutral position, at rest
  kSoftStart,  ///< the share of the motion grows to the whole
  kRunning,
  kHold,     ///< telemetry or the platform's answers are missing: the last command stands
  kFade,     ///< on the way to park
  kStopped,  ///< emergency stop: at rest where it stopped, until it is released by hand
};
inline constexpr std::size_t kRigStates = 6;
/// A value for each state.
template <class T>
using PerRigState = EnumArray<RigState, T, kRigStates>;

enum class RigEvent {
  kStart,      ///< the operator wants motion, and telemetry and platform are ready
  kStarted,    ///< the soft start is over
  kLost,       ///< telemetry or platform are no longer ready
  kBack,       ///< they are ready again
  kHeldLong,   ///< the hold is over
  kFaded,      ///< the platform is in its neutral position and at rest
  kPark,       ///< the operator wants the platform parked
  kEmergency,  ///< from key, page, packet or signal
  kRelease,    ///< of the emergency stop, by hand
};
inline constexpr std::size_t kRigEvents = 9;

/// "parked", "soft start", ...
[[nodiscard]] std::string_view name_of(RigState state);
/// "start", "started", ...
[[nodiscard]] std::string_view name_of(RigEvent event);

/// One line of the table of transitions.
struct RigTransition {
  RigState from;
  RigEvent event;
  RigState to;
};
/// All transitions; a pair that is not in it changes nothing.
[[nodiscard]] const std::array<RigTransition, 16>& rig_transitions();
/// The state after an event.
[[nodiscard]] RigState after(RigState state, RigEvent event);

}  // namespace veridyn::live
