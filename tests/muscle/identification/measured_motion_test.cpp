#include "veridyn/muscle/identification/measured_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MeasuredArm : public testing::Test {
 protected:
  [[nodiscard]] MuscleOutput output(const std::string& name) const {
    return {.kind = name == "elbow_flexion"          ? MuscleOutputKind::kValue
                    : name == "elbow_flexion.speed"  ? MuscleOutputKind::kSpeed
                    : name == "elbow_flexion.moment" ? MuscleOutputKind::kMoment
                                                     : MuscleOutputKind::kFiberLength,
            .index = name.starts_with("elbow") ? arm.coordinate("elbow_flexion") : arm.muscle("brachialis"),
            .noise_sd = 0.0};
  }
  /// Of an angle, 10 ms apart.
  static SignalTable angles(std::vector<double> values) {
    SignalTable table{.source = "trial.sto", .names = {"elbow_flexion"}, .time = {}, .values = {}};
    for (std::size_t k = 0; k < values.size(); ++k) table.time.push_back(0.01 * static_cast<double>(k));
    table.values = {std::move(values)};
    return table;
  }
  [[nodiscard]] std::string error_of(const SignalTable& table) const {
    const std::vector<MuscleOutput> outputs = {output("elbow_flexion")};
    try {
      static_cast<void>(read_measured_motion(table, arm, outputs));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  Model arm = load_model("arm").model();
};

TEST_F(MeasuredArm, HasAColumnOfEachOutputInAnyOfItsNames) {
  const std::vector<MuscleOutput> outputs = {output("elbow_flexion"), output("elbow_flexion.speed"),
                                             output("elbow_flexion.moment"), output("brachialis.fiber_length")};
  for (const char* separator : {".", "_", "/"}) {
    const SignalTable table{.source = "trial.sto",
                            .names = {std::string("brachialis") + separator + "fiber_length",
                                      std::string("/jointset/elbow/elbow_flexion") + separator + "speed",
                                      "/jointset/elbow/elbow_flexion/value"},
                            .time = {0.0, 0.01},
                            .values = {{0.1, 0.2}, {3.0, 4.0}, {0.5, 0.6}}};
    const MeasuredMotion motion = read_measured_motion(table, arm, outputs);
    EXPECT_EQ(motion.source, "trial.sto");
    EXPECT_EQ(motion.time, table.time);
    EXPECT_EQ(motion.values(1, 0), 0.6) << separator;
    EXPECT_EQ(motion.values(0, 1), 3.0) << separator;
    EXPECT_TRUE(motion.values.col(2).array().isNaN().all()) << "no column";
    EXPECT_EQ(motion.values(1, 3), 0.2) << separator;
  }
}

TEST_F(MeasuredArm, IsInRadiansWhereTheFileIsInDegreesAndLengthsStay) {
  SignalTable table = angles({30.0, 60.0});
  table.rotations_in_degrees = true;
  table.names.emplace_back("brachialis.fiber_length");
  table.values.push_back({0.1, 0.2});
  const std::vector<MuscleOutput> outputs = {output("elbow_flexion"), output("brachialis.fiber_length")};
  const MeasuredMotion motion = read_measured_motion(table, arm, outputs);
  EXPECT_DOUBLE_EQ(motion.values(1, 0), 60.0 * kDegree);
  EXPECT_EQ(motion.values(1, 1), 0.2);
}

TEST_F(MeasuredArm, IsRefusedWithFileColumnAndWhatIsWrong) {
  EXPECT_EQ(error_of(angles({0.1, 0.2, 0.3})), "no error");
  EXPECT_THAT(error_of(angles({0.1})), AllOf(HasSubstr("trial.sto"), HasSubstr("fewer than two samples")));
  EXPECT_THAT(error_of(angles({0.1, std::nan(""), 0.3})), HasSubstr("column 'elbow_flexion' has no value at 0.01 s"));
  EXPECT_THAT(error_of(angles({0.4, 0.4, 0.4})), HasSubstr("does not move"));
  EXPECT_THAT(error_of(angles({20.0, 60.0, 110.0})), HasSubstr("degrees taken for radians"));
  SignalTable other = angles({0.1, 0.2});
  other.names = {"knee"};
  EXPECT_THAT(error_of(other), HasSubstr("has no column of an output (elbow_flexion"));
}

// Five times the usual step, and more than 50 ms: both are needed.
TEST_F(MeasuredArm, HasAGapWhereStepsAreLongForTheFileAndForAMuscle) {
  const auto with_last_step = [&](double usual, double last) {
    SignalTable table = angles({0.1, 0.2, 0.3, 0.4});
    table.time = {0.0, usual, 2.0 * usual, 2.0 * usual + last};
    return error_of(table);
  };
  EXPECT_EQ(with_last_step(0.01, 0.049), "no error");
  EXPECT_THAT(with_last_step(0.01, 0.052), HasSubstr("has a gap from 0.02 to 0.072 s"));
  EXPECT_EQ(with_last_step(0.001, 0.049), "no error") << "shorter than 50 ms";
  EXPECT_EQ(with_last_step(0.02, 0.09), "no error") << "less than five steps";
}

}  // namespace
}  // namespace veridyn::muscle
