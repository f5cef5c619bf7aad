#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "tests/support/channel_faults.hpp"
#include "tests/vehicle/campaign/campaign.hpp"
#include "tests/vehicle/campaign/rolling_cars.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

/// How late a recorded steering is, by the model that is identified: the source of the limit.
namespace veridyn::vehicle {
namespace {

using estimation::Evidence;
using estimation::Outcome;

struct Found {
  bool refused = false;
  double delay_s = kNaN;
  Outcome outcome = Outcome::kNotVerified;
  std::string text, about;
  DriveStructure structure = DriveStructure::kBicycle;
  double I_z_error = kNaN;  ///< a share
};

/// What a drive gives whose recorded steering is so late.
Found found(VehicleStudy study, double late_s) {
  test::delayed({"steer"}, late_s)(study.log.mapped.recording);
  const testing::IdentifiedDrive drive = testing::identified(study);
  Found out{.refused = drive.refused};
  if (drive.refused) return out;
  const VehicleIdentification& id = drive.analysis.identification;
  const auto row = std::ranges::find(id.checks, estimation::Check::kSteeringDelay, &Evidence::check);
  if (row == id.checks.end()) return out;
  out.delay_s = row->value;
  out.outcome = row->outcome;
  out.text = says(*row);
  out.about = row->about;
  out.structure = id.structure;
  if (const VehicleEstimate* best = id.best()) out.I_z_error = best->find("I_z")->value / study.truth.at("I_z") - 1.0;
  return out;
}

// A hand wheel that is 30 ms late took more than half of I_z, and nothing said so.
TEST(SteeringDelay, IsFoundOnABicycleAndNotRaisedWhereThereIsNone) {
  const VehicleStudy study = testing::campaign_drive("reference bicycle", 500);
  const Found clean = found(study, 0.0);
  EXPECT_EQ(clean.outcome, Outcome::kPassed) << clean.text;
  EXPECT_LT(std::abs(clean.I_z_error), 0.03);
  const Found late = found(study, 0.03);
  EXPECT_EQ(late.outcome, Outcome::kFailed) << late.text;
  EXPECT_NEAR(late.delay_s, -0.03, 0.002);
  EXPECT_GT(std::abs(late.I_z_error), 0.3);
  EXPECT_EQ(late.about, "steer, yaw_rate");
}

// The advice, followed: given the delay, the drive passes again.
TEST(SteeringDelay, ThatIsGivenIsTakenOff) {
  VehicleStudy study = testing::campaign_drive("reference bicycle", 501);
  study.identify.model.free[DriveUnknown::kSteerDelay] = true;
  test::delayed({"steer"}, 0.03)(study.log.mapped.recording);
  const testing::IdentifiedDrive estimated = testing::identified(study);
  ASSERT_FALSE(estimated.refused) << estimated.message;
  const VehicleEstimate* best = estimated.analysis.identification.best();
  ASSERT_NE(best, nullptr);
  EXPECT_NEAR(best->find("steer_delay")->value, -0.03, 0.002);
  EXPECT_LT(std::abs(best->find("I_z")->value / study.truth.at("I_z") - 1.0), 0.03);
}

// Eight drives of each campaign vehicle and 24 of rolling cars, in time and with a steering 10 and 20 ms late; five
// minutes. None of the 48 in time is raised; late, all 48 of the campaign vehicles, and 22 of 48 rolling cars: their
// tyres' lag hides the rest, at I_z 5 to 32 % too small. Writes steering_delay.csv.
TEST(SteeringDelaySoak, IsFoundAndNotRaisedWhereThereIsNone) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "a long-running campaign; `make soak` runs it";
  struct Drive {
    std::string subject;
    std::size_t number;
  };
  std::vector<Drive> drives;
  for (const std::string& vehicle : testing::campaign_vehicles())
    for (std::size_t i = 0; i < 8; ++i) drives.push_back({vehicle, i});
  for (std::size_t i = 0; i < 24; ++i) drives.push_back({"rolling car", i});
  constexpr std::array kTyres{testing::CarTyre::kLinear, testing::CarTyre::kFiala, testing::CarTyre::kMagicFormula};
  const auto study_of = [&](const Drive& drive) {
    if (drive.subject != "rolling car") return testing::campaign_drive(drive.subject, 500 + drive.number);
    return testing::rolling_drive(testing::rolling_car(drive.number % 10), kTyres[drive.number % 3],
                                  drive.number % testing::kRollingDrives, 500 + drive.number);
  };
  constexpr std::array kLate_s{0.0, 0.01, 0.02};
  std::vector<Found> results(drives.size() * kLate_s.size());
  numerics::parallel_for(results.size(), 0, [&](std::size_t k) {
    results[k] = found(study_of(drives[k / kLate_s.size()]), kLate_s[k % kLate_s.size()]);
  });
  std::ofstream table("steering_delay.csv");
  table << "subject,drive,late_s,delay_s,outcome,structure,I_z_error,text\n";
  std::size_t alarms = 0, missed = 0, missed_rolling = 0;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const Drive& drive = drives[k / kLate_s.size()];
    const double late_s = kLate_s[k % kLate_s.size()];
    const Found& f = results[k];
    table << fmt::format("{},{},{},{:.5f},{},\"{}\",{:.4f},\"{}\"\n", drive.subject, drive.number, late_s, f.delay_s,
                         to_string(f.outcome), to_string(f.structure), f.I_z_error, f.text);
    const bool raised = f.outcome != Outcome::kPassed;
    if (late_s == 0.0) {
      alarms += raised ? 1 : 0;
    } else if (!raised) {
      (drive.subject == "rolling car" ? missed_rolling : missed) += 1;
    }
  }
  EXPECT_EQ(alarms, 0U);
  EXPECT_EQ(missed, 0U);
  EXPECT_LE(missed_rolling, 28U);  // of 48
}

}  // namespace
}  // namespace veridyn::vehicle
