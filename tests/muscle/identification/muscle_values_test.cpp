#include "veridyn/muscle/identification/muscle_values.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {
namespace {

class MuscleValuesOfTheArm : public testing::Test {
 protected:
  [[nodiscard]] MuscleUnknown unknown(std::vector<std::string> muscles, const std::string& field, bool factor) const {
    return make_unknown(system.model(),
                        {.name = field, .muscles = std::move(muscles), .fields = {field}, .factor = factor}, "test");
  }
  [[nodiscard]] std::size_t muscle(const char* name) const {
    return static_cast<std::size_t>(system.model().muscle(name));
  }
  [[nodiscard]] MuscleValues own() const { return values_at(system.muscles(), {}, Eigen::VectorXd()); }

  MusculoskeletalSystem system{load_model("arm").model()};
};

TEST_F(MuscleValuesOfTheArm, WithoutUnknownsAreTheModels) {
  const MuscleValues values = own();
  ASSERT_EQ(values.muscles.size(), 6U);
  for (std::size_t m = 0; m < 6; ++m) {
    for (std::size_t f = 0; f < kEstimableFields; ++f)
      EXPECT_EQ(field_of(values.muscles[m], f), field_of(system.muscles().settings(m).musculotendon, f));
    EXPECT_EQ(values.gain[m], 1.0);
    EXPECT_EQ(values.delay[m], 0.0);
  }
  EXPECT_TRUE(values.possible());
}

TEST_F(MuscleValuesOfTheArm, AFactorMultipliesAndAValueReplaces) {
  const std::vector<MuscleUnknown> unknowns = {unknown({"biceps_long", "brachialis"}, "max_isometric_force", true),
                                               unknown({"triceps_long"}, "tendon_slack_length", false),
                                               unknown({"brachialis"}, "excitation_gain", false),
                                               unknown({"all"}, "excitation_delay", false)};
  const MuscleValues before = own();
  // Starts of segments may follow the unknowns.
  const MuscleValues values =
      values_at(system.muscles(), unknowns, (Eigen::VectorXd(6) << 1.1, 0.15, 0.8, 0.03, 7.0, 7.0).finished());
  const std::size_t biceps = muscle("biceps_long"), brachialis = muscle("brachialis"), triceps = muscle("triceps_long");
  for (const std::size_t m : {biceps, brachialis})
    EXPECT_DOUBLE_EQ(values.muscles[m].max_isometric_force, 1.1 * before.muscles[m].max_isometric_force);
  EXPECT_EQ(values.muscles[triceps].max_isometric_force, before.muscles[triceps].max_isometric_force);
  EXPECT_EQ(values.muscles[triceps].tendon_slack_length, 0.15);
  EXPECT_EQ(values.muscles[biceps].tendon_slack_length, before.muscles[biceps].tendon_slack_length);
  for (std::size_t m = 0; m < 6; ++m) {
    EXPECT_EQ(values.gain[m], m == brachialis ? 0.8 : 1.0);
    EXPECT_EQ(values.delay[m], 0.03);
  }
}

TEST_F(MuscleValuesOfTheArm, ArePossibleWhileMusclesCanHaveThem) {
  const auto with = [&](double MusculotendonParameters<double>::*field, double value) {
    MuscleValues values = own();
    values.muscles[2].*field = value;
    return values.possible();
  };
  using P = MusculotendonParameters<double>;
  EXPECT_FALSE(with(&P::max_isometric_force, 0.0));
  EXPECT_FALSE(with(&P::optimal_fiber_length, -0.1));
  EXPECT_FALSE(with(&P::tendon_slack_length, kNaN));
  EXPECT_FALSE(with(&P::tendon_slack_length, kInfinity));
  // Pennation alone may be zero, and has an end.
  EXPECT_TRUE(with(&P::pennation_angle_at_optimal, 0.0));
  EXPECT_FALSE(with(&P::pennation_angle_at_optimal, -0.1));
  EXPECT_FALSE(with(&P::pennation_angle_at_optimal, 1.5));
  MuscleValues values = own();
  values.gain[0] = kNaN;
  EXPECT_FALSE(values.possible());
  values.gain[0] = 1.0;
  values.delay[5] = kInfinity;
  EXPECT_FALSE(values.possible());
}

}  // namespace
}  // namespace veridyn::muscle
