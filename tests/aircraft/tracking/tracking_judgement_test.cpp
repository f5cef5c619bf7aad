#include "veridyn/aircraft/tracking/tracking_judgement.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <mutex>
#include <optional>

#include "tests/aircraft/campaign/campaign.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/track_flight.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::campaign_flight;
using estimation::Evidence;
using estimation::Grade;

/// The progress of a flight among others.
class OneThreadOnly : public Progress {
 public:
  [[nodiscard]] int threads() const override { return 1; }
};

struct OnLineCoverage {
  int all = 0, covered = 0;
  int flights = 0, data_yes = 0;
};

/// Intervals at the end of tracked flights in moderate turbulence, of what is identified and not rejected.
OnLineCoverage coverage_on_line(const std::string& aircraft, std::uint64_t seeds) {
  OnLineCoverage coverage;
  std::mutex adding;
  numerics::parallel_for(seeds, 0, [&](std::size_t seed) {
    OneThreadOnly silent;
    std::optional<FlightStudy> flown;
    try {
      flown = campaign_flight(aircraft, seed + 1, 300.0);
    } catch (const InputError&) {
      return;  // its turbulence upsets the aircraft: no flight, as in the campaign
    }
    const FlightStudy& study = *flown;
    const estimation::Estimate estimate = track_flight(study, silent).flight.estimate();
    const std::lock_guard lock(adding);
    ++coverage.flights;
    coverage.data_yes += estimate.judgement.data.grade == Grade::kYes;
    for (const auto& model : study.true_subject->model.coefficients) {
      if (!model) continue;
      const std::vector<std::string> names = model->parameter_names();
      for (std::size_t i = 0; i < names.size(); ++i) {
        const estimation::Parameter* p = estimate.find(names[i]);
        if (p == nullptr || p->status != estimation::ParameterStatus::kIdentified) continue;
        ++coverage.all;
        coverage.covered += model->values[i] >= p->low95 && model->values[i] <= p->high95;
      }
    }
  });
  return coverage;
}

const Evidence* row_named(const estimation::Estimate& estimate, const std::string& name, const std::string& about) {
  for (const Evidence& row : estimate.evidence)
    if (name_of(row) == name && row.about == about) return &row;
  return nullptr;
}

const Evidence* row_of(const estimation::Estimate& estimate, estimation::Check check, const std::string& about) {
  for (const Evidence& row : estimate.evidence)
    if (row.check == check && row.about == about) return &row;
  return nullptr;
}

TEST(TrackingJudgement, GradesACleanFlightAndSaysWhatItRestsOn) {
  Progress silent;
  const FlightStudy study = campaign_flight("unatrap", 1, 150.0);
  const estimation::Estimate estimate = track_flight(study, silent).flight.estimate();
  EXPECT_EQ(estimate.judgement.data.grade, Grade::kYes);
  EXPECT_NE(estimate.judgement.parameters.grade, Grade::kNo);
  EXPECT_EQ(estimate.judgement.prediction.grade, Grade::kYes);
  // Rows of the recording, those of identify, and rows of every coefficient.
  EXPECT_NE(row_of(estimate, estimation::Check::kDeflections, "controls"), nullptr);
  EXPECT_TRUE(row_of(estimate, estimation::Check::kPlausibleSign, "Cm_q")->passed());
  for (const char* name : {"CL", "CD", "CY", "Cl", "Cm", "Cn"}) {
    const Evidence* row = row_named(estimate, "residual beyond the sensors", name);
    ASSERT_NE(row, nullptr) << name;
    EXPECT_TRUE(row->passed()) << name << ": " << says(*row);
  }
}

TEST(TrackingJudgement, ARecordingThatContradictsItselfIsSaidToBe) {
  Progress silent;
  FlightStudy study = campaign_flight("unatrap", 1, 150.0);
  aircraft::testing::fault("gyro y reversed").apply(study);
  const estimation::Estimate estimate = track_flight(study, silent).flight.estimate();
  EXPECT_EQ(estimate.judgement.data.grade, Grade::kNo);
  EXPECT_NE(estimate.judgement.parameters.grade, Grade::kYes);
  for (const estimation::Parameter& p : estimate.parameters)
    EXPECT_NE(p.status, estimation::ParameterStatus::kIdentified) << p.name;
}

TEST(TrackingJudgement, SaysThatALiveRecordingWasNotChecked) {
  Progress silent;
  const FlightStudy study = campaign_flight("unatrap", 1, 60.0);
  TrackedFlight live(study);
  (void)live.advance(study.mapped, study, false, silent);
  const estimation::Estimate before = live.estimate();
  EXPECT_EQ(before.judgement.data.grade, Grade::kNotJudged);
  EXPECT_NE(row_of(before, estimation::Check::kUncheckedRecording, ""), nullptr);
  live.check_recording(study.mapped, study, {}, silent);
  EXPECT_EQ(live.estimate().judgement.data.grade, Grade::kYes);
}

TEST(TrackingJudgement, IntervalsOnLineHoldTheTruthInTurbulence) {
  // 3 flights of some 25 parameters, which depend on each other: a standard error of about 4 %.
  const OnLineCoverage coverage = coverage_on_line("unatrap", 3);
  ASSERT_GT(coverage.all, 50);
  EXPECT_GE(static_cast<double>(coverage.covered), 0.85 * coverage.all);
}

/// Cm of an aircraft with this damping, followed over two minutes in which alpha, q and elevator move independently.
TrackedCoefficient tracked_cm(double Cm_q) {
  const CoefficientModel model{
      Coefficient::kCm, {parse_term("1", "t"), parse_term("alpha", "t"), parse_term("q_n", "t")}, {0.02, -0.7, Cm_q}};
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(4, 4);
  W.diagonal() << 0.0, 1e-6, 1e-8, 1e-6;
  TrackedCoefficient c{.model = model};
  c.tracker.emplace(model, W, TrackOptions{}, 20.0);
  numerics::RandomStream random(7, "tracked Cm");
  for (int k = 0; k < 2400; ++k) {
    const double t = 0.05 * k, alpha = 0.05 * std::sin(1.1 * t), q = 0.005 * std::sin(1.7 * t);
    const std::array<double, 3> x{1.0, alpha + 1e-3 * random.normal(), q + 1e-4 * random.normal()};
    static_cast<void>(c.tracker->update(t, x, 0.02 - 0.7 * alpha + Cm_q * q + 1e-3 * random.normal()));
  }
  return c;
}

// The rows of a tracker are tested with it; here are those that know that it is an aircraft.
TEST(TrackedEvidence, AsksWhetherAnAircraftHasSuchValues) {
  const Subject subject = builtin_subject("thor");
  const auto row = [&](double Cm_q) {
    const std::vector<Evidence> rows = tracked_evidence(tracked_cm(Cm_q), subject);
    return *std::ranges::find(rows, estimation::Check::kPlausibleSign, &Evidence::check);
  };
  EXPECT_EQ(row(-10.0).outcome, estimation::Outcome::kPassed) << says(row(-10.0));
  EXPECT_EQ(row(10.0).outcome, estimation::Outcome::kCare) << says(row(10.0));
  // What was held was not measured.
  TrackedCoefficient unknown = tracked_cm(10.0);
  const Eigen::MatrixXd W = unknown.tracker->regression().options().error_covariance;
  unknown.tracker.emplace(unknown.model, W, TrackOptions{}, 20.0);
  for (const Evidence& e : tracked_evidence(unknown, subject)) EXPECT_NE(e.check, estimation::Check::kPlausibleSign);
}

// The table of docs/tracking.md: track_coverage.md in the working folder.
TEST(TrackingJudgementSoak, IntervalsOnLineHoldTheTruthInTurbulence) {
  std::ofstream table("track_coverage.md");
  table << "| aircraft | flights | data yes | coverage on line |\n|---|---|---|---|\n";
  for (const char* aircraft : {"unatrap", "aerosonde", "x8"}) {
    const OnLineCoverage coverage = coverage_on_line(aircraft, 20);
    const double share = static_cast<double>(coverage.covered) / coverage.all;
    table << fmt::format("| {} | {} | {} | {:.1f} % of {} |\n", aircraft, coverage.flights, coverage.data_yes,
                         100.0 * share, coverage.all);
    EXPECT_GE(share, 0.85) << aircraft;
    EXPECT_GE(coverage.flights, 18) << aircraft;
  }
}

}  // namespace
}  // namespace veridyn::aircraft
