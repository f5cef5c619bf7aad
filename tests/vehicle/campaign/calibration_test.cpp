#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <vector>

#include "tests/support/channel_faults.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/vehicle/campaign/campaign.hpp"
#include "tests/vehicle/campaign/rolling_cars.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

/// Simulation-based calibration (Talts et al. 2018) of drives: cars and errors of their sensors are drawn, the drives
/// identified with default options; calibrated intervals of 95 % hold the truth in 95 of 100.
namespace veridyn::vehicle {
namespace {

/// What the study is not told: as the priors of `kDriveBudget` say, delays in multiples of a sample.
enum class Errors { kNone, kSensors };

struct Interval {
  double error = kNaN, half_width = kNaN;  ///< shares of the truth
  bool identified = false;
  [[nodiscard]] bool holds() const { return std::abs(error) <= half_width; }
};

/// Of C_f, C_r and I_z; fewer where the drive was refused or does not excite them.
std::vector<Interval> intervals_of(std::size_t number, Errors errors) {
  constexpr std::array kTyres{testing::CarTyre::kLinear, testing::CarTyre::kFiala, testing::CarTyre::kMagicFormula};
  VehicleStudy study =
      testing::rolling_drive(testing::rolling_car(100 + number), kTyres[number % kTyres.size()],
                             (number / kTyres.size()) % testing::kRollingDrives, 7000 + number, {.duration_s = 60.0});
  if (errors == Errors::kSensors) {
    numerics::RandomStream draw(number, "errors of a drive's sensors");
    test::delayed({"steer"}, 0.03 * draw.normal())(study.log.mapped.recording);
    test::delayed({"accel_y"}, 0.01 * draw.normal())(study.log.mapped.recording);
    study.signals.accel_position[0] += 0.3 * draw.normal();  // it is at the centre of gravity
  }
  const testing::IdentifiedDrive drive = testing::identified(study);
  std::vector<Interval> out;
  const VehicleEstimate* best = drive.refused ? nullptr : drive.analysis.identification.best();
  if (best == nullptr) return out;
  for (const char* name : {"C_f", "C_r", "I_z"}) {
    const estimation::Parameter* p = best->find(name);
    if (p == nullptr || !std::isfinite(p->sigma)) continue;
    const double truth = study.truth.at(name);
    out.push_back({(p->value - truth) / truth, 0.5 * (p->high95 - p->low95) / truth,
                   p->status == estimation::ParameterStatus::kIdentified});
  }
  return out;
}

struct Calibration {
  std::size_t intervals = 0, held = 0, identified = 0, wrong = 0;  ///< wrong: identified, 10 % off and outside
  double error = 0.0, half_width = 0.0;                            ///< medians
  [[nodiscard]] double coverage() const { return static_cast<double>(held) / static_cast<double>(intervals); }
  [[nodiscard]] std::string text() const {
    return fmt::format(
        "{} of {} intervals hold ({:.0f} %), median error {:.2f} %, half width {:.2f} %; {} of {} "
        "identified are 10 % off and outside",
        held, intervals, 100.0 * coverage(), 100.0 * error, 100.0 * half_width, wrong, identified);
  }
};

Calibration calibration(Errors errors, std::size_t drives) {
  std::vector<std::vector<Interval>> all(drives);
  numerics::parallel_for(drives, 0, [&](std::size_t i) { all[i] = intervals_of(i, errors); });
  Calibration sum;
  std::vector<double> error, half_width;
  for (const std::vector<Interval>& drive : all) {
    for (const Interval& one : drive) {
      ++sum.intervals;
      sum.held += one.holds() ? 1 : 0;
      sum.identified += one.identified ? 1 : 0;
      sum.wrong += one.identified && !one.holds() && std::abs(one.error) > 0.1 ? 1 : 0;
      error.push_back(std::abs(one.error));
      half_width.push_back(one.half_width);
    }
  }
  if (error.empty()) return sum;
  sum.error = numerics::median(error);
  sum.half_width = numerics::median(half_width);
  return sum;
}

// Six cars on three kinds of tyres, with what the priors say of their sensors: a wrong sign, unit or error bar leaves a
// small share.
TEST(DriveCalibration, IntervalsOfSixDrivesHoldTheTruth) {
  if (test::kSanitized) GTEST_SKIP() << "statistics of what other tests run";
  const Calibration c = calibration(Errors::kSensors, 6);
  std::cout << c.text() << "\n";
  // Two of three are gentle: 12 of 15 hold, at half widths of 65 %.
  EXPECT_GE(c.intervals, 12U);
  EXPECT_GE(c.coverage(), 0.7);
  EXPECT_LE(c.wrong, 1U);
}

// 36 cars without errors of sensors and with them.
TEST(DriveCalibrationSoak, IntervalsHoldTheTruth) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "a long-running campaign; `make soak` runs it";
  for (const Errors errors : {Errors::kNone, Errors::kSensors}) {
    const Calibration c = calibration(errors, 36);
    std::cout << (errors == Errors::kNone ? "sensors in time and place: " : "late and out of place: ") << c.text()
              << "\n";
    EXPECT_GE(c.intervals, 100U);
    EXPECT_GE(c.coverage(), 0.9);
    EXPECT_LE(c.wrong, c.identified / 50);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
