#include "veridyn/muscle/simulation/muscle_parametric_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle {
namespace {

std::vector<double> samples(double end) {
  std::vector<double> time;
  for (double t = 0.0; t < end + 1e-9; t += 0.01) time.push_back(t);
  return time;
}

MotionSegment segment_of(const MusculoskeletalSystem& system, double elbow, const std::vector<double>& excitation,
                         double end) {
  MotionSegment segment;
  segment.start = default_start(system.model());
  segment.start.q(1) = elbow;
  segment.drive = {ControlSignals(excitation), {}};
  segment.time = samples(end);
  return segment;
}

class MuscleSensitivities : public ::testing::TestWithParam<PathSource> {};

TEST_P(MuscleSensitivities, AreThoseOfCentralDifferences) {
  const MusculoskeletalSystem system(load_model("arm").model(), {.paths = GetParam()});
  std::vector<MuscleParameterName> names;
  for (const char* name : {"biceps_long.max_isometric_force", "biceps_long.optimal_fiber_length",
                           "biceps_long.tendon_slack_length", "triceps_long.optimal_fiber_length",
                           "triceps_long.pennation_angle_at_optimal", "brachialis.max_contraction_velocity",
                           "brachialis.activation_time_constant", "brachialis.tendon_slack_length"}) {
    names.push_back(parse_parameter_name(system.model(), name, "test"));
  }
  // A step of the excitations, so that the activation's time constant shows.
  MotionSegment segment = segment_of(system, 0.6, std::vector<double>(6, 0.05), 0.12);
  std::vector<double> step(6, 0.05);
  for (const double u : {0.05, 0.05, 0.05, 0.3, 0.2, 0.3}) step.push_back(u);
  segment.drive.excitation = ControlSignals({0.0, 0.035}, step, 6, Interpolation::kHold);
  const MuscleParametricModel model(system, names, {segment}, 1e-9);
  // Differences divide what the integrator leaves by their step: theirs has to leave less.
  const MuscleParametricModel finer(system, names, {segment}, 1e-12);
  Eigen::VectorXd theta(static_cast<Eigen::Index>(names.size() + 4));
  for (std::size_t i = 0; i < names.size(); ++i) theta(static_cast<Eigen::Index>(i)) = model.parameters()[i].start;
  for (std::size_t i = 0; i < 4; ++i)
    theta(static_cast<Eigen::Index>(names.size() + i)) = model.initial_conditions(0)[i].start;
  std::vector<Eigen::Index> active(static_cast<std::size_t>(theta.size()));
  for (std::size_t i = 0; i < active.size(); ++i) active[i] = static_cast<Eigen::Index>(i);
  estimation::ModelResponse exact, plus, minus;
  ASSERT_TRUE(model.respond(0, theta, active, exact));
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    const double h = 2e-4 * std::max(std::abs(theta(j)), 0.1);
    Eigen::VectorXd moved = theta;
    moved(j) = theta(j) + h;
    ASSERT_TRUE(finer.respond(0, moved, {}, plus));
    moved(j) = theta(j) - h;
    ASSERT_TRUE(finer.respond(0, moved, {}, minus));
    const Eigen::Index rows = exact.output.rows(), columns = exact.output.cols();
    double largest = 0.0, difference = 0.0;
    for (Eigen::Index k = 0; k < rows; ++k) {
      for (Eigen::Index c = 0; c < columns; ++c) {
        const double central = (plus.output(k, c) - minus.output(k, c)) / (2.0 * h);
        largest = std::max(largest, std::abs(central));
        difference = std::max(difference, std::abs(central - exact.sensitivity(k * columns + c, j)));
      }
    }
    EXPECT_GT(largest, 0.0);
    EXPECT_LT(difference, 1e-4 * largest)
        << (j < static_cast<Eigen::Index>(names.size()) ? model.parameters()[static_cast<std::size_t>(j)].name
                                                        : "start");
  }
}

INSTANTIATE_TEST_SUITE_P(Paths, MuscleSensitivities, ::testing::Values(PathSource::kExact, PathSource::kFitted));

TEST(MuscleParametricModel, IsTheForwardSimulation) {
  const MusculoskeletalSystem system(load_model("arm").model());
  const std::vector<double> u{0.05, 0.05, 0.05, 0.3, 0.2, 0.3};
  const MuscleParametricModel model(system, {}, {segment_of(system, 0.6, u, 0.3)}, 1e-6);
  Eigen::VectorXd theta(4);
  theta << 0.0, 0.6, 0.0, 0.0;
  estimation::ModelResponse response;
  ASSERT_TRUE(model.respond(0, theta, {}, response));
  StartState start = default_start(system.model());
  start.q(1) = 0.6;
  Progress progress;
  const MuscleTrajectory t = simulate_forward(system, start, {ControlSignals(u), {}},
                                              {.end = 0.3, .rate_Hz = 100.0, .accuracy = 1e-6}, progress);
  EXPECT_LT((t.q - response.output).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(MuscleParametricModel, TheSharedOutputErrorEstimatorRecoversHiddenParameters) {
  // The subject: the built-in arm with a longer biceps tendon and a stronger brachialis, which two motions distinguish.
  Model subject = load_model("arm").model();
  auto& biceps = subject.muscles[static_cast<std::size_t>(subject.muscle("biceps_long"))].parameters.musculotendon;
  auto& brachialis = subject.muscles[static_cast<std::size_t>(subject.muscle("brachialis"))].parameters.musculotendon;
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
                                    {parse_parameter_name(generic.model(), "biceps_long.tendon_slack_length", "test"),
                                     parse_parameter_name(generic.model(), "brachialis.max_isometric_force", "test")},
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
    EXPECT_GT(std::abs(model.parameters()[static_cast<std::size_t>(i)].start - hidden(i)), 10.0 * sigma);
  }
}

TEST(MuscleParametricModel, WrongNamesGetTheNearestOne) {
  const Model model = load_model("arm").model();
  try {
    (void)parse_parameter_name(model, "biceps_long.optimal_fibre_length", "study.toml:3: subject.parameters");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("did you mean 'optimal_fiber_length'"));
  }
  EXPECT_THROW((void)parse_parameter_name(model, "soleus.optimal_fiber_length", "x"), InputError);
  EXPECT_THROW((void)parse_parameter_name(model, "soleus", "x"), InputError);
}

}  // namespace
}  // namespace veridyn::muscle
