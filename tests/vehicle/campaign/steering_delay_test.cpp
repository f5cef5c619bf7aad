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
  double I_z_sigma = kNaN;  ///< the same
  bool I_z_inside = false;  ///< whether its interval of 95 % holds the truth
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
  if (const VehicleEstimate* best = id.best()) {
    const estimation::Parameter* I_z = best->find("I_z");
    const double truth = study.truth.at("I_z");
    out.I_z_error = I_z->value / truth - 1.0;
    out.I_z_sigma = I_z->sigma / truth;
    out.I_z_inside = I_z->low95 <= truth && truth <= I_z->high95;
  }
  return out;
}

// A hand wheel that is 30 ms late took more than half of I_z.
TEST(SteeringDelay, IsEstimatedAndCorrectedByDefault) {
  const VehicleStudy study = testing::campaign_drive("reference bicycle", 500);
  for (const double late_s : {0.0, 0.03}) {
    const Found f = found(study, late_s);
    EXPECT_EQ(f.outcome, Outcome::kPassed) << f.text;
    EXPECT_NEAR(f.delay_s, -late_s, 0.002);
    // Of eight such drives half are within 3.7 %.
    EXPECT_LT(std::abs(f.I_z_error), 2.0 * f.I_z_sigma);
    // At one speed 3 % of the steering's scale are 7 % of I_z.
    EXPECT_LT(f.I_z_sigma, 0.1);
    EXPECT_EQ(f.about, "steer, yaw_rate");
  }
}

// Eight drives of each campaign vehicle and 24 of rolling cars, in time and with a steering 10 and 20 ms late; five
// minutes. Writes steering_delay.csv.
TEST(SteeringDelaySoak, LeavesTheYawInertiaWithinItsIntervals) {
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
  table << "subject,drive,late_s,delay_s,outcome,structure,I_z_error,inside,text\n";
  std::size_t alarms = 0, inside = 0, judged = 0;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const Drive& drive = drives[k / kLate_s.size()];
    const double late_s = kLate_s[k % kLate_s.size()];
    const Found& f = results[k];
    table << fmt::format("{},{},{},{:.5f},{},\"{}\",{:.4f},{:d},\"{}\"\n", drive.subject, drive.number, late_s,
                         f.delay_s, to_string(f.outcome), to_string(f.structure), f.I_z_error, f.I_z_inside, f.text);
    if (f.outcome != Outcome::kPassed) ++alarms;
    if (!std::isfinite(f.I_z_error)) continue;
    ++judged;
    if (f.I_z_inside) ++inside;
  }
  EXPECT_EQ(alarms, 0U);
  EXPECT_GE(inside, judged * 9 / 10) << inside << " of " << judged;
}

}  // namespace
}  // namespace veridyn::vehicle
