#include "veridyn/aircraft/identification/open_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/aircraft/identification/flown_flight.hpp"
#include "tests/aircraft/model/jsbsim_aircraft.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/jsbsim.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace veridyn::aircraft::testing;

const std::vector<Coefficient> kAll{Coefficient::kCL, Coefficient::kCD, Coefficient::kCY,
                                    Coefficient::kCl, Coefficient::kCm, Coefficient::kCn};

OpenLoop fly(const PreparedFlight& flight, const Subject& subject, const OpenLoopOptions& options,
             const estimation::Estimate& estimate = {}, RowUse use = RowUse::kHoldout) {
  Progress quiet;
  return fly_open_loop(std::span(&flight, 1), use, subject, kAll, estimate, options, quiet);
}

const OpenLoopState& state_of(const OpenLoop& flown, std::string_view name) {
  return *std::ranges::find(flown.states, name, &OpenLoopState::name);
}

const Evidence& row_of(const std::vector<Evidence>& rows, std::string_view name, std::string_view about) {
  return *std::ranges::find_if(rows, [&](const Evidence& row) { return row.name == name && row.about == about; });
}

double pooled_inside(const OpenLoop& flown) {
  double inside = 0.0, count = 0.0;
  for (const OpenLoopState& state : flown.states) {
    inside += state.inside * static_cast<double>(state.fit.count);
    count += static_cast<double>(state.fit.count);
  }
  return inside / count;
}

/// The exported model flown by an independent reading of its JSBSim file: its loads, from the file alone, move a rigid
/// body with inertial velocity and a quaternion, at steps of 1 ms under the recorded inputs.
std::vector<Eigen::Matrix<double, 8, 1>> flown_by_file(const std::string& xml, const FlightSignals& s,
                                                       const OpenLoopWindow& window, double full_thrust) {
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
  const OpenLoop open = fly(flight, model, {.duration_s = 10.0, .start_s = 2.0, .offsets = {}, .gusts = false});
  ASSERT_EQ(open.windows.size(), 2u) << "one of each axis, the same 10 s";
  ASSERT_EQ(open.states.size(), 8u);
  const std::string xml = write_jsbsim(model);
  constexpr std::array kStates{"airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch"};
  for (const OpenLoopWindow& window : open.windows) {
    const auto theirs = flown_by_file(xml, flight.signals, window, 60.0);
    for (std::size_t i = 0; i < kStates.size(); ++i) {
      const OpenLoopState& ours = state_of(open, kStates[i]);
      if (ours.axis != window.axis) continue;
      ASSERT_EQ(ours.predicted.size(), theirs.size() + 1) << "and the gap behind the window";
      double largest = 0.0;
      for (const auto& y : theirs) largest = std::max(largest, std::abs(y(signed_index(i))));
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
  const OpenLoop open = fly(flight, truth, {.duration_s = 10.0, .gusts = false});
  EXPECT_EQ(open.windows.size(), 8u);
  EXPECT_NEAR(pooled_inside(open), 0.95, 0.02);
  for (const OpenLoopState& state : open.states) {
    EXPECT_GT(state.inside, 0.85) << state.name;
    EXPECT_EQ(state.held, state.windows) << state.name;
    EXPECT_NEAR(state.horizon_s, 8.0, 0.03) << state.name;
    EXPECT_LT(state.fit.theil, 0.25) << state.name << ": beta moves by little more than its noise";
  }
  EXPECT_LT(state_of(open, "airspeed").fit.theil, 0.01);
  EXPECT_LT(state_of(open, "q").normalised_rmse, 0.1);
  for (const Evidence& row : open_loop_evidence(open)) EXPECT_TRUE(row.passed()) << row.text;
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
  for (Eigen::Index i = 0; i < n; ++i) estimate.covariance(i, i) = std::pow(0.06 * values[at(i)], 2.0);
  numerics::RandomStream random(4, "models");
  double inside = 0.0, without = 0.0;
  constexpr int kDraws = 8;
  for (int draw = 0; draw < kDraws; ++draw) {
    Subject model = truth;
    std::size_t place = 0;
    for (const Coefficient c : kAll)
      for (double& value : model.model.at(c).values) value += 0.06 * values[place++] * random.normal();
    const PreparedFlight flight = flown(truth, {.duration_s = 20.0, .seed = static_cast<std::uint64_t>(draw) + 10});
    const OpenLoopOptions options{.duration_s = 10.0, .gusts = false};
    inside += pooled_inside(fly(flight, model, options, estimate)) / kDraws;
    without += pooled_inside(fly(flight, model, options)) / kDraws;
  }
  // Errors of 8 models with some 10 parameters each that matter: the share scatters by 0.02.
  EXPECT_NEAR(inside, 0.95, 0.04);
  EXPECT_LT(without, 0.8) << "the covariance must matter";
}

TEST(OpenLoop, OfAWrongCoefficientLeavesItsBandsSoonAndTheRowFails) {
  const Subject truth = flown_subject();
  const PreparedFlight flight = flown(truth);
  const OpenLoopOptions options{.duration_s = 10.0, .gusts = false};
  for (const auto& [name, term, state] :
       {std::tuple{Coefficient::kCm, "de", "q"}, std::tuple{Coefficient::kCl, "da", "p"},
        std::tuple{Coefficient::kCn, "beta", "r"}}) {
    Subject wrong = truth;
    CoefficientModel& model = wrong.model.at(name);
    const auto names = model.parameter_names();
    const auto at = std::ranges::find(names, parameter_name(name, parse_term(term, "test"))) - names.begin();
    model.values[static_cast<std::size_t>(at)] *= 1.3;
    const OpenLoop open = fly(flight, wrong, options);
    EXPECT_LT(state_of(open, state).horizon_s, 4.0) << state << " is held for 8 s by the true model";
    EXPECT_LT(state_of(open, state).held, state_of(open, state).windows) << state;
    const std::string axis = to_string(axis_of(name));
    const Evidence row = row_of(open_loop_evidence(open), "open loop horizon", axis);
    EXPECT_LT(row.value, row.limit) << row.text;
    // The stiffness in yaw moves little of what the doublets make, and the aircraft turns back all the same: care.
    EXPECT_EQ(row.outcome, name == Coefficient::kCn ? Outcome::kCare : Outcome::kFailed) << row.text;
  }
}

}  // namespace
}  // namespace veridyn::aircraft
