#include "veridyn/core/at_place.hpp"

#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace veridyn {
namespace {

TEST(AtPlace, GivesWhatTheWorkReturns) {
  EXPECT_EQ(at_place("study.toml:3: drive", [] { return 7; }), 7);
}

TEST(AtPlace, MovesARefusalToWhereTheUserWroteTheOption) {
  const auto refuse = [] { throw InputError("drive", "step is 0 s; must be > 0"); };
  EXPECT_EQ(why([&] { at_place("study.toml:3: drive", refuse); }), "study.toml:3: drive: step is 0 s; must be > 0");
}

TEST(AtPlace, LeavesOtherErrorsAsTheyAre) {
  EXPECT_THROW(at_place("here", [] { throw std::runtime_error("the disk is full"); }), std::runtime_error);
}

}  // namespace
}  // namespace veridyn
