#include "veridyn/cueing/washout/washout_design.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "tests/cueing/washout/pushed.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::cueing {
namespace {

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
