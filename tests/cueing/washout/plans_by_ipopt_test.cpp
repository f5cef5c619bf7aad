// The predictive washout's plans against Ipopt, on problems that real and simulated drives pose.
#ifdef VERIDYN_IPOPT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/folders.hpp"
#include "tests/support/ipopt/ipopt_programme.hpp"
#include "veridyn/cueing/cueing_study.hpp"
#include "veridyn/cueing/washout/predictive_washout.hpp"

namespace veridyn::cueing {
namespace {

struct Compared {
  int problems = 0;
  int bounded = 0;  ///< with an input or a state at a bound
  double cost = 0.0, violation = 0.0;
};

/// Plans along a drive, one in `every` solved again by Ipopt, both to the end.
template <int kStates, int kInputs>
void compare(const std::vector<recording::MotionSample>& drive, const Platform& platform, Eigen::Index pair,
             double gain, Compared& so_far) {
  const std::size_t every = drive.size() / 51;
  PlannedPair<kStates, kInputs> planned(PredictiveDesign{}, platform, pair);
  planned.step(0.0, {}, SampleStep{});
  const auto ipopt = test::ipopt_for_programmes(1e-10);
  for (std::size_t k = 1; k < drive.size(); ++k) {
    const Eigen::Vector2d force = tilted_force(drive[k].force);
    planned.step(gain * force(pair), {}, drive[k].time - drive[k - 1].time);
    if (k % every != 0 || planned.counts().plans == 0) continue;
    auto programme = planned.programme();
    const auto from = planned.planned_from();
    const numerics::ProgrammeResult ours = programme.solve(from, {.iterations = 100, .tolerance = 1e-8});
    ASSERT_EQ(ours.end, numerics::ProgrammeEnd::kSolved);
    Ipopt::SmartPtr<test::IpoptProgramme<kStates, kInputs>> theirs =
        new test::IpoptProgramme<kStates, kInputs>(programme, from);
    ASSERT_EQ(ipopt->OptimizeTNLP(GetRawPtr(theirs)), Ipopt::Solve_Succeeded);
    ++so_far.problems;
    const auto near = [](const auto& v, const auto& low, const auto& high) {
      const auto range = (high - low).array();
      return ((v - low).array() < 1e-6 * range || (high - v).array() < 1e-6 * range).any();
    };
    bool at_bound = false;
    for (std::size_t i = 0; i + 1 < programme.stages.size(); ++i) {
      const auto& next = programme.stages[i + 1];
      const auto& s = programme.stages[i];
      const auto& x = programme.states()[i + 1];
      at_bound = at_bound || near(programme.inputs()[i], s.u_low, s.u_high) || near(x, next.x_low, next.x_high);
      so_far.violation = std::max({so_far.violation, (next.x_low - x).maxCoeff(), (x - next.x_high).maxCoeff()});
    }
    so_far.bounded += at_bound ? 1 : 0;
    so_far.cost = std::max(so_far.cost, std::abs(ours.cost - theirs->cost) / std::max(std::abs(theirs->cost), 1e-6));
  }
}

Compared compared(const std::vector<recording::MotionSample>& drive, double gain) {
  Compared all;
  for (const Eigen::Index pair : {0, 1}) {
    compare<7, 1>(drive, built_in_platform("three_axis"), pair, gain, all);
    compare<9, 2>(drive, built_in_platform("hexapod"), pair, gain, all);
  }
  return all;
}

/// @param at_bounds how many of the problems touch a bound at least
void expect_same(const Compared& all, int at_bounds) {
  EXPECT_GE(all.problems, 200);
  EXPECT_GE(all.bounded, at_bounds);
  EXPECT_LT(all.cost, 1e-6);
  EXPECT_LT(all.violation, 1e-9);
}

TEST(PlansByIpopt, CostTheSameOnASimulatedDrive) {
  Progress progress;
  const Study study = Study::parse(
      "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"four-wheel\"\nmanoeuvre = "
      "\"sine\"\namplitude = \"2 deg\"\nfrequency = \"0.4 Hz\"\nspeed = \"70 km/h\"\nduration = 40\n",
      "slalom", {}, {});
  expect_same(compared(read_study(study, progress).vehicle, 3.0), 10);
}

TEST(PlansByIpopt, CostTheSameOnADriveOfAPerson) {
  const std::filesystem::path file = test::shared_folder() / "data/vehicle/dirt_rally_2/default.npz";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << "; CostTheSameOnASimulatedDrive is without it";
  Progress progress;
  const Study study = Study::parse("[data]\nfile = \"" + file.string() + "\"\n", "stage", {}, {});
  // The first half of it: plans along the other one pose no other problems.
  std::vector<recording::MotionSample> drive = read_study(study, progress).vehicle;
  drive.resize(drive.size() / 2);
  expect_same(compared(drive, 0.6), 50);
}

}  // namespace
}  // namespace veridyn::cueing
#endif
