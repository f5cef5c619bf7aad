#include "veridyn/muscle/identification/published_route.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>

#include "veridyn/core/error.hpp"
#include "veridyn/estimation/output_error/model_view.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/muscle/identification/task_segments.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/tasks/elbow_tasks.hpp"

namespace veridyn::muscle {
namespace {

/// The built-in arm in two tasks, with a person whose brachialis and lateral triceps are not the model's.
class HiddenPerson {
 public:
  explicit HiddenPerson(double accuracy = 1e-6)
      : arm_(load_model("arm").model(), {.paths = PathSource::kFitted}),
        tasks_(prepared(arm_)),
        model_(arm_, unknowns(arm_.model()), segments_of(tasks_), {.accuracy = accuracy}),
        hidden_(Eigen::Vector2d(1.031, 0.974)),
        targets_(simulate_tasks(model_, hidden_, 1)) {}

  [[nodiscard]] const MuscleParametricModel& model() const { return model_; }
  [[nodiscard]] const Eigen::VectorXd& hidden() const { return hidden_; }
  [[nodiscard]] const std::vector<estimation::RowMatrix>& targets() const { return targets_; }

 private:
  static std::vector<PreparedTask> prepared(const MusculoskeletalSystem& arm) {
    std::vector<Task> list;
    for (const int n : {8, 33}) list.push_back(make_elbow_task(arm.model(), resolved(arm.model(), {}), n));
    Progress progress;
    return prepare_tasks(arm, std::move(list), progress);
  }
  static std::vector<MuscleUnknown> unknowns(const Model& model) {
    std::vector<MuscleUnknown> list;
    for (const auto& [muscle, field] :
         {std::pair{"brachialis", "optimal_fiber_length"}, std::pair{"triceps_lateral", "tendon_slack_length"}})
      list.push_back(make_unknown(model,
                                  {.muscles = {muscle},
                                   .fields = {field},
                                   .factor = true,
                                   .low = Extent{-10.0, true},
                                   .high = Extent{10.0, true}},
                                  "test"));
    return list;
  }

  MusculoskeletalSystem arm_;
  std::vector<PreparedTask> tasks_;
  MuscleParametricModel model_;
  Eigen::VectorXd hidden_;
  std::vector<estimation::RowMatrix> targets_;
};

/// Counts the responses of a model: those without and with sensitivities.
class CountedModel final : public estimation::ModelView {
 public:
  explicit CountedModel(const MuscleParametricModel& model) : ModelView(model) {}
  [[nodiscard]] bool respond(std::size_t s, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             estimation::ModelResponse& response) const override {
    ++count;
    return viewed().respond(s, theta, active, response);
  }
  mutable std::atomic<std::size_t> count = 0;
};

TEST(PublishedRoute, FindsTheHiddenPersonAsTheGradientDoesWithManyMoreSimulations) {
  const HiddenPerson person;
  Progress progress;
  const PublishedRouteResult found =
      published_route(person.model(), person.targets(), {.pattern = {.tolerance = 1e-5}}, progress);
  ASSERT_TRUE(found.usable()) << found.message();
  EXPECT_EQ(found.swarm.termination, estimation::SearchTermination::kFeasible) << found.message();
  const double error = (found.theta - person.hidden()).cwiseAbs().maxCoeff();
  EXPECT_LT(error, 2e-3) << found.message();
  for (const double e : found.nrmse) EXPECT_LT(e, 1e-3);
  EXPECT_EQ(found.simulations, 2U * found.evaluations.size());

  const CountedModel counted(person.model());
  const auto begun = std::chrono::steady_clock::now();
  const estimation::OutputErrorEstimate gradient =
      estimation::output_error(counted, person.targets(),
                               {.noise = estimation::OutputNoise::kGiven,
                                .noise_start = Eigen::VectorXd::Constant(1, 1e-3),
                                .free_initial_conditions = false});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  ASSERT_TRUE(gradient.usable()) << gradient.message;
  const double gradient_error = (gradient.theta - person.hidden()).cwiseAbs().maxCoeff();
  // Without noise both come to the person; the gradient's search ends when a step is small against sigma, here 1e-3
  // rad.
  EXPECT_LT(gradient_error, 1e-4);
  RecordProperty("published",
                 fmt::format("error {:.2g}, {} simulations, {:.2f} s", error, found.simulations, found.seconds));
  RecordProperty("gradient",
                 fmt::format("error {:.2g}, {} responses, {:.2f} s", gradient_error, counted.count.load(), seconds));
  // A response with two derivatives costs less than three simulations.
  EXPECT_GT(found.simulations, 3 * counted.count);
}

TEST(PublishedRoute, ContinuesItsLogAndRefusesThatOfOtherTargets) {
  const HiddenPerson person(1e-5);
  const std::filesystem::path log = std::filesystem::path(testing::TempDir()) / "published_route_log.csv";
  std::filesystem::remove(log);
  Progress progress;
  PublishedRouteOptions options{.swarm = {.particles = 6, .iterations = 4, .swarms = 1, .stop_at_feasible = true},
                                .pattern = {.tolerance = 1e-2},
                                .evaluation = {.max_evaluations = 15, .log = log}};
  const PublishedRouteResult first = published_route(person.model(), person.targets(), options, progress);
  EXPECT_LE(first.evaluations.size(), 15U);
  options.evaluation.max_evaluations = 1000;
  const PublishedRouteResult second = published_route(person.model(), person.targets(), options, progress);
  EXPECT_EQ(second.resumed, first.evaluations.size());
  options.evaluation.log.clear();
  const PublishedRouteResult whole = published_route(person.model(), person.targets(), options, progress);
  EXPECT_EQ(second.theta, whole.theta);
  EXPECT_EQ(second.evaluations.size(), whole.evaluations.size());
  std::vector<estimation::RowMatrix> others = person.targets();
  others[0](3, 0) += 1e-9;
  options.evaluation.log = log;
  EXPECT_THROW((void)published_route(person.model(), others, options, progress), InputError);
}

TEST(PublishedRoute, RefusesATargetWithoutMotion) {
  const HiddenPerson person(1e-5);
  std::vector<estimation::RowMatrix> targets = person.targets();
  targets[1].setConstant(0.3);
  Progress progress;
  EXPECT_THROW((void)published_route(person.model(), targets, {}, progress), InputError);
  EXPECT_THROW((void)published_route(person.model(), person.targets(), {.tolerance = 0.0}, progress), InputError);
}

}  // namespace
}  // namespace veridyn::muscle
