#include "veridyn/live/platform/rig_state.hpp"

#include <gtest/gtest.h>

#include <string>

namespace veridyn::live {
namespace {

// A row a state, a column an event in the order of RigEvent: what follows, "." where nothing changes.
constexpr std::array<std::string_view, kRigStates> kExpected = {"s......x.",   // parked
                                                                ".rh...fx.",   // soft start
                                                                "..h...fx.",   // running
                                                                "...sf.fx.",   // hold
                                                                ".....p.x.",   // fade
                                                                "........f"};  // stopped

RigState state_of(char letter, RigState otherwise) {
  switch (letter) {
    case 'p':
      return RigState::kParked;
    case 's':
      return RigState::kSoftStart;
    case 'r':
      return RigState::kRunning;
    case 'h':
      return RigState::kHold;
    case 'f':
      return RigState::kFade;
    case 'x':
      return RigState::kStopped;
    default:
      return otherwise;
  }
}

TEST(RigState, OfEveryPairOfStateAndEventIsAsTheTableSays) {
  for (std::size_t s = 0; s < kRigStates; ++s) {
    for (std::size_t e = 0; e < kRigEvents; ++e) {
      const auto state = static_cast<RigState>(s);
      const auto event = static_cast<RigEvent>(e);
      EXPECT_EQ(after(state, event), state_of(kExpected[s][e], state)) << name_of(state) << ", " << name_of(event);
    }
  }
}

TEST(RigState, NoPairIsInTheTableTwice) {
  const auto& table = rig_transitions();
  for (std::size_t i = 0; i < table.size(); ++i) {
    for (std::size_t k = i + 1; k < table.size(); ++k)
      EXPECT_FALSE(table[i].from == table[k].from && table[i].event == table[k].event) << i << " " << k;
  }
}

TEST(RigState, AnEmergencyStopIsLatchedUntilItIsReleased) {
  for (std::size_t s = 0; s < kRigStates; ++s)
    EXPECT_EQ(after(static_cast<RigState>(s), RigEvent::kEmergency), RigState::kStopped);
  for (std::size_t e = 0; e < kRigEvents; ++e) {
    const auto event = static_cast<RigEvent>(e);
    EXPECT_EQ(after(RigState::kStopped, event), event == RigEvent::kRelease ? RigState::kFade : RigState::kStopped);
  }
}

}  // namespace
}  // namespace veridyn::live
