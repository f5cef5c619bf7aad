#include "veridyn/live/platform/rig_state.hpp"

namespace veridyn::live {

std::string_view name_of(RigState state) {
  constexpr PerRigState<std::string_view> kNames = {{"parked", "soft start", "running", "hold", "fade", "stopped"}};
  return kNames[state];
}

std::string_view name_of(RigEvent event) {
  constexpr EnumArray<RigEvent, std::string_view, kRigEvents> kNames = {
      {"start", "started", "lost", "back", "held long", "faded", "park", "emergency", "release"}};
  return kNames[event];
}

const std::array<RigTransition, 16>& rig_transitions() {
  using S = RigState;
  using E = RigEvent;
  static constexpr std::array<RigTransition, 16> kTable = {{
      {S::kParked, E::kStart, S::kSoftStart},
      {S::kParked, E::kEmergency, S::kStopped},
      {S::kSoftStart, E::kStarted, S::kRunning},
      {S::kSoftStart, E::kLost, S::kHold},
      {S::kSoftStart, E::kPark, S::kFade},
      {S::kSoftStart, E::kEmergency, S::kStopped},
      {S::kRunning, E::kLost, S::kHold},
      {S::kRunning, E::kPark, S::kFade},
      {S::kRunning, E::kEmergency, S::kStopped},
      {S::kHold, E::kBack, S::kSoftStart},  // from the share of the motion that is left
      {S::kHold, E::kHeldLong, S::kFade},
      {S::kHold, E::kPark, S::kFade},
      {S::kHold, E::kEmergency, S::kStopped},
      {S::kFade, E::kFaded, S::kParked},
      {S::kFade, E::kEmergency, S::kStopped},
      {S::kStopped, E::kRelease, S::kFade},
  }};
  return kTable;
}

RigState after(RigState state, RigEvent event) {
  for (const RigTransition& t : rig_transitions()) {
    if (t.from == state && t.event == event) return t.to;
  }
  return state;
}

}  // namespace veridyn::live
