#include "veridyn/muscle/model/signals.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::ElementsAre;

std::vector<double> values_at(const ControlSignals& signals, double time) {
  std::vector<double> values(signals.size());
  signals.evaluate(time, values.data());
  return values;
}

TEST(ControlSignals, AreLinearBetweenSamplesOrHoldThem) {
  const std::vector<double> time{0.0, 1.0, 3.0}, value{0.0, 5.0, 1.0, 4.0, 2.0, 8.0};
  const ControlSignals linear(time, value, 2, Interpolation::kLinear), hold(time, value, 2, Interpolation::kHold);
  EXPECT_THAT(values_at(linear, 0.5), ElementsAre(0.5, 4.5));
  EXPECT_THAT(values_at(linear, 2.0), ElementsAre(1.5, 6.0));
  EXPECT_THAT(values_at(hold, 0.999), ElementsAre(0.0, 5.0));
  EXPECT_THAT(values_at(hold, 1.0), ElementsAre(1.0, 4.0));
  for (const ControlSignals* signals : {&linear, &hold}) {
    EXPECT_THAT(values_at(*signals, -1.0), ElementsAre(0.0, 5.0));
    EXPECT_THAT(values_at(*signals, 9.0), ElementsAre(2.0, 8.0));
  }
}

TEST(ControlSignals, NextBreakIsTheNextSampleAndInfiniteAfterTheLast) {
  const ControlSignals signals({0.0, 1.0, 3.0}, {0.1, 0.2, 0.3}, 1, Interpolation::kHold);
  EXPECT_EQ(signals.next_break(0.0), 1.0);
  EXPECT_EQ(signals.next_break(1.5), 3.0);
  EXPECT_EQ(signals.next_break(3.0), kInfinity);
  EXPECT_EQ(ControlSignals({0.5}).next_break(0.0), kInfinity);
}

TEST(SignalTable, FindsAColumnInEveryWayItsNameIsWritten) {
  SignalTable table;
  table.names = {"a", "b.value", "c_activation", "/jointset/elbow/d/value", "/forceset/e/activation"};
  EXPECT_EQ(table.find("a", "value"), 0);
  EXPECT_EQ(table.find("b", "value"), 1);
  EXPECT_EQ(table.find("c", "activation"), 2);
  EXPECT_EQ(table.find("d", "value"), 3);
  EXPECT_EQ(table.find("e", "activation"), 4);
  EXPECT_EQ(table.find("f", "value"), -1);
}

TEST(Motion, OfATableIsInRadiansAndSaysWhatIsMissing) {
  const Model model = load_model("arm").model();
  SignalTable table;
  table.names = {"elbow_flexion"};
  table.time = {0.0, 0.1, 0.2, 0.3};
  table.values = {{10.0, 20.0, 30.0, 40.0}};
  table.rotations_in_degrees = true;
  const Motion motion = make_motion(table, model);
  EXPECT_NEAR(motion.coordinate[1]->evaluate(0.15).value, 25.0 * kDegree, 1e-12);
  EXPECT_NEAR(motion.coordinate[1]->evaluate(0.15).slope, 100.0 * kDegree, 1e-10);
  EXPECT_FALSE(motion.coordinate[0].has_value());
  EXPECT_THAT(motion.missing, ElementsAre("shoulder_flexion"));
  table.names = {"knee"};
  EXPECT_THROW((void)make_motion(table, model), InputError);
}

TEST(Excitations, OfATableKeepTheOthersAndMustLieWithinZeroAndOne) {
  const Model model = load_model("arm").model();
  const std::vector<double> otherwise(6, 0.07);
  SignalTable table;
  table.source = "u.csv";
  table.names = {"brachialis"};
  table.time = {0.0, 0.5};
  table.values = {{0.2, 0.6}};
  const ControlSignals u = make_excitations(table, model, otherwise, Interpolation::kLinear);
  const auto brachialis = static_cast<std::size_t>(model.muscle("brachialis"));
  for (std::size_t m = 0; m < 6; ++m) EXPECT_NEAR(values_at(u, 0.25)[m], m == brachialis ? 0.4 : 0.07, 1e-15);
  table.values = {{0.2, 1.2}};
  try {
    (void)make_excitations(table, model, otherwise, Interpolation::kLinear);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("brachialis"));
  }
}

}  // namespace
}  // namespace veridyn::muscle
