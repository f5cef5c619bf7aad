#include "veridyn/muscle/identification/muscle_parametric_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/identification/arm_segments.hpp"
#include "tests/muscle/identification/parameter_name.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle {
namespace {

using test::segment_of;

TEST(MuscleParametricModel, TheSharedOutputErrorEstimatorRecoversHiddenParameters) {
  // The subject: the built-in arm with a longer biceps tendon and a stronger brachialis, which two motions distinguish.
  Model subject = load_model("arm").model();
  auto& biceps = subject.muscles[subject.muscle("biceps_long")].parameters.musculotendon;
  auto& brachialis = subject.muscles[subject.muscle("brachialis")].parameters.musculotendon;
  biceps.tendon_slack_length *= 1.03;
  brachialis.max_isometric_force *= 1.15;
  const MusculoskeletalSystem subject_system(subject, {.paths = PathSource::kFitted});
  const MusculoskeletalSystem generic(load_model("arm").model(), {.paths = PathSource::kFitted});
  const std::vector<double> lift{0.05, 0.05, 0.05, 0.4, 0.2, 0.1}, other{0.1, 0.05, 0.05, 0.05, 0.05, 0.4};
  const auto segments = [&](const MusculoskeletalSystem& system) {
    return std::vector<MotionSegment>{segment_of(system, 0.5, lift, 0.3), segment_of(system, 1.0, other, 0.3)};
  };
  const MuscleParametricModel recorded(subject_system, {}, segments(subject_system));
  constexpr double kNoise = 1e-3;
  numerics::RandomStream random(7, "noise of the angles");
  std::vector<estimation::RowMatrix> measured;
  for (std::size_t s = 0; s < 2; ++s) {
    Eigen::VectorXd theta(4);
    theta << 0.0, s == 0 ? 0.5 : 1.0, 0.0, 0.0;
    estimation::ModelResponse response;
    ASSERT_TRUE(recorded.respond(s, theta, {}, response));
    for (double& angle : response.output.reshaped()) angle += kNoise * random.normal();
    measured.push_back(response.output);
  }
  const MuscleParametricModel model(generic,
                                    {test::parameter_named(generic.model(), "biceps_long.tendon_slack_length"),
                                     test::parameter_named(generic.model(), "brachialis.max_isometric_force")},
                                    segments(generic));
  const estimation::OutputErrorEstimate estimate =
      estimation::output_error(model, measured,
                               {.noise = estimation::OutputNoise::kGiven,
                                .noise_start = Eigen::Vector2d::Constant(kNoise),
                                .covariance = estimation::CovarianceKind::kWhite,
                                .free_initial_conditions = false});
  ASSERT_TRUE(estimate.usable()) << estimate.message;
  const Eigen::Vector2d hidden(biceps.tendon_slack_length, brachialis.max_isometric_force);
  for (Eigen::Index i = 0; i < 2; ++i) {
    const double sigma = std::sqrt(estimate.covariance(i, i));
    EXPECT_LT(std::abs(estimate.theta(i) - hidden(i)), 4.0 * sigma);
    // The data distinguish the subject from the generic model.
    EXPECT_GT(std::abs(model.parameters()[i].start - hidden(i)), 10.0 * sigma);
  }
}

TEST(MuscleParametricModel, SegmentsWithTheirOwnLoadsAndLocksAreOneEstimate) {
  // The subject's flexors are 12 % stronger; lifted with 0, 1 and 2 kg, and once with the shoulder held.
  Model subject = load_model("arm").model();
  const std::vector<std::string> flexors{"biceps_long", "biceps_short", "brachialis"};
  for (const std::string& name : flexors)
    subject.muscles[subject.muscle(name)].parameters.musculotendon.max_isometric_force *= 1.12;
  const MusculoskeletalSystem generic(load_model("arm").model(), {.paths = PathSource::kFitted});
  const MusculoskeletalSystem held(load_model("arm").model(),
                                   {.paths = PathSource::kFitted, .locked = {"shoulder_flexion"}});
  const std::vector<HeldLoad> one{{"forearm", 1.0, Eigen::Vector3d(0.0, -0.3, 0.0)}},
      two{{"forearm", 2.0, Eigen::Vector3d(0.0, -0.3, 0.0)}};
  const MusculoskeletalSystem with_one(generic, one), with_two(generic, two);
  EXPECT_EQ(generic.fit(), with_two.fit());  // paths fitted once
  const MusculoskeletalSystem strong(subject, {.paths = PathSource::kFitted}), strong_one(strong, one),
      strong_two(strong, two), strong_held(subject, {.paths = PathSource::kFitted, .locked = {"shoulder_flexion"}});
  const std::vector<double> lift{0.05, 0.05, 0.05, 0.4, 0.3, 0.3};
  const auto tasks = [&](std::vector<const MusculoskeletalSystem*> systems) {
    std::vector<MotionSegment> segments;
    for (const MusculoskeletalSystem* system : systems) {
      segments.push_back(segment_of(*system, 0.5, lift, 0.25));
      segments.back().system = system;
    }
    segments.back().name = "shoulder held";
    return segments;
  };
  const MuscleParametricModel recorded(strong, std::vector<MuscleUnknown>{},
                                       tasks({&strong, &strong_one, &strong_two, &strong_held}), {});
  numerics::RandomStream random(3, "noise of the angles");
  std::vector<estimation::RowMatrix> measured;
  for (std::size_t s = 0; s < 4; ++s) {
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(s == 3 ? 2 : 4);
    theta(s == 3 ? 0 : 1) = 0.5;
    estimation::ModelResponse response;
    ASSERT_TRUE(recorded.respond(s, theta, {}, response));
    for (double& angle : response.output.reshaped()) angle += 1e-3 * random.normal();
    measured.push_back(response.output);
  }
  // The load matters, and the shoulder that is held rests.
  EXPECT_GT((measured[0] - measured[2]).cwiseAbs().maxCoeff(), 0.1);
  EXPECT_LT(measured[3].col(0).cwiseAbs().maxCoeff(), 6e-3);
  const MuscleParametricModel model(
      generic,
      {make_unknown(generic.model(),
                    {.name = "flexors", .muscles = flexors, .fields = {"max_isometric_force"}, .factor = true}, "x")},
      tasks({&generic, &with_one, &with_two, &held}), {});
  EXPECT_EQ(model.segment_name(3), "shoulder held");
  estimation::OutputErrorOptions options{.noise = estimation::OutputNoise::kGiven,
                                         .noise_start = Eigen::Vector2d::Constant(1e-3),
                                         .covariance = estimation::CovarianceKind::kWhite,
                                         .free_initial_conditions = false,
                                         .threads = 1};
  const estimation::OutputErrorEstimate estimate = estimation::output_error(model, measured, options);
  ASSERT_TRUE(estimate.usable()) << estimate.message;
  const double sigma = std::sqrt(estimate.covariance(0, 0));
  EXPECT_LT(std::abs(estimate.theta(0) - 1.12), 4.0 * sigma);
  EXPECT_LT(sigma, 0.01);
  options.threads = 2;
  EXPECT_EQ(estimation::output_error(model, measured, options).theta(0), estimate.theta(0));
}

TEST(MuscleParametricModel, ASystemWithOtherMusclesIsRefused) {
  Model other = load_model("arm").model();
  std::swap(other.muscles[0], other.muscles[1]);
  const MusculoskeletalSystem system(load_model("arm").model()), swapped(other);
  MotionSegment segment = segment_of(system, 0.5, std::vector<double>(6, 0.1), 0.1);
  segment.system = &swapped;
  try {
    const MuscleParametricModel model(system, std::vector<MuscleUnknown>{}, {segment}, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::AllOf(::testing::HasSubstr("segment 1"), ::testing::HasSubstr("muscle 1 is")));
  }
}

TEST(MuscleParametricModel, OneTaskLeavesWhatItDoesNotDetermineWhereItWas) {
  const MusculoskeletalSystem system(load_model("arm").model(), {.paths = PathSource::kFitted});
  std::vector<MuscleParameterName> names;
  for (int m = 0; m < 6; ++m) {
    for (std::size_t f = 0; f < 3; ++f) names.push_back({m, f});
  }
  const MotionSegment task = segment_of(system, 0.5, {0.05, 0.05, 0.05, 0.4, 0.2, 0.1}, 0.4);
  const MuscleParametricModel model(system, names, {task});
  Eigen::VectorXd theta(22);
  for (Eigen::Index i = 0; i < 18; ++i) theta(i) = (i % 2 == 0 ? 1.03 : 0.97) * model.parameters()[i].start;
  theta.tail(4) << 0.0, 0.5, 0.0, 0.0;
  estimation::ModelResponse person;
  ASSERT_TRUE(model.respond(0, theta, {}, person));
  numerics::RandomStream random(5, "noise of the angles");
  for (double& angle : person.output.reshaped()) angle += 1e-3 * random.normal();
  const auto largest_move = [&](bool hold) {
    const estimation::OutputErrorEstimate e =
        estimation::output_error(model, {person.output},
                                 {.noise = estimation::OutputNoise::kGiven,
                                  .noise_start = Eigen::Vector2d::Constant(1e-3),
                                  .covariance = estimation::CovarianceKind::kWhite,
                                  .free_initial_conditions = false,
                                  .max_relaxations = 3,
                                  .max_steps = 10,
                                  .hold_undetermined = hold});
    EXPECT_TRUE(e.usable()) << e.message;
    EXPECT_EQ(e.held.empty(), !hold);
    // Either way the motion is explained.
    EXPECT_LT(e.outputs[0].fit.rmse, 2e-3);
    EXPECT_LT(e.outputs[1].fit.rmse, 2e-3);
    double largest = 0.0;
    for (Eigen::Index i = 0; i < 18; ++i)
      largest = std::max(largest, std::abs(e.theta(i) / model.parameters()[i].start - 1.0));
    return largest;
  };
  const double held = largest_move(true), wandering = largest_move(false);
  EXPECT_LT(held, 0.15);
  EXPECT_GT(wandering, 1.5 * held);
}

}  // namespace
}  // namespace veridyn::muscle
