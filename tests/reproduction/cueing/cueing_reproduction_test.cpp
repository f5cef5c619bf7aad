#include "bench/reproduction/cueing/cueing_reproduction.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

CueingReproduction reproduced(const std::string& figure) {
  Progress progress;
  const Study study = Study::parse("title = \"row\"\n[[figure]]\n" + figure, "row.toml", {}, {});
  CueingReproduction r = reproduce_cueing(study.root(), progress);
  study.root().finish();
  return r;
}

TEST(CueingReproduction, PassesWhatIsMetAndNothingElse) {
  const std::string figure = "quantity = \"tilt_wanted\"\nat = 1\nwithin = \"0.1 deg\"\nvalue = ";
  const CueingReproduction right = reproduced(figure + "\"5.9 deg\"\n");
  ASSERT_EQ(right.figures.size(), 1U);
  EXPECT_TRUE(right.passed());
  EXPECT_EQ(right.figures[0].unit, "deg");
  EXPECT_NEAR(right.figures[0].ours, 5.8527, 1e-4);
  EXPECT_EQ(right.figures[0].quantity, "tilt that stands for 1 m/s^2");
  EXPECT_FALSE(reproduced(figure + "\"5.7 deg\"\n").passed());
}

TEST(CueingReproduction, NamesWhatIsWrongInAStudy) {
  const auto refusal = [](const std::string& figure) {
    try {
      static_cast<void>(reproduced(figure));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal("quantity = \"tilt_wantd\"\nat = 1\nvalue = 1\nwithin = 1\n"),
              testing::HasSubstr("row.toml:3: figure[0].quantity: there is none called 'tilt_wantd' (did you mean"));
  EXPECT_THAT(refusal("quantity = \"tilt_wanted\"\nat = 1\nvalue = \"1 kg\"\nwithin = 1\n"),
              testing::HasSubstr("'kg'"));
  EXPECT_THAT(refusal("quantity = \"tilt_wanted\"\nat = 1\nvalue = 1\nwithin = 0\n"), testing::HasSubstr("within"));
}

}  // namespace
}  // namespace veridyn::cueing
