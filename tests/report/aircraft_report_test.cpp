#include "veridyn/report/aircraft_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

#include "tests/report/flight_by_hand.hpp"
#include "tests/report/shown.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct AnalysedFlight {
  aircraft::FlightStudy study;
  aircraft::FlightAnalysis analysis;
};

/// The elevator is moved twice for half a minute in calm air.
aircraft::FlightStudy short_flight() {
  Progress silent;
  return aircraft::read_study(Study::parse(R"toml(seed = 1
[subject]
builtin = "unatrap"
[flight]
duration = 100
airspeed = 20
[[flight.manoeuvre]]
kind = "multisine"
start = 15
duration = 30
surfaces = ["elevator"]
[[flight.manoeuvre]]
kind = "multisine"
start = 60
duration = 30
surfaces = ["elevator"]
[reconstruct]
sensors = "reference"
turbulence = "none"
[delays]
automatic = false
[identify]
coefficients = ["Cm", "CY"]
[uncertainty]
enabled = false
)toml",
                                           "flight.toml"),
                              silent);
}

/// Identified once; the tests do not change it.
const AnalysedFlight& identified_flight() {
  static const AnalysedFlight flight = [] {
    AnalysedFlight made{.study = short_flight(), .analysis = {}};
    Progress silent;
    made.analysis = aircraft::identify(made.study, silent);
    return made;
  }();
  return flight;
}

TEST(IdentificationReport, SaysWhatThePilotMayUseAndWhatTheFlightDoesNotExcite) {
  const AnalysedFlight& f = identified_flight();
  const Document document = identification_report(f.study, f.analysis, {.program = "veridyn test"});
  check(document);
  EXPECT_EQ(document.subtitle, "Identified from flight");
  EXPECT_EQ(document.generator, "Made with veridyn test");
  ASSERT_EQ(f.analysis.coefficients.size(), 2U);
  EXPECT_EQ(test::fact_of(document.facts, "Identified"), "pitching moment (Cm)");
  EXPECT_EQ(test::fact_of(document.facts, "Not excited by this flight"), "side force (CY)");
  EXPECT_EQ(test::fact_of(document.facts, "Recording"), "simulated from the study");
  EXPECT_THAT(test::fact_of(document.facts, "Excited"), HasSubstr("0 s lateral"));
  EXPECT_THAT(test::fact_of(document.facts, "Mass"), HasSubstr(" kg"));
  EXPECT_THAT(test::titles_of(document),
              AllOf(Contains("Coefficients"), Contains("Parameters"), Contains("Estimates of all methods"),
                    Contains("What was checked"), Contains("Validation on held-out data"), Contains("The flight"),
                    Contains("Excitation"), Contains("Residuals"), Contains("How it was done")));
  EXPECT_THAT(test::titles_of(document), Not(Contains("Uncertainty of the measured coefficients")));
  const FactList how = test::blocks_of<FactList>(test::section_of(document, "How it was done").blocks).at(0);
  EXPECT_EQ(test::fact_of(how.facts, "Seed"), "1");
  EXPECT_EQ(test::fact_of(how.facts, "Estimator"), "auto");
  EXPECT_THAT(test::fact_of(how.facts, "alpha regressed on"), HasSubstr(" deg"));
  EXPECT_THAT(test::fact_of(how.facts, "p regressed on"), HasSubstr(" deg/s"));
  EXPECT_THAT(test::fact_of(how.facts, "accel_z regressed on"), HasSubstr(" m/s^2"));
  EXPECT_THAT(test::blocks_of<Paragraph>(test::section_of(document, "How it was done").blocks).at(0).text,
              AllOf(HasSubstr("a model-free extended Kalman filter"), HasSubstr("total least squares")));
}

TEST(IdentificationReport, SaysHowWithoutAFilterAndByOutputError) {
  AnalysedFlight f = identified_flight();
  aircraft::PreparedFlight& flight = f.analysis.flights.front();
  flight.reconstruction.filter = aircraft::FilterKind::kNone;
  flight.signals[aircraft::FlightSignal::kAz].value.clear();
  f.study.identify.choose_output_error = true;
  const Section how =
      test::section_of(identification_report(f.study, f.analysis, {.program = "veridyn test", .command = "identify"}),
                       "How it was done");
  EXPECT_EQ(test::fact_of(test::blocks_of<FactList>(how.blocks).at(0).facts, "accel_z regressed on"), "");
  EXPECT_THAT(test::blocks_of<Paragraph>(how.blocks).at(0).text,
              AllOf(HasSubstr("taken as recorded, without a filter"), HasSubstr("(output error)"),
                    Not(HasSubstr("Kalman")), Not(HasSubstr("least squares"))));
}

TEST(IdentificationReport, OfAGivenEstimateHasNoParametersOfItsOwn) {
  const AnalysedFlight& f = identified_flight();
  const Document document =
      identification_report(f.study, f.analysis, {.program = "veridyn test", .command = "validate"});
  check(document);
  EXPECT_EQ(document.subtitle, "A given estimate validated on this flight");
  for (const char* title : {"Parameters", "Estimates of all methods", "Excitation", "Residuals"})
    EXPECT_THAT(test::titles_of(document), Not(Contains(title)));
}

TEST(IdentificationReport, SortsCoefficientsByWhatBecameOfThem) {
  aircraft::FlightAnalysis analysis;
  analysis.flights.emplace_back();
  analysis.flights.front().reconstruction.contradiction.emplace();
  analysis.coefficients = {test::drag_by_hand(), test::pitch_by_hand()};
  analysis.coefficients.push_back(test::pitch_by_hand());
  analysis.coefficients.back().coefficient = aircraft::Coefficient::kCn;
  analysis.coefficients.back().name = "Cn";
  analysis.coefficients.back().verdict = estimation::GroupVerdict::kRejected;
  const Document document = identification_report({}, analysis, {.program = "veridyn test"});
  check(document);
  EXPECT_EQ(test::fact_of(document.facts, "Identified"), "pitching moment (Cm)");
  EXPECT_EQ(test::fact_of(document.facts, "Rejected"), "yawing moment (Cn)");
  EXPECT_EQ(test::fact_of(document.facts, "Not attempted"), "drag (CD)");
}

TEST(IdentificationReport, BeginsWithTheHoldOutOfWhatPredicts) {
  AnalysedFlight f{.study = short_flight(), .analysis = identified_flight().analysis};
  const auto lead_of = [&] {
    return test::blocks_of<TimeSeries>(identification_report(f.study, f.analysis, {.program = "veridyn test"}).lead);
  };
  const std::vector<TimeSeries> identified = lead_of();
  ASSERT_FALSE(identified.empty());
  const Panel& pitch = identified.front().panels.front();
  EXPECT_EQ(pitch.label, "Cm");
  ASSERT_EQ(pitch.lines.size(), 2U);
  const TimeSpan held_out = f.analysis.flights.front().segments.longitudinal.holdout.front();
  EXPECT_EQ(identified.front().windows.front().from, held_out.begin);
  EXPECT_GE(pitch.lines.front().x.front(), held_out.begin) << "what is not shown is not stored";
  const auto cm = std::ranges::find(f.analysis.coefficients, "Cm", &aircraft::CoefficientResult::name);
  cm->verdict = estimation::GroupVerdict::kEffective;
  EXPECT_EQ(lead_of().front().panels.front().label, "Cm (effective)");
  EXPECT_EQ(lead_of().front().panels.front().lines.size(), 2U);
  cm->verdict = estimation::GroupVerdict::kRejected;
  EXPECT_EQ(lead_of().front().panels.front().lines.size(), 1U) << "a rejected model is not shown";
}

TEST(IdentificationReport, ShowsTheFlightFromTakeOffToLanding) {
  AnalysedFlight f{.study = short_flight(), .analysis = identified_flight().analysis};
  std::vector<TimeSpan>& airborne = f.analysis.flights.front().segments.airborne;
  ASSERT_EQ(airborne.size(), 1U);
  airborne.front().begin += 10.0;
  const double margin = 0.03 * (airborne.front().end - airborne.front().begin);
  const Document document = identification_report(f.study, f.analysis, {.program = "veridyn test"});
  for (const TimeSeries& figure : test::blocks_of<TimeSeries>(test::section_of(document, "The flight").blocks)) {
    for (const Panel& panel : figure.panels)
      for (const Line& line : panel.lines) EXPECT_NEAR(line.x.front(), airborne.front().begin - margin, 0.3);
  }
}

// Where two sensors contradict each other there is no motion to show.
TEST(IdentificationReport, ShowsNoMotionThatContradictsItself) {
  AnalysedFlight f{.study = short_flight(), .analysis = identified_flight().analysis};
  f.analysis.flights.front().reconstruction.contradiction.emplace();
  const Document document = identification_report(f.study, f.analysis, {.program = "veridyn test"});
  check(document);
  for (const char* title : {"The flight", "Excitation", "How it was done"})
    EXPECT_THAT(test::titles_of(document), Not(Contains(title)));
  EXPECT_THAT(test::titles_of(document), Contains("Sensors and state estimation"));
}

TEST(ReconstructionReport, SaysWhatTheSensorsDoNotDetermine) {
  AnalysedFlight f{.study = short_flight(), .analysis = identified_flight().analysis};
  const auto weak = [&](const std::string& quantity, aircraft::Observability observability) {
    aircraft::QuantityReport q;
    q.quantity = quantity;
    q.observability = observability;
    return q;
  };
  using aircraft::Observability;
  f.analysis.flights.front().reconstruction.quantities = {weak("airspeed", Observability::kObservable),
                                                          weak("gyro_bias_x", Observability::kNotObservable)};
  const Document good = reconstruction_report(f.study, f.analysis, {.program = "veridyn test"});
  check(good);
  EXPECT_EQ(good.verdict.level, Level::kGood) << "a bias of the gyro is no air data";
  f.analysis.flights.front().reconstruction.quantities.push_back(weak("beta", Observability::kWeak));
  f.analysis.flights.front().reconstruction.quantities.push_back(weak("wind_north", Observability::kNotObservable));
  const Document document = reconstruction_report(f.study, f.analysis, {.program = "veridyn test"});
  EXPECT_EQ(document.verdict.level, Level::kCaution);
  EXPECT_EQ(document.verdict.headline, "The sensors of this flight do not determine beta, wind_north: mind the bands.");
}

TEST(ReconstructionReport, NamesAContradictionAndShowsAsFarAsItGot) {
  aircraft::FlightAnalysis analysis;
  analysis.flights.emplace_back();
  analysis.flights.front().reconstruction.contradiction.emplace();
  analysis.flights.front().reconstruction.contradiction->statement = "vel_down contradicts the accelerometer";
  analysis.flights.front().reconstruction.warnings = {"ended at 12 s"};
  const Document document = reconstruction_report({}, analysis, {.program = "veridyn test"});
  check(document);
  EXPECT_EQ(document.verdict.level, Level::kBad);
  EXPECT_EQ(document.verdict.word, "Contradiction");
  EXPECT_EQ(document.verdict.headline, "vel_down contradicts the accelerometer.");
  EXPECT_THAT(test::titles_of(document), ElementsAre("Sensors and state estimation", "Warnings"));
}

}  // namespace
}  // namespace veridyn::report
