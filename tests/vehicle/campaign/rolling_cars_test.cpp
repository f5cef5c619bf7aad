#include "tests/vehicle/campaign/rolling_cars.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "tests/vehicle/campaign/campaign.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::vehicle {
namespace {

using testing::CarTyre;

/// What became of one drive.
struct Result {
  bool accepted = false;  ///< parameters graded yes
  bool useful = false;    ///< and C_f, C_r and I_z each within a tenth, the truth inside its interval
  bool wrong = false;     ///< accepted with one of them more than a tenth off and the truth outside
  std::size_t covered = 0, intervals = 0;
  double worst = 0.0;  ///< largest error of the three, a share
  DriveStructure structure = DriveStructure::kBicycle;
};

Result result_of(std::size_t car, CarTyre tyre, std::size_t drive, std::uint64_t seed) {
  const VehicleStudy study = testing::rolling_drive(testing::rolling_car(car), tyre, drive, seed);
  const testing::IdentifiedDrive identified = testing::identified(study);
  Result result;
  if (identified.refused) return result;
  const VehicleIdentification& found = identified.analysis.identification;
  const VehicleEstimate* best = found.best();
  if (best == nullptr) return result;
  result.structure = found.structure;
  result.accepted = found.judgement.parameters.grade == estimation::Grade::kYes;
  bool all_right = true, one_wrong = false;
  for (const char* name : {"C_f", "C_r", "I_z"}) {
    const estimation::Parameter* p = best->find(name);
    const double truth = study.truth.at(name);
    const double error = std::abs(p->value / truth - 1.0);
    const bool inside = p->low95 <= truth && truth <= p->high95;
    ++result.intervals;
    result.covered += inside ? 1 : 0;
    result.worst = std::max(result.worst, error);
    all_right = all_right && error < 0.1 && inside;
    one_wrong = one_wrong || (error > 0.1 && !inside);
  }
  result.useful = result.accepted && all_right;
  result.wrong = result.accepted && one_wrong;
  return result;
}

// A car that leans, livelier than gentle: roll is taken. A shortfall: its tyres do not lag, which no tyre does, and I_z
// is 29 % off for it, +- 57 %.
TEST(RollingCars, ADriveGivesTheStiffnessesOfACarThatLeans) {
  const Result result = result_of(0, CarTyre::kLinear, 3, 1);
  EXPECT_TRUE(has_roll(result.structure));
  EXPECT_LT(result.worst, 0.35);
  EXPECT_EQ(result.covered, result.intervals);
}

// Tyres that lag hide in the noise of a gentle drive: taken as if they did not, I_z came out 5 to 8 % high beyond its
// interval. Here they are probable, but predict the hold-out worse: it stays open whether they lag, and the intervals
// say so.
TEST(RollingCars, AGentleDriveSaysWhatItLeavesOpenOfTheStructure) {
  const VehicleStudy study = testing::rolling_drive(testing::rolling_car(1), CarTyre::kLinear, 2, 23);
  const testing::IdentifiedDrive drive = testing::identified(study);
  ASSERT_FALSE(drive.refused) << drive.message;
  const VehicleIdentification& found = drive.analysis.identification;
  ASSERT_TRUE(has_roll(found.structure));
  ASSERT_FALSE(found.structure_doubts.empty());
  const estimation::Parameter* I_z = found.best()->find("I_z");
  EXPECT_LE(I_z->low95, study.truth.at("I_z"));
  EXPECT_GE(I_z->high95, study.truth.at("I_z"));
  const estimation::Estimate estimate = make_vehicle_estimate(found, "car");
  const estimation::IntervalPart& doubt = estimate.interval_parts.at("I_z").back();
  EXPECT_EQ(doubt.key, "structure_doubt");
  EXPECT_GT(doubt.sigma, 0.0);
  EXPECT_GT(I_z->sigma, doubt.sigma);
  const auto row = std::ranges::find(found.checks, estimation::Check::kStructureDoubt, &estimation::Evidence::check);
  ASSERT_NE(row, found.checks.end());
}

// On tyres whose stiffness falls with their force saturation is taken: within 6 % where linear tyres are 5 to 50 % off.
TEST(RollingCars, TyresThatSaturateAreToldFromSofterOnes) {
  const Result result = result_of(5, CarTyre::kFiala, 3, 4);
  EXPECT_TRUE(saturates(result.structure));
  EXPECT_LT(result.worst, 0.1);
  EXPECT_EQ(result.covered, result.intervals);
}

// An accelerometer a quarter of a metre above where the study has it, on a body that leans. With sensors so quiet that
// a bicycle that rolls leaves more of a four-wheel car than noise, its height is found in part (0.2 +- 0.13 m), and
// C_r, which is 10 % high if it is taken at its word, comes out 1.5 % high. C_f and I_z are 6 to 8 % high with it and 3
// to 6 % off without: place, trail and roll steer take their share of what the height does, and the intervals hold it.
TEST(RollingCars, AnAccelerometerAboveTheCentreOfGravityIsSeen) {
  constexpr double kAbove_m = 0.25;
  VehicleStudy study =
      testing::rolling_drive(testing::rolling_car(4), CarTyre::kLinear, 5, 17, {.duration_s = 60.0, .noise = 0.1});
  study.signals.accel_position[2] -= kAbove_m;
  const testing::IdentifiedDrive drive = testing::identified(study);
  study.identify.model.prior[DriveUnknown::kAccelHeight] = 1e-6;
  const testing::IdentifiedDrive at_its_word = testing::identified(study);
  ASSERT_FALSE(drive.refused) << drive.message;
  ASSERT_FALSE(at_its_word.refused) << at_its_word.message;
  const VehicleEstimate* best = drive.analysis.identification.best();
  const estimation::Parameter* height = best->find("accel_height");
  ASSERT_NE(height, nullptr);
  EXPECT_GT(height->value, 0.5 * kAbove_m);
  EXPECT_LE(height->low95, kAbove_m);
  EXPECT_GE(height->high95, kAbove_m);
  for (const char* name : {"C_f", "C_r", "I_z"}) {
    const estimation::Parameter* p = best->find(name);
    EXPECT_NEAR(p->value, study.truth.at(name), 0.1 * study.truth.at(name)) << name;
    EXPECT_LE(p->low95, study.truth.at(name)) << name;
    EXPECT_GE(p->high95, study.truth.at(name)) << name;
  }
  const double C_r = study.truth.at("C_r");
  EXPECT_LT(std::abs(best->find("C_r")->value - C_r),
            0.5 * std::abs(at_its_word.analysis.identification.best()->find("C_r")->value - C_r));
}

// Ten cars, six drives of each, three kinds of tyres, five noises of each, no two alike; an hour and a half. Writes
// rolling_cars.md.
TEST(RollingCarsSoak, AreIdentifiedOrNotClaimed) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "a long-running campaign; `make soak` runs it";
  constexpr std::size_t kCars = 10, kNoises = 5;
  constexpr std::array kTyres{std::pair{CarTyre::kLinear, "linear"}, std::pair{CarTyre::kFiala, "Fiala"},
                              std::pair{CarTyre::kMagicFormula, "Magic Formula"}};
  std::ofstream table("rolling_cars.md");
  table << "| tyres | drives | accepted | wrong | within 10 % and covered | coverage | largest error of half |\n"
           "|---|---|---|---|---|---|---|\n";
  for (std::size_t t = 0; t < kTyres.size(); ++t) {
    std::vector<Result> results(kCars * testing::kRollingDrives * kNoises);
    numerics::parallel_for(results.size(), 0, [&](std::size_t k) {
      const std::size_t drive = k / kNoises;
      results[k] = result_of(drive / testing::kRollingDrives, kTyres[t].first, drive % testing::kRollingDrives,
                             1 + k + results.size() * t);
    });
    std::size_t accepted = 0, wrong = 0, useful = 0, covered = 0, intervals = 0;
    std::vector<double> worst;
    for (const Result& r : results) {
      accepted += r.accepted ? 1 : 0;
      wrong += r.wrong ? 1 : 0;
      useful += r.useful ? 1 : 0;
      covered += r.covered;
      intervals += r.intervals;
      worst.push_back(r.worst);
    }
    const auto share = [](std::size_t part, std::size_t whole) {
      return static_cast<double>(part) / static_cast<double>(whole);
    };
    std::ranges::nth_element(worst, worst.begin() + static_cast<std::ptrdiff_t>(worst.size() / 2));
    table << fmt::format("| {} | {} | {} | {} | {} | {:.1f} % | {:.1f} % |\n", kTyres[t].second, results.size(),
                         accepted, wrong, useful, 100.0 * share(covered, intervals), 100.0 * worst[worst.size() / 2]);
    EXPECT_LE(share(wrong, accepted), 0.03) << kTyres[t].second;
    EXPECT_GE(share(useful, results.size()), 0.80) << kTyres[t].second;
    EXPECT_GE(share(covered, intervals), 0.90) << kTyres[t].second;
    EXPECT_LE(share(covered, intervals), 0.98) << kTyres[t].second;
  }
}

}  // namespace
}  // namespace veridyn::vehicle
