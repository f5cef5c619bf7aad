#include "veridyn/aircraft/identification/validation/open_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/aircraft/identification/flown_flight.hpp"
#include "tests/aircraft/model/jsbsim_aircraft.hpp"
#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/jsbsim.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace veridyn::aircraft::testing;

const std::vector<Coefficient> kAll{Coefficient::kCL, Coefficient::kCD, Coefficient::kCY,
                                    Coefficient::kCl, Coefficient::kCm, Coefficient::kCn};

OpenLoopOptions calm(double duration_s, const std::vector<Coefficient>& offsets = OpenLoopOptions().offsets) {
  OpenLoopOptions options;
  options.duration_s = duration_s;
  options.offsets = offsets;
  options.gusts = false;
  return options;
}

OpenLoop fly(const PreparedFlight& flight, const Subject& subject, const OpenLoopOptions& options,
             const estimation::Estimate& estimate = {}, RowUse use = RowUse::kHoldout) {
  Progress quiet;
  return fly_open_loop(std::span(&flight, 1), use, subject, kAll, estimate, options, quiet);
}

const estimation::OpenLoopState& state_of(const OpenLoop& flown, std::string_view name) {
  return *std::ranges::find(flown.states, name, &estimation::OpenLoopState::name);
}

const Evidence& row_of(const std::vector<Evidence>& rows, estimation::Check check, std::string_view about) {
  return *std::ranges::find_if(rows, [&](const Evidence& row) { return row.check == check && row.about == about; });
}

double pooled_inside(const OpenLoop& flown) {
  double inside = 0.0, count = 0.0;
  for (const estimation::OpenLoopState& state : flown.states) {
    inside += state.inside * static_cast<double>(state.fit.count);
    count += static_cast<double>(state.fit.count);
  }
  return inside / count;
}

/// The exported model flown by an independent reading of its JSBSim file: its loads, from the file alone, move a rigid
/// body with inertial velocity and a quaternion, at steps of 1 ms under the recorded inputs.
std::vector<Eigen::Matrix<double, 8, 1>> flown_by_file(const std::string& xml, const FlightSignals& s,
                                                       const estimation::OpenLoopWindow& window, double full_thrust) {
  JsbsimAircraft file(xml);
  const MassProperties body = file.mass();
  std::array<double, 8> start{};
  for (std::size_t i = 0; i < 8; ++i) start[i] = window.start[i].value;
  RigidBodyState<double> x =
      rigid_body_at(start[0], start[1], start[2], {start[3], start[4], start[5]}, start[6], start[7]);
  const auto [first, last] = s.indices(window.span);
  const auto controls = [&](std::size_t k) {
    return Controls<double>{s[FlightSignal::kElevator].value[k], s[FlightSignal::kAileron].value[k],
                            s[FlightSignal::kRudder].value[k], s[FlightSignal::kThrust].value[k] / full_thrust, 0.0};
  };
  std::vector<Eigen::Matrix<double, 8, 1>> out;
  for (std::size_t k = first; k < last; ++k) {
    out.push_back(flown_state(x));
    if (k + 1 == last) break;
    const Controls<double> now = controls(k), next = controls(k + 1);
    const double t = s.grid.at(k), step = s.grid.at(k + 1) - t;
    constexpr int kSteps = 20;
    const auto rate = [&](double moment, const RigidBodyState<double>& y) {
      const Controls<double> c = between(now, next, (moment - t) / step);
      const JsbsimAircraft::Loads l =
          file.loads(R_body_from_ned(y) * y.segment<3>(3), y.tail<3>(), c, s.air_density[k], c.throttle);
      return rigid_body_rate<double>(y, body, l.force, l.moment, kGravity);
    };
    for (int j = 0; j < kSteps; ++j) {
      x = numerics::runge_kutta_4_step(rate, t + step * j / kSteps, x, step / kSteps);
      normalise_attitude(x);
    }
  }
  return out;
}

TEST(OpenLoop, FliesAndScoresAsTheExportedJsbsimFileDoes) {
  const Subject truth = flown_subject();
  // A model that is not the truth, so that there is something to score.
  Subject model = truth;
  for (const Coefficient c : kAll)
    for (double& value : model.model.at(c).values) value *= 1.03;
  const PreparedFlight flight = flown(truth, {.duration_s = 10.0});
  const OpenLoop open = fly(flight, model, calm(10.0, {}));
  ASSERT_EQ(open.windows.size(), 2u) << "one of each axis, the same 10 s";
  ASSERT_EQ(open.states.size(), 8u);
  const std::string xml = write_jsbsim(model);
  constexpr std::array kStates{"airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch"};
  for (const estimation::OpenLoopWindow& window : open.windows) {
    const auto theirs = flown_by_file(xml, flight.signals, window, 60.0);
    for (std::size_t i = 0; i < kStates.size(); ++i) {
      const estimation::OpenLoopState& ours = state_of(open, kStates[i]);
      if (ours.group != window.group) continue;
      ASSERT_EQ(ours.predicted.size(), theirs.size() + 1) << "and the gap behind the window";
      double largest = 0.0;
      for (const auto& y : theirs) largest = std::max(largest, std::abs(y(i)));
      std::vector<double> measured, predicted;
      const double factor = ours.unit == "m/s" ? 1.0 : 1.0 / kDegree;
      for (std::size_t k = 0; k < theirs.size(); ++k) {
        const double y = theirs[k](signed_index(i));
        ASSERT_NEAR(ours.predicted[k], y, 1e-6 * largest) << ours.name << " at " << ours.time[k] << " s";
        if (ours.time[k] < window.forecast_from) continue;
        measured.push_back(factor * ours.measured[k]);
        predicted.push_back(factor * y);
      }
      const numerics::FitMeasures fit = numerics::fit_measures(measured, predicted);
      EXPECT_NEAR(ours.fit.rmse, fit.rmse, 1e-6 * fit.rmse) << ours.name;
      EXPECT_NEAR(ours.fit.theil, fit.theil, 1e-6 * fit.theil) << ours.name;
      EXPECT_NEAR(ours.normalised_rmse, std::sqrt(1.0 - fit.r2), 1e-6 * ours.normalised_rmse) << ours.name;
      EXPECT_NEAR(ours.shares.covariance, numerics::theil_shares(measured, predicted).covariance, 1e-6) << ours.name;
    }
  }
}

// The bands are those of sensors and initial state alone: 95 % of 8 states of 4 windows of 400 samples each, whose
// errors are white but for the initial state that a window's samples share.
TEST(OpenLoop, OfTheTrueModelHasTheMeasurementsInItsBands) {
  const Subject truth = flown_subject();
  const PreparedFlight flight = flown(truth);
  const OpenLoop open = fly(flight, truth, calm(10.0));
  EXPECT_EQ(open.windows.size(), 8u);
  EXPECT_NEAR(pooled_inside(open), 0.95, 0.02);
  for (const estimation::OpenLoopState& state : open.states) {
    EXPECT_GT(state.inside, 0.85) << state.name;
    EXPECT_EQ(state.held, state.windows) << state.name;
    EXPECT_NEAR(state.horizon_s, 8.0, 0.03) << state.name;
    EXPECT_LT(state.fit.theil, 0.25) << state.name << ": beta moves by little more than its noise";
  }
  EXPECT_LT(state_of(open, "airspeed").fit.theil, 0.01);
  EXPECT_LT(state_of(open, "q").normalised_rmse, 0.1);
  for (const Evidence& row : open_loop_evidence(open)) EXPECT_TRUE(row.passed()) << says(row);
}

// Models drawn from a covariance, with bands that know it: theirs cover too.
TEST(OpenLoop, BandsHoldTheErrorsOfTheParametersAndWhatTheInitialStateMakesUpForThem) {
  const Subject truth = flown_subject();
  estimation::Estimate estimate;
  std::vector<double> values;
  for (const Coefficient c : kAll) {
    const std::vector<std::string> names = truth.model.at(c).parameter_names();
    for (std::size_t i = 0; i < names.size(); ++i) {
      estimate.parameters.push_back({.name = names[i]});
      values.push_back(truth.model.at(c).values[i]);
    }
  }
  const auto n = signed_index(values.size());
  estimate.covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) estimate.covariance(i, i) = std::pow(0.06 * values[i], 2.0);
  numerics::RandomStream random(4, "models");
  double inside = 0.0, without = 0.0;
  constexpr int kDraws = 6, kCompared = 2;
  for (int draw = 0; draw < kDraws; ++draw) {
    Subject model = truth;
    std::size_t place = 0;
    for (const Coefficient c : kAll)
      for (double& value : model.model.at(c).values) value += 0.06 * values[place++] * random.normal();
    const PreparedFlight flight = flown(truth, {.duration_s = 20.0, .seed = static_cast<std::uint64_t>(draw) + 10});
    const OpenLoopOptions options = calm(10.0);
    inside += pooled_inside(fly(flight, model, options, estimate)) / kDraws;
    if (draw < kCompared) without += pooled_inside(fly(flight, model, options)) / kCompared;
  }
  // Errors of 6 models with some 10 parameters each that matter: the share scatters by 0.02.
  EXPECT_NEAR(inside, 0.95, 0.04);
  EXPECT_LT(without, 0.8) << "the covariance must matter";
}

TEST(OpenLoop, OfAWrongCoefficientLeavesItsBandsSoonAndTheRowFails) {
  const Subject truth = flown_subject();
  const PreparedFlight flight = flown(truth);
  const OpenLoopOptions options = calm(10.0);
  for (const auto& [name, term, state] :
       {std::tuple{Coefficient::kCm, "de", "q"}, std::tuple{Coefficient::kCl, "da", "p"},
        std::tuple{Coefficient::kCn, "beta", "r"}}) {
    Subject wrong = truth;
    CoefficientModel& model = wrong.model.at(name);
    const auto names = model.parameter_names();
    const auto at = std::ranges::find(names, parameter_name(name, parse_term(term, "test"))) - names.begin();
    model.values[at] *= 1.3;
    const OpenLoop open = fly(flight, wrong, options);
    EXPECT_LT(state_of(open, state).horizon_s, 4.0) << state << " is held for 8 s by the true model";
    EXPECT_LT(state_of(open, state).held, state_of(open, state).windows) << state;
    const std::string axis = to_string(axis_of(name));
    const Evidence row = row_of(open_loop_evidence(open), estimation::Check::kOpenLoopHorizon, axis);
    EXPECT_LT(row.value, row.limit) << says(row);
    // The stiffness in yaw moves little of what the doublets make, and the aircraft turns back all the same: care.
    EXPECT_EQ(row.outcome, name == Coefficient::kCn ? Outcome::kCare : Outcome::kFailed) << says(row);
  }
}

// A trim of its own in every flight is no error of the derivatives: found in the first seconds, it does not drift.
TEST(OpenLoop, FindsTheConstantThatAnotherTrimIs) {
  const Subject truth = flown_subject();
  const PreparedFlight flight = flown(truth, {.duration_s = 20.0});
  Subject elsewhere = truth;
  elsewhere.model.at(Coefficient::kCl).values[0] -= 0.002;
  elsewhere.model.at(Coefficient::kCm).values[0] -= 0.01;
  const OpenLoop found = fly(flight, elsewhere, calm(10.0));
  const OpenLoop drifts = fly(flight, elsewhere, calm(10.0, {}));
  ASSERT_THAT(found.offsets, ElementsAre("Cl", "Cm", "Cn"));
  for (const estimation::OpenLoopWindow& window : found.windows) {
    ASSERT_EQ(window.start.size(), 8u + 3u);
    // Sensor noise of two seconds leaves 2e-5 of Cl and 2e-4 of Cm.
    EXPECT_NEAR(window.start[8].value, 0.002, 2e-4);
    EXPECT_NEAR(window.start[9].value, 0.010, 2e-3);
    EXPECT_NEAR(window.start[10].value, 0.0, 2e-4);
  }
  EXPECT_NEAR(pooled_inside(found), 0.95, 0.04);
  EXPECT_LT(pooled_inside(drifts), 0.5);
  EXPECT_EQ(state_of(drifts, "roll").held, 0u);
  EXPECT_TRUE(drifts.windows.front().start.size() == 8u && drifts.offsets.empty());
}

TEST(OpenLoop, LooksAtNothingThatIdentificationOfItsAxisHasUsed) {
  const Subject truth = flown_subject();
  PreparedFlight flight = flown(truth, {.duration_s = 40.0, .rate_Hz = 25.0});
  AxisSegments &longitudinal = flight.segments.longitudinal, &lateral = flight.segments.lateral;
  longitudinal.excited = {{5.0, 35.0}};
  longitudinal.holdout = {{10.0, 16.0}, {24.0, 26.0}};  // the last ends before there is anything to forecast
  longitudinal.identification = {{5.0, 9.5}, {16.5, 23.5}};
  lateral.excited = lateral.identification = {{5.0, 35.0}};
  lateral.holdout.clear();
  const OpenLoop open = fly(flight, truth, calm(60.0));
  // Longer than the held-out span: into the half second that neither use has.
  ASSERT_EQ(open.windows.size(), 1u);
  EXPECT_NEAR(open.windows[0].span.begin, 10.0, 0.02);
  EXPECT_NEAR(open.windows[0].span.end, 16.5, 0.05);
  EXPECT_NEAR(open.windows[0].forecast_from, 12.0, 0.02);
  for (const estimation::OpenLoopState& state : open.states) EXPECT_EQ(state.group, "longitudinal") << state.name;
  // An estimate from elsewhere has seen nothing of the flight.
  const OpenLoop all = fly(flight, truth, calm(60.0), {}, RowUse::kExcited);
  ASSERT_EQ(all.windows.size(), 2u);
  EXPECT_NEAR(all.windows[0].span.begin, 5.0, 0.03);
  EXPECT_NEAR(all.windows[0].span.end, 40.0, 0.05);
}

TEST(OpenLoop, OfSeveralFlightsScoresThemTogetherAndEachByItself) {
  const Subject truth = flown_subject();
  std::vector<PreparedFlight> flights;
  flights.push_back(flown(truth, {.duration_s = 10.0, .rate_Hz = 25.0, .seed = 1, .name = "quiet.csv"}));
  flights.push_back(flown(truth, {.duration_s = 10.0, .rate_Hz = 25.0, .noise = 5.0, .seed = 2, .name = "noisy.csv"}));
  flights[1].shift_s = 100.0;
  Progress quiet;
  const OpenLoop open = fly_open_loop(flights, RowUse::kHoldout, truth, kAll, {}, calm(10.0), quiet);
  ASSERT_EQ(open.by_recording.size(), 2u);
  EXPECT_EQ(open.by_recording[1].recording, "noisy.csv");
  const auto& noisy = open.by_recording[1].states;
  for (std::size_t i = 0; i < open.states.size(); ++i) {
    const estimation::OpenLoopState &all = open.states[i], &first = open.by_recording[0].states[i];
    EXPECT_EQ(all.fit.count, first.fit.count + noisy[i].fit.count);
    // Squares add up; the noise of the second is five times that of the first.
    const double n1 = static_cast<double>(first.fit.count), n2 = static_cast<double>(noisy[i].fit.count);
    EXPECT_NEAR(std::pow(all.fit.rmse, 2.0),
                (n1 * std::pow(first.fit.rmse, 2.0) + n2 * std::pow(noisy[i].fit.rmse, 2.0)) / (n1 + n2),
                1e-9 * std::pow(all.fit.rmse, 2.0));
    EXPECT_GT(noisy[i].fit.rmse, 2.0 * first.fit.rmse) << all.name;
    EXPECT_GT(noisy[i].inside, 0.8) << all.name << ": each flight has the errors of its own sensors";
    EXPECT_GE(all.time.back(), 100.0);
  }
}

TEST(OpenLoop, OfAModelThatDivergesIsCutThereAndTheRowFails) {
  const Subject truth = flown_subject();
  Subject unstable = truth;
  unstable.model.at(Coefficient::kCm).values[1] = 1.5;
  const OpenLoop open = fly(flown(truth, {.duration_s = 10.0, .rate_Hz = 25.0}), unstable, calm(10.0));
  ASSERT_FALSE(open.windows.empty());
  EXPECT_TRUE(open.windows[0].diverged);
  const auto rows = open_loop_evidence(open);
  EXPECT_EQ(row_of(rows, estimation::Check::kOpenLoopDivergence, "").outcome, Outcome::kFailed);
  EXPECT_THAT(open.text, HasSubstr("diverged and were cut"));
}

TEST(OpenLoop, TakesAsMeasuredWhatNoCoefficientMoves) {
  const Subject truth = flown_subject();
  const PreparedFlight flight = flown(truth, {.duration_s = 10.0, .rate_Hz = 25.0});
  Progress quiet;
  const auto with = [&](const std::vector<Coefficient>& known) {
    return fly_open_loop(std::span(&flight, 1), RowUse::kHoldout, truth, known, {}, {{.duration_s = 10.0}}, quiet);
  };
  const OpenLoop open = with({Coefficient::kCL, Coefficient::kCm});
  ASSERT_EQ(open.states.size(), 3u);
  EXPECT_THAT(open.driven, ElementsAre("airspeed", "beta", "p", "r", "roll"));
  EXPECT_THAT(open.offsets, ElementsAre("Cm"));
  EXPECT_FALSE(open.air_known) << "neither a ground velocity nor the study says that the air was calm";
  EXPECT_THAT(with({}).text, HasSubstr("no coefficient that moves a state"));
  EXPECT_TRUE(open_loop_evidence(with({})).empty());
  const OpenLoop nothing = fly(flight, truth, {});
  EXPECT_TRUE(nothing.text.empty() && !nothing.available()) << "nothing is flown that is not asked for";
}

TEST(OpenLoop, IsTheSameOnAnyNumberOfThreads) {
  const Subject truth = flown_subject();
  const PreparedFlight flight = flown(truth, {.duration_s = 20.0, .rate_Hz = 25.0});
  const OpenLoopOptions options = calm(5.0);
  const auto on = [&](int threads) {
    TerminalProgress progress(true, threads);
    return fly_open_loop(std::span(&flight, 1), RowUse::kHoldout, truth, kAll, {}, options, progress);
  };
  const OpenLoop one = on(1), three = on(3);
  ASSERT_EQ(one.states.size(), three.states.size());
  for (std::size_t i = 0; i < one.states.size(); ++i) EXPECT_EQ(one.states[i].fit.rmse, three.states[i].fit.rmse);
}

}  // namespace
}  // namespace veridyn::aircraft
