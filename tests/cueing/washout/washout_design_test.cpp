#include "veridyn/cueing/washout/washout_design.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "tests/cueing/washout/pushed.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::cueing {
namespace {

struct TwoKnobs {
  std::array<double, 2> gains = {1.0, 1.0};  // may be zero
  double rate = 2.0;                         // may not

  [[nodiscard]] std::vector<Knob> knobs() {
    return {{"gain", "1", gains, "", true}, {"tilt_rate", "rad/s", {&rate, 1}, "", false}};
  }
};

TwoKnobs turned(const std::string& keys) {
  const Study study = Study::parse("[washout]\n" + keys, "study.toml");
  TwoKnobs two;
  read_knobs(study.root().table("washout"), two.knobs());
  return two;
}

TEST(Knobs, AreReadInTheirUnitsAndStayWhereNothingIsSaid) {
  const TwoKnobs two = turned("gain = [0, 0.5]\ntilt_rate = [\"90 deg/s\"]");
  EXPECT_EQ(two.gains, (std::array{0.0, 0.5}));
  EXPECT_NEAR(two.rate, 1.5707963267948966, 1e-15);
  EXPECT_EQ(turned("gain = [0.3, 0.4]").rate, 2.0);
}

TEST(Knobs, AreRefusedWithLineAndKey) {
  EXPECT_EQ(why([] { (void)turned("gain = [1]"); }), "study.toml:2: washout.gain: takes 2 values, has 1");
  EXPECT_EQ(why([] { (void)turned("gain = [1, 1]\ntilt_rate = [0]"); }),
            "study.toml:3: washout.tilt_rate: is 0; must be above 0");
  EXPECT_EQ(why([] { (void)turned("gain = [-1, 1]"); }), "study.toml:2: washout.gain: is -1; must be at least 0");
}

// Of a design that was made in code.
TEST(Knobs, OfADesignAreChecked) {
  EXPECT_EQ(checked(TwoKnobs{.gains = {0.0, 1.0}}).gains[0], 0.0);
  EXPECT_EQ(why([] { (void)checked(TwoKnobs{.rate = 0.0}); }), "washout.tilt_rate: is 0; must be above 0");
  EXPECT_EQ(why([] {
              (void)checked(TwoKnobs{.gains = {1.0, std::nan("")}});
            }),
            "washout.gain: is nan; must be at least 0");
  EXPECT_NE(why([] { (void)checked(TwoKnobs{.rate = std::numeric_limits<double>::infinity()}); }),
            "nothing was refused");
}

TEST(WashoutAlgorithms, AreFoundByTheirNames) {
  std::set<std::string_view> names;
  for (const WashoutAlgorithm& algorithm : washout_algorithms()) {
    EXPECT_TRUE(names.insert(algorithm.name).second) << algorithm.name << " twice";
    EXPECT_EQ(&washout_algorithm(algorithm.name), &algorithm);
    EXPECT_FALSE(algorithm.summary.empty());
  }
  EXPECT_EQ(names.size(), 9U);
  EXPECT_EQ(why([] { static_cast<void>(washout_algorithm("clasical")); }),
            "washout: there is no algorithm 'clasical' (did you mean 'classical'?)");
}

// Knobs point into the design that they were asked of: a copy has numbers of its own.
TEST(WashoutDesigns, AreCopiedWithTheNumbersOfTheirKnobs) {
  for (const WashoutAlgorithm& algorithm : washout_algorithms()) {
    const std::unique_ptr<WashoutDesign> design = algorithm.design();
    const std::vector<Knob> knobs = design->knobs();
    ASSERT_FALSE(knobs.empty()) << algorithm.name;
    std::set<std::string> names;
    for (const Knob& knob : knobs) EXPECT_TRUE(names.insert(std::string(knob.name)).second) << knob.name << " twice";
    const double before = knobs[0].values[0];
    const std::unique_ptr<WashoutDesign> copy = design->clone();
    knobs[0].values[0] = 1.25 * before;
    EXPECT_EQ(copy->knobs()[0].values[0], before) << algorithm.name;
    EXPECT_EQ(design->clone()->knobs()[0].values[0], 1.25 * before) << algorithm.name;
  }
}

TEST(WashoutDesigns, RefuseAKnobThatMakesNoSense) {
  for (const WashoutAlgorithm& algorithm : washout_algorithms()) {
    const std::unique_ptr<WashoutDesign> design = algorithm.design();
    const std::vector<Knob> knobs = design->knobs();
    knobs[0].values[0] = std::nan("");
    const std::string message = why([&] { static_cast<void>(design->make(Platform{})); });
    EXPECT_NE(message.find(knobs[0].name), std::string::npos) << algorithm.name << ": " << message;
  }
}

}  // namespace
}  // namespace veridyn::cueing
