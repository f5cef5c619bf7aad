#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "tests/support/channel_faults.hpp"
#include "tests/support/interval_count.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/vehicle/campaign/campaign.hpp"
#include "tests/vehicle/campaign/rolling_cars.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

/// Simulation-based calibration (Talts et al. 2018) of drives: cars and errors of their sensors are drawn, the drives
/// identified with default options; calibrated intervals of 95 % hold the truth in 95 of 100.
namespace veridyn::vehicle {
namespace {

/// What the study is not told: as the priors of `kDriveBudget` say, delays in multiples of a sample.
enum class Errors { kNone, kSensors };

struct Known {
  estimation::Parameter estimate;
  double truth = 0.0;
};

/// Of C_f, C_r and I_z; fewer where the drive was refused or does not excite them.
std::vector<Known> intervals_of(std::size_t number, Errors errors) {
  constexpr std::array kTyres{testing::CarTyre::kLinear, testing::CarTyre::kFiala, testing::CarTyre::kMagicFormula};
  VehicleStudy study =
      testing::rolling_drive(testing::rolling_car(100 + number), kTyres[number % kTyres.size()],
                             (number / kTyres.size()) % testing::kRollingDrives, 7000 + number, {.duration_s = 60.0});
  if (errors == Errors::kSensors) {
    numerics::RandomStream draw(number, "errors of a drive's sensors");
    test::delayed({"steer"}, 0.02 * draw.normal())(study.log.mapped.recording);
    test::scaled({"steer"}, 1.0 + vehicle::kSteerScalePrior.sigma * draw.normal())(study.log.mapped.recording);
    test::delayed({"accel_y"}, 0.01 * draw.normal())(study.log.mapped.recording);
    study.signals.accel_position[0] += 0.3 * draw.normal();  // it is at the centre of gravity
    study.signals.accel_position[2] += 0.2 * draw.normal();
  }
  const testing::IdentifiedDrive drive = testing::identified(study);
  std::vector<Known> out;
  const VehicleEstimate* best = drive.refused ? nullptr : drive.analysis.identification.best();
  if (best == nullptr) return out;
  for (const char* name : {"C_f", "C_r", "I_z"}) {
    const estimation::Parameter* p = best->find(name);
    if (p != nullptr && std::isfinite(p->sigma)) out.push_back({*p, study.truth.at(name)});
  }
  return out;
}

test::IntervalCount calibration(Errors errors, std::size_t drives) {
  std::vector<std::vector<Known>> all(drives);
  numerics::parallel_for(drives, 0, [&](std::size_t i) { all[i] = intervals_of(i, errors); });
  test::IntervalCount count;
  for (const std::vector<Known>& drive : all)
    for (const Known& one : drive) (void)count.add(one.estimate, one.truth);
  return count;
}

std::string text_of(const test::IntervalCount& c) {
  return fmt::format(
      "{} of {} intervals hold ({:.0f} %), median error {:.2f} %, half width {:.2f} %; {} of {} "
      "identified are 10 % off and outside",
      c.held(), c.intervals(), 100.0 * c.coverage(), 100.0 * c.median_error(), 100.0 * c.median_half_width(), c.wrong(),
      c.identified());
}

// Six cars on three kinds of tyres, with what the priors say of their sensors: a wrong sign, unit or error bar leaves a
// small share.
TEST(DriveCalibration, IntervalsOfSixDrivesHoldTheTruth) {
  if (test::kSanitized) GTEST_SKIP() << "statistics of what other tests run";
  const test::IntervalCount c = calibration(Errors::kSensors, 6);
  std::cout << text_of(c) << "\n";
  // Two of three are gentle: 17 of 18 hold, at half widths of 53 %.
  EXPECT_GE(c.intervals(), 15U);
  EXPECT_GE(c.coverage(), 0.8);
  EXPECT_LE(c.wrong(), 1U);
}

// 36 cars without errors of sensors and with them.
TEST(DriveCalibrationSoak, IntervalsHoldTheTruth) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "a long-running campaign; `make soak` runs it";
  for (const Errors errors : {Errors::kNone, Errors::kSensors}) {
    const test::IntervalCount c = calibration(errors, 36);
    std::cout << (errors == Errors::kNone ? "sensors in time and place: " : "late and out of place: ") << text_of(c)
              << "\n";
    EXPECT_GE(c.intervals(), 100U);
    EXPECT_GE(c.coverage(), 0.9);
    EXPECT_LE(c.wrong(), c.identified() / 50);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
