#include "veridyn/aircraft/aircraft_study.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/aircraft/exact_sensors.hpp"
#include "tests/aircraft/simulated_flight.hpp"
#include "tests/aircraft/stripped_recording.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/aircraft/track_flight.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

FlightStudy calm_study(double duration, const std::string& more) {
  Progress silent;
  return read_study(Study::parse(fmt::format("seed = 3\n[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = {}\n"
                                             "airspeed = 20\nturbulence = \"none\"\n[sensors]\nset = \"reference\"\n"
                                             "[reconstruct]\nsensors = \"reference\"\nturbulence = \"none\"\n{}",
                                             duration, more),
                                 "calm.toml"),
                    silent);
}

// The recording of the study stays as it was read; the one with the delays taken off is part of the analysis.
TEST(AircraftStudy, IsNotChangedByItsAnalysis) {
  const FlightStudy study = calm_study(20.0, "[delays]\nautomatic = false\ngps = \"50 ms\"\n");
  Progress silent;
  const FlightAnalysis analysis = reconstruct(study, silent);
  ASSERT_EQ(analysis.flights.front().delays.size(), 1u);
  EXPECT_EQ(study.mapped.recording.at("vel_north").times().front(), 0.0);
  EXPECT_DOUBLE_EQ(analysis.flights.front().aligned.recording.at("vel_north").times().front(), -0.05);
  EXPECT_FALSE(analysis.interrupted);
}

/// Of the coefficients that a result names.
std::vector<std::string> identified_in(const FlightAnalysis& analysis) {
  std::vector<std::string> names;
  for (const CoefficientResult& r : analysis.coefficients)
    if (r.verdict == estimation::GroupVerdict::kIdentified) names.push_back(r.name);
  return names;
}

FlightStudy stripped(FlightStudy study, const std::vector<std::string>& channels) {
  study.mapped.recording = aircraft::testing::without(study.mapped.recording, channels);
  return study;
}

// Without accelerometer no filter runs and no force is measured: the moments are left. Without beta vane in addition,
// the pitching moment.
TEST(AircraftStudy, IdentifiesWhatTheRecordedSensorsShow) {
  Progress silent;
  const FlightStudy study = calm_study(150.0, "");
  const std::vector<std::string> forces{"accel_x", "accel_y", "accel_z"};
  const FlightAnalysis moments = identify(stripped(study, forces), silent);
  EXPECT_EQ(moments.flights.front().reconstruction.filter, FilterKind::kNone);
  EXPECT_EQ(identified_in(moments), (std::vector<std::string>{"Cl", "Cm", "Cn"}));
  EXPECT_THAT(moments.estimate.warnings, ::testing::Contains(::testing::HasSubstr("no accelerometer")));
  const FlightAnalysis pitching =
      identify(stripped(study, {"accel_x", "accel_y", "accel_z", "beta", "roll", "pitch", "yaw"}), silent);
  EXPECT_EQ(identified_in(pitching), (std::vector<std::string>{"Cm"}));
}

/// A flight of an aircraft whose rudder does nothing once it is trimmed, recorded as never moved.
Recording flown_without_rudder() {
  SimulationOptions o;
  o.subject = builtin_subject("unatrap", "test");
  AeroModel model = o.subject.model;
  for (auto& coefficient : model.coefficients) {
    if (!coefficient) continue;
    for (std::size_t i = 0; i < coefficient->size(); ++i)
      if (coefficient->terms[i].expression == "dr") coefficient->values[i] = 0.0;
  }
  o.changes = {{.time = 0.01, .model = model, .text = "the rudder does nothing"}};
  o.duration = 150.0;
  o.airspeed = 20.0;
  o.seed = 3;
  Progress silent;
  Recording recording = simulate(o, silent).measured;
  Channel rudder = recording.at("rudder");
  std::ranges::fill(rudder.value, 0.0);
  recording.set(std::move(rudder));
  return recording;
}

// Aileron alone does not tell what yaw rate and sideslip do to Cl and Cn: they are not excited, and nothing is
// rejected.
TEST(AircraftStudy, ASurfaceThatIsZeroThroughoutRejectsNothing) {
  Progress silent;
  FlightStudy study = aircraft::testing::with_exact_sensors(calm_study(150.0, ""));
  study.mapped.recording = flown_without_rudder();
  const FlightAnalysis analysis = identify(study, silent);
  EXPECT_EQ(identified_in(analysis), (std::vector<std::string>{"CL", "CD", "CY", "Cm"}))
      << analysis.coefficients[2].reason;
  for (const CoefficientResult& r : analysis.coefficients)
    EXPECT_NE(r.verdict, estimation::GroupVerdict::kRejected) << r.reason;
  for (const char* name : {"CY_dr", "Cl_dr", "Cn_dr"}) {
    const estimation::Parameter* const p = analysis.estimate.find(name);
    ASSERT_NE(p, nullptr) << name;
    EXPECT_EQ(p->status, estimation::ParameterStatus::kNotExcited) << name;
  }
}

// As on a transport aircraft: 0.4 deg of elevator, by sensors good enough to see it.
TEST(AircraftStudy, IdentifiesFromGentleManoeuvres) {
  std::string text =
      "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 120\nairspeed = 20\nturbulence = \"none\"\n";
  for (const double start : {20.0, 50.0, 80.0})
    text += fmt::format(
        "[[flight.manoeuvre]]\nkind = \"3211\"\nstart = {}\nsurfaces = [\"elevator\"]\namplitude = \"0.4 deg\"\n"
        "pulse = 0.4\n",
        start);
  text +=
      "[sensors]\nset = \"perfect\"\n[reconstruct]\nsensors = \"reference\"\nturbulence = \"none\"\n"
      "[reconstruct.sigma]\naccelerometer = 0.005\ngyro = 0.0005\nattitude = 0.001\nvelocity = 0.01\n"
      "velocity_down = 0.01\ndynamic_pressure = 0.5\nalpha = 0.0005\nbeta = 0.0005\n";
  Progress silent;
  const FlightStudy study = read_study(Study::parse(text, "gentle.toml"), silent);
  const FlightAnalysis analysis = identify(study, silent);
  EXPECT_EQ(analysis.flights.front().segments.longitudinal.excited.size(), 3U);
  EXPECT_THAT(identified_in(analysis), ::testing::IsSupersetOf({"CL", "Cm"}));
  const CoefficientModel& truth = *study.subject.model.find(Coefficient::kCm);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const estimation::Parameter* const p = analysis.estimate.find(parameter_name(Coefficient::kCm, truth.terms[i]));
    ASSERT_NE(p, nullptr);
    EXPECT_NEAR(p->value, truth.values[i], 2.0 * (p->high95 - p->low95)) << p->name;
    EXPECT_NEAR(p->value, truth.values[i], 0.1 * std::abs(truth.values[i]) + 0.01) << p->name;
  }
}

TEST(AircraftStudy, DoesWithoutAFilterWhereThatIsAskedFor) {
  Progress silent;
  FlightStudy study = calm_study(150.0, "filter = \"none\"\n");
  EXPECT_EQ(study.reconstruct.filter, FilterKind::kNone);
  const FlightAnalysis analysis = identify(study, silent);
  EXPECT_EQ(identified_in(analysis).size(), 6U);
  EXPECT_TRUE(analysis.validation.available());
  study.mapped.recording = aircraft::testing::without(study.mapped.recording, {"dynamic_pressure", "airspeed"});
  EXPECT_THAT(why([&] { static_cast<void>(identify(study, silent)); }),
              ::testing::HasSubstr("reconstruct.filter = \"none\" needs an airspeed"));
}

TEST(AircraftStudy, ValidatesAndTracksWithoutMotionOverGround) {
  Progress silent;
  const FlightStudy study =
      stripped(calm_study(150.0, "[identify]\noutput_error = true\ncoefficients = [\"CL\", \"Cm\"]\n"),
               {"vel_north", "vel_east", "vel_down", "yaw"});
  const FlightAnalysis identified = identify(study, silent);
  EXPECT_EQ(identified_in(identified).size(), 2U);
  EXPECT_FALSE(identified.flights.front().signals.over_ground) << "output error takes the air to be calm";
  EXPECT_FALSE(identified.others.parameters.empty());
  EXPECT_EQ(identified_in(validate(study, identified.estimate, silent)).size(), 2U);
  EXPECT_GT(track_flight(study, silent).flight.tracker().rows(), 0U);
}

TEST(AircraftStudy, RefusesAnAircraftThatNeverFlies) {
  FlightStudy study = calm_study(5.0, "");
  study.segments.min_airspeed_mps = 60.0;
  Progress silent;
  try {
    static_cast<void>(identify(study, silent));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("the aircraft never flies: the airspeed does not exceed"));
  }
}

TEST(AircraftStudy, FindsTheTermsOfTheTrueModelAmongCandidates) {
  Progress silent;
  const FlightStudy study =
      calm_study(150.0,
                 "[identify]\nstructure = \"orthogonal\"\ncoefficients = [\"Cm\", \"Cl\"]\n"
                 "[identify.candidates]\n"
                 "Cm = [\"1\", \"alpha\", \"q_n\", \"de\", \"alpha^2\", \"alpha*de\", \"de^2\"]\n");
  const FlightAnalysis a = identify(study, silent);
  ASSERT_EQ(a.coefficients.size(), 2u);
  for (const CoefficientResult& r : a.coefficients) {
    ASSERT_TRUE(r.structure.has_value());
    EXPECT_EQ(r.verdict, estimation::GroupVerdict::kIdentified) << r.reason;
    // Strong terms must be there; Cl_dr of -0.0037 may be found or not.
    const std::vector<const char*> strong = r.coefficient == Coefficient::kCm
                                                ? std::vector<const char*>{"alpha", "q_n", "de"}
                                                : std::vector<const char*>{"beta", "p_n", "da"};
    for (const char* term : strong) EXPECT_TRUE(r.model.value_of(term).has_value()) << term;
    EXPECT_LE(r.model.size(), 8u);
    EXPECT_EQ(r.model.size(), r.structure->selected.size());
    // What is exported has the chosen terms.
    EXPECT_EQ(a.identified.model.at(r.coefficient).size(), r.model.size());
  }
}

std::vector<estimation::Evidence> rows_of(const FlightAnalysis& analysis, estimation::Check check) {
  std::vector<estimation::Evidence> rows;
  for (const estimation::Evidence& row : analysis.estimate.evidence)
    if (row.check == check) rows.push_back(row);
  return rows;
}

TEST(AircraftStudy, ARightModelFliesOverTheHoldOutBetterThanMeanAndLastValue) {
  Progress silent;
  const FlightStudy study = calm_study(150.0, "");
  const FlightAnalysis analysis = identify(study, silent);
  for (const auto check : {estimation::Check::kFlownOverHoldOut, estimation::Check::kFlownAgainstLast}) {
    ASSERT_FALSE(rows_of(analysis, check).empty());
    for (const estimation::Evidence& row : rows_of(analysis, check)) EXPECT_TRUE(row.passed()) << says(row);
  }
  // Another aircraft's lift, flown although it does not explain the coefficient: alpha goes to where it is the weight.
  FlightStudy demanding_nothing = study;
  demanding_nothing.identify.min_holdout_r2 = -1e6;
  estimation::Estimate wrong = analysis.estimate;
  for (estimation::Parameter& p : wrong.parameters)
    if (p.name == "CL_0") p.value -= 0.3;
  const FlightAnalysis validated = validate(demanding_nothing, wrong, silent);
  for (const auto check : {estimation::Check::kFlownOverHoldOut, estimation::Check::kFlownAgainstLast}) {
    const std::vector<estimation::Evidence> rows = rows_of(validated, check);
    const auto of_alpha = std::ranges::find(rows, "alpha", &estimation::Evidence::about);
    ASSERT_NE(of_alpha, rows.end());
    EXPECT_FALSE(of_alpha->passed()) << says(*of_alpha);
  }
  EXPECT_NE(validated.estimate.judgement.prediction.grade, estimation::Grade::kYes);
}

TEST(AircraftStudy, AnEstimateThatWasRejectedNeverHolds) {
  Progress silent;
  const FlightStudy study = calm_study(150.0, "[identify]\ncoefficients = [\"CL\", \"Cm\"]\n");
  estimation::Estimate estimate = identify(study, silent).estimate;
  for (estimation::Parameter& p : estimate.parameters)
    if (p.name.starts_with("Cm")) p.status = estimation::ParameterStatus::kRejected;
  const FlightAnalysis validated = validate(study, estimate, silent);
  const auto of = [&](const char* name) {
    return *std::ranges::find(validated.coefficients, name, &CoefficientResult::name);
  };
  EXPECT_THAT(of("CL").reason, ::testing::HasSubstr("holds"));
  EXPECT_THAT(of("Cm").reason, ::testing::Not(::testing::HasSubstr("holds")));
  EXPECT_THAT(of("Cm").reason, ::testing::HasSubstr("rejected where it was identified"));
  EXPECT_FALSE(estimation::usable(of("Cm").verdict));
}

// Calm air, perfect sensors, servos without lag that are sampled at 100 Hz: what is left is how well the moment of a
// jump between two samples is known. Taken as it is sampled, Cl_p of the aerosonde is 7.7 % off, of the skywalker 1.1
// %.
TEST(AircraftStudy, FindsTheDampingInRollThoughDeflectionsJumpBetweenSamples) {
  for (const auto& [aircraft, tolerance] : {std::pair{"aerosonde", 0.01}, std::pair{"skywalker_2013", 0.005}}) {
    Progress silent;
    const FlightStudy study = read_study(
        Study::parse(fmt::format("seed = 1\n[subject]\nbuiltin = \"{}\"\n[flight]\nduration = 200\naltitude = 300\n"
                                 "turbulence = \"none\"\n[sensors]\nset = \"perfect\"\n[reconstruct]\n"
                                 "turbulence = \"none\"\n[identify]\ncoefficients = [\"Cl\"]\n",
                                 aircraft),
                     "calm.toml"),
        silent);
    const FlightAnalysis a = identify(study, silent);
    const estimation::Parameter* p = estimation::find_parameter(a.groups.front().parameters, "Cl_p");
    ASSERT_NE(p, nullptr);
    EXPECT_NEAR(p->value / a.truth.at("Cl_p"), 1.0, tolerance) << aircraft;
  }
}

}  // namespace
}  // namespace veridyn::aircraft
