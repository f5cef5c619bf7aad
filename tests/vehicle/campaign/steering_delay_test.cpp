#include <fmt/format.h>
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
#include "veridyn/numerics/threads/parallel.hpp"
#include "veridyn/vehicle/identification/evidence/drive_evidence.hpp"

/// How late a recorded steering is, by the model that is identified: the source of the limit.
namespace veridyn::vehicle {
namespace {

using estimation::Evidence;
using estimation::Outcome;

struct Found {
  bool refused = false;
  double delay_s = kNaN;
  Outcome outcome = Outcome::kNotVerified;
  DriveStructure structure = DriveStructure::kBicycle;
  double I_z_error = kNaN;
  std::string advice;
};

/// The drive with a steering whose stamps are so late.
Found found(VehicleStudy study, double late_s) {
  test::delayed({"steer"}, late_s)(study.log.mapped.recording);
  const testing::IdentifiedDrive drive = testing::identified(study);
  Found out{.refused = drive.refused};
  if (drive.refused) return out;
  const VehicleIdentification& id = drive.analysis.identification;
  const auto row = std::ranges::find(id.checks, kOrderInTime, &Evidence::name);
  if (row == id.checks.end()) return out;
  out.delay_s = row->value;
  out.outcome = row->outcome;
  out.advice = row->text;
  out.structure = id.structure;
  if (const VehicleEstimate* best = id.best()) out.I_z_error = best->find("I_z")->value / study.truth.at("I_z") - 1.0;
  return out;
}

// 40 drives of each campaign vehicle and 60 of rolling cars, in time and with a steering 5 to 30 ms late. Writes
// steering_delay.csv.
TEST(SteeringDelaySoak, IsFoundAndNotRaisedWhereThereIsNone) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "a long-running campaign; `make soak` runs it";
  constexpr std::size_t kDrives = 24;
  constexpr std::array kLate_s{0.0, 0.015};
  std::vector<std::string> subjects;
  subjects.emplace_back("rolling car");
  std::vector<Found> results(subjects.size() * kDrives * kLate_s.size());
  const auto study_of = [&](std::size_t subject, std::size_t drive) {
    if (subjects[subject] != "rolling car") return testing::campaign_drive(subjects[subject], 500 + drive);
    return testing::rolling_drive(testing::rolling_car(drive / testing::kRollingDrives), testing::CarTyre::kFiala,
                                  drive, 500 + drive);
  };
  numerics::parallel_for(results.size(), 0, [&](std::size_t k) {
    const std::size_t drive = k / kLate_s.size();
    results[k] = found(study_of(drive / kDrives, drive % kDrives), kLate_s[k % kLate_s.size()]);
    fmt::print(stderr, "{} {} {} {} {} {}\n", k, results[k].delay_s, to_string(results[k].outcome),
               to_string(results[k].structure), results[k].I_z_error, results[k].advice);
  });
  std::ofstream table("steering_delay.csv");
  table << "subject,drive,late_s,refused,delay_s,outcome,structure,I_z_error\n";
  for (std::size_t k = 0; k < results.size(); ++k) {
    const std::size_t drive = k / kLate_s.size();
    const Found& f = results[k];
    table << fmt::format("{},{},{},{},{:.5f},{},{},{:.4f}\n", subjects[drive / kDrives], drive % kDrives,
                         kLate_s[k % kLate_s.size()], f.refused ? 1 : 0, f.delay_s, to_string(f.outcome),
                         to_string(f.structure), f.I_z_error);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
