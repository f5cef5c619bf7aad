#include "veridyn/core/option_check.hpp"

#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace veridyn {
namespace {

TEST(OptionCheck, NamesOptionValueAndRule) {
  const OptionCheck check("change_detection");
  EXPECT_NO_THROW(check(true, "rate_Hz", -1.0, "> 0"));
  EXPECT_EQ(why([&] { check(false, "rate_Hz", -1.0, "> 0"); }), "change_detection.rate_Hz: is -1; must be > 0");
  EXPECT_EQ(why([&] { check(false, "block_s", 0.25, "at least 1"); }),
            "change_detection.block_s: is 0.25; must be at least 1");
}

}  // namespace
}  // namespace veridyn
