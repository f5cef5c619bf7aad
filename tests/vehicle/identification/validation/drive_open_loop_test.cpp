#include "veridyn/vehicle/identification/validation/drive_open_loop.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"
#include "veridyn/vehicle/tyre/fiala_tyre.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Evidence;
using estimation::OpenLoopState;
using estimation::OpenLoopWindow;
using estimation::Outcome;
using ::testing::ElementsAre;
using testing::family_car;
using ::testing::HasSubstr;
using testing::lively_drive;
using testing::mapped;
using testing::WanderingSteer;

/// An estimate with these values, whose relative standard errors are `sigma`.
estimation::Estimate estimate_of(const std::vector<std::pair<const char*, double>>& values, double sigma = 0.0) {
  estimation::Estimate estimate;
  const auto n = static_cast<Eigen::Index>(values.size());
  estimate.covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& [name, value] = values[i];
    estimate.parameters.push_back({.name = name, .value = value, .sigma = sigma * std::abs(value)});
    estimate.covariance(i, i) = std::pow(sigma * value, 2.0);
  }
  return estimate;
}

estimation::Estimate bicycle_estimate(const VehicleParameters<double>& p, double sigma = 0.0) {
  return estimate_of({{"C_f", p.C_f}, {"C_r", p.C_r}, {"I_z", p.I_z}}, sigma);
}

/// All of a drive at hand, none of which the identification has seen.
struct Drive {
  DriveSignals signals;
  DriveSegments segments;

  Drive(const VehicleTrajectory& trajectory, const DriveSensorSet& sensors, std::uint64_t seed)
      : signals(prepare_drive_signals(mapped(record_drive(trajectory, sensors, seed)), {})) {
    // The last inputs have no neighbours from which what lies between them is interpolated.
    segments.usable = {{1.0, signals.grid.at(signals.size() - 1) - 0.1}};
    segments.excited = segments.holdout = segments.usable;
  }
  [[nodiscard]] DriveOpenLoop driven(const VehicleParameters<double>& vehicle, const estimation::Estimate& estimate,
                                     const DriveOpenLoopOptions& options,
                                     OpenLoopUse use = OpenLoopUse::kOtherDrive) const {
    Progress silent;
    return drive_open_loop({signals, segments, use, vehicle, DriveModelOptions(), estimate}, options, silent);
  }
};

const OpenLoopState& state_of(const DriveOpenLoop& driven, std::string_view name) {
  return *std::ranges::find(driven.states, name, &OpenLoopState::name);
}

const Evidence& row_of(const std::vector<Evidence>& rows, estimation::Check check) {
  return *std::ranges::find(rows, check, &Evidence::check);
}

double pooled_inside(const DriveOpenLoop& driven) {
  double inside = 0.0, count = 0.0;
  for (const OpenLoopState& state : driven.states) {
    inside += state.inside * static_cast<double>(state.fit.count);
    count += static_cast<double>(state.fit.count);
  }
  return inside / count;
}

/// Forces of one tyre of an axle whose wheels have the static load `load`, shares `moved` of it moved sideways.
using AxleForce = std::function<double(double slip, double load, double moved)>;

/// A car that leans or does not: its equations of motion (ISO 8855), written out here once more.
struct WrittenCar {
  VehicleParameters<double> p;
  AxleForce front, rear;
  bool leans = false;
  double gradient = 0.0, frequency = 0.0, damping = 0.0, arm = 0.0;
  double share = 0.0, balance = 0.0;  // of the load transfer at 1 g
  double relaxation = 0.0;            // 0: slips do not lag

  /// v, r, roll, roll rate, slip in front, slip behind.
  using State = std::array<double, 6>;
  struct Motion {
    State rate;
    double accel_y = 0.0;
  };
  [[nodiscard]] Motion at(const State& x, double delta, double u) const {
    const double L = p.a + p.b, sideways = x[0] + (leans ? arm * x[3] : 0.0);
    double slip_f = delta - std::atan((sideways + p.a * x[1]) / u), slip_r = -std::atan((sideways - p.b * x[1]) / u);
    Motion out;
    if (relaxation > 0.0) {
      out.rate[4] = u / relaxation * (slip_f - x[4]);
      out.rate[5] = u / relaxation * (slip_r - x[5]);
      slip_f = x[4];
      slip_r = x[5];
    } else {
      out.rate[4] = out.rate[5] = 0.0;
    }
    const double leaned = leans ? (x[2] + 2.0 * damping / frequency * x[3]) / (kGravity * gradient) : 0.0;
    const double F_f = front(slip_f, 0.5 * p.mass * kGravity * p.b / L, share * (1.0 + balance) * leaned);
    const double F_r = rear(slip_r, 0.5 * p.mass * kGravity * p.a / L, share * (1.0 - balance) * leaned);
    const double a_y = 2.0 * (F_f * std::cos(delta) + F_r) / p.mass;
    out.rate[0] = a_y - u * x[1];
    out.rate[1] = 2.0 * (p.a * F_f * std::cos(delta) - p.b * F_r) / p.I_z;
    out.rate[2] = leans ? x[3] : 0.0;
    out.rate[3] = leans ? frequency * frequency * (gradient * a_y - x[2]) - 2.0 * damping * frequency * x[3] : 0.0;
    out.accel_y = a_y + (leans ? kGravity * x[2] : 0.0);
    return out;
  }
};

double brush(double C, double mu, double slip, double load) {
  const double S = C * std::abs(slip), N = mu * load;
  if (S >= 3.0 * N) return std::copysign(N, slip);
  return std::copysign(S - S * S / (3.0 * N) + S * S * S / (27.0 * N * N), slip);
}

double magic(double K, double mu, double C, double E, double slip, double load) {
  const double D = mu * load, B = K / (C * D), x = B * slip;
  return D * std::sin(C * std::atan(x - E * (x - std::atan(x))));
}

/// Sine tones, as exact between samples as on them.
double smooth_steer(double t) { return 0.03 * std::sin(1.9 * t) + 0.02 * std::sin(4.7 * t + 0.6); }
double smooth_speed(double t) { return 18.0 + 3.0 * std::sin(0.3 * t); }

/// The written car's motion from its state at t0, at steps of 0.5 ms with inputs at their own moments: yaw rate and
/// accel_y at the samples of 100 Hz.
std::array<std::vector<double>, 2> written_motion(const WrittenCar& car, WrittenCar::State x, double t0,
                                                  std::size_t samples) {
  constexpr int kSteps = 20;
  constexpr double h = 0.01 / kSteps;
  std::array<std::vector<double>, 2> out;
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = t0 + 0.01 * static_cast<double>(k);
    out[0].push_back(x[1]);
    out[1].push_back(car.at(x, smooth_steer(t), smooth_speed(t)).accel_y);
    for (int i = 0; i < kSteps; ++i) {
      const auto rate = [&](double moment, const WrittenCar::State& y) {
        return car.at(y, smooth_steer(moment), smooth_speed(moment)).rate;
      };
      const auto moved = [&](const WrittenCar::State& by, double step) {
        WrittenCar::State y = x;
        for (std::size_t j = 0; j < y.size(); ++j) y[j] += step * by[j];
        return y;
      };
      const double at = t + h * i;
      const auto k1 = rate(at, x), k2 = rate(at + 0.5 * h, moved(k1, 0.5 * h));
      const auto k3 = rate(at + 0.5 * h, moved(k2, 0.5 * h)), k4 = rate(at + h, moved(k3, h));
      for (std::size_t j = 0; j < x.size(); ++j) x[j] += h / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]);
    }
  }
  return out;
}

/// A drive whose recorded motion is that of the family car, exact, and whose inputs are the smooth ones.
Drive smooth_drive(double duration) {
  return {testing::drive_bicycle<BicycleModel<double, LinearTyre<double>>>(
              [](double) { return testing::linear_bicycle(family_car()); }, duration, smooth_steer, smooth_speed),
          testing::perfect_sensors(), 1};
}

struct Written {
  const char* name;
  estimation::Estimate estimate;
  WrittenCar car;
};

/// Cars that are not the one that was driven, so that there is something to score.
std::vector<Written> written_cars() {
  VehicleParameters<double> p = family_car();
  p.C_f *= 1.05;
  p.I_z *= 0.95;
  const std::vector<std::pair<const char*, double>> bicycle{{"C_f", p.C_f}, {"C_r", p.C_r}, {"I_z", p.I_z}};
  const auto with = [&](const std::vector<std::pair<const char*, double>>& more) {
    auto all = bicycle;
    all.insert(all.end(), more.begin(), more.end());
    return estimate_of(all);
  };
  const auto linear = [](double C) { return AxleForce([C](double slip, double, double) { return C * slip; }); };
  const auto fiala = [](double C, double mu) {
    return AxleForce([C, mu](double slip, double load, double moved) {
      return 0.5 * (brush(C, mu, slip, load * (1.0 + moved)) + brush(C, mu, slip, load * (1.0 - moved)));
    });
  };
  const auto formula = [](double C) {
    return AxleForce([C](double slip, double load, double) { return magic(C, 0.9, 1.4, 0.2, slip, load); });
  };
  WrittenCar plain{.p = p, .front = linear(p.C_f), .rear = linear(p.C_r)};
  WrittenCar leaning = plain;
  leaning.leans = true;
  leaning.gradient = 0.008;
  leaning.frequency = 9.0;
  leaning.damping = 0.3;
  leaning.arm = 0.4;
  WrittenCar sliding = leaning;
  sliding.front = fiala(p.C_f, 0.8);
  sliding.rear = fiala(p.C_r, 0.8);
  sliding.share = 0.6;
  sliding.balance = 0.1;
  sliding.relaxation = 0.4;
  WrittenCar pacejka = plain;
  pacejka.front = formula(p.C_f);
  pacejka.rear = formula(p.C_r);
  const std::vector<std::pair<const char*, double>> roll{
      {"roll_gradient", 0.008}, {"roll_frequency", 9.0}, {"roll_damping", 0.3}, {"roll_arm", 0.4}};
  auto saturation = roll;
  saturation.insert(saturation.end(),
                    {{"mu", 0.8}, {"load_transfer", 0.6}, {"load_transfer_balance", 0.1}, {"relaxation_length", 0.4}});
  return {{"linear bicycle", with({}), plain},
          {"leaning", with(roll), leaning},
          {"leaning, Fiala tyres, load transfer, relaxation", with(saturation), sliding},
          {"Magic Formula", with({{"mu", 0.9}, {"C", 1.4}, {"E", 0.2}}), pacejka}};
}

TEST(DriveOpenLoop, DrivesAndScoresAsEquationsWrittenOutHere) {
  const Drive drive = smooth_drive(22.0);
  for (const Written& written : written_cars()) {
    SCOPED_TRACE(written.name);
    const DriveOpenLoop driven =
        drive.driven(family_car(), written.estimate, {.times = {.duration_s = 60.0, .start_s = 2.0}, .offsets = {{}}});
    ASSERT_EQ(driven.windows.size(), 1u);
    const OpenLoopWindow& window = driven.windows[0];
    EXPECT_NEAR(window.span.duration(), 20.9, 0.02) << "the whole drive in one window";
    // Roll, its rate and lagging slips are what they differ by from steady cornering.
    WrittenCar::State x{};
    for (std::size_t i = 0; i < window.start.size(); ++i) x[i] = window.start[i].value;
    const double delta = smooth_steer(window.span.begin), u = smooth_speed(window.span.begin);
    WrittenCar steady = written.car;
    steady.relaxation = 0.0;
    steady.share = 0.0;
    const double a_y = steady.at({x[0], x[1], 0.0, 0.0, 0.0, 0.0}, delta, u).rate[0] + u * x[1];
    if (written.car.leans) x[2] += written.car.gradient * a_y;
    if (written.car.relaxation > 0.0) {
      x[4] += delta - std::atan((x[0] + steady.p.a * x[1]) / u);
      x[5] += -std::atan((x[0] - steady.p.b * x[1]) / u);
    }
    const OpenLoopState& yaw_rate = state_of(driven, "yaw_rate");
    const std::size_t n = yaw_rate.predicted.size() - 1;
    const auto theirs = written_motion(written.car, x, window.span.begin, n);
    for (const auto& [name, motion] : {std::pair{"yaw_rate", &theirs[0]}, std::pair{"accel_y", &theirs[1]}}) {
      const OpenLoopState& ours = state_of(driven, name);
      double largest = 0.0;
      for (const double y : *motion) largest = std::max(largest, std::abs(y));
      std::vector<double> measured, predicted;
      for (std::size_t k = 0; k < n; ++k) {
        ASSERT_NEAR(ours.predicted[k], (*motion)[k], 1e-6 * largest) << name << " at " << ours.time[k] << " s";
        if (ours.time[k] < window.forecast_from) continue;
        measured.push_back(estimation::shown_factor(ours) * ours.measured[k]);
        predicted.push_back(estimation::shown_factor(ours) * (*motion)[k]);
      }
      const numerics::FitMeasures fit = numerics::fit_measures(measured, predicted);
      EXPECT_NEAR(ours.fit.rmse, fit.rmse, 1e-4 * fit.rmse) << name;
      EXPECT_NEAR(ours.normalised_rmse, std::sqrt(1.0 - fit.r2), 1e-4 * ours.normalised_rmse) << name;
      EXPECT_NEAR(ours.shares.covariance, numerics::theil_shares(measured, predicted).covariance, 1e-4) << name;
      EXPECT_GT(ours.normalised_rmse, 1e-3) << "a model of another car must miss it";
    }
  }
}

// Sensors' noise is white, and the model exact: a share of 95 % of 60 000 samples, which share the biases of a drive.
TEST(DriveOpenLoop, OfTheTrueModelHasTheMeasurementsInItsBands) {
  const VehicleParameters<double> p = family_car();
  double inside = 0.0;
  constexpr int kDrives = 6;
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    const Drive drive(lively_drive(p, seed), reference_drive_sensors(), seed);
    const DriveOpenLoop driven = drive.driven(p, bicycle_estimate(p), {.times = {.duration_s = 60.0}});
    inside += pooled_inside(driven) / kDrives;
    ASSERT_THAT(driven.offsets, ElementsAre("steer_bias", "yaw_rate_bias", "accel_y_bias"));
    for (const OpenLoopState& state : driven.states) {
      EXPECT_EQ(state.held, state.windows) << state.name;
      EXPECT_LT(state.normalised_rmse, 0.15) << state.name;
    }
    for (const Evidence& row : open_loop_evidence(driven)) EXPECT_TRUE(row.passed()) << says(row);
  }
  EXPECT_NEAR(inside, 0.95, 0.03);
}

// Models drawn from a covariance, with bands that know it: theirs cover too.
TEST(DriveOpenLoop, BandsHoldTheErrorsOfTheParameters) {
  const VehicleParameters<double> p = family_car();
  constexpr double kSigma = 0.06;
  numerics::RandomStream random(4, "models");
  double inside = 0.0, without = 0.0;
  constexpr int kDraws = 60;
  for (int draw = 0; draw < kDraws; ++draw) {
    VehicleParameters<double> model = p;
    for (double* value : {&model.C_f, &model.C_r, &model.I_z}) *value *= 1.0 + kSigma * random.normal();
    const Drive drive(lively_drive(p, 10 + static_cast<std::uint64_t>(draw), 0.02, 30.0), reference_drive_sensors(),
                      static_cast<std::uint64_t>(draw));
    const DriveOpenLoopOptions options{.times = {.duration_s = 30.0}};
    inside += pooled_inside(drive.driven(p, bicycle_estimate(model, kSigma), options)) / kDraws;
    without += pooled_inside(drive.driven(p, bicycle_estimate(model), options)) / kDraws;
  }
  EXPECT_NEAR(inside, 0.95, 0.04);
  EXPECT_LT(without, 0.85) << "the covariance must matter";
}

// From one drive to another as `identify` and `validate` go: how long the residual's errors last is known, and counts.
TEST(DriveOpenLoop, BandsOfIdentifiedModelsCoverOtherDrives) {
  const Study study = Study::parse(
      "[subject]\nkind = 'vehicle'\nmass = 1500\na = 1.2\nb = 1.5\n[data]\nframe = 'flu'\n"
      "[identify]\nstructure = 'bicycle'\n[validate]\nopen_loop = '10 min'\n",
      "study.toml");
  const auto recorded = [](std::uint64_t seed, double length) {
    return record_drive(lively_drive(family_car(), seed, 0.014, length), reference_drive_sensors(), seed);
  };
  Progress silent;
  double inside = 0.0;
  constexpr std::uint64_t kDrives = 10;
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    const estimation::Estimate found = identify(read_study(study, recorded(seed, 60.0), silent), silent).estimate;
    EXPECT_GT(found.fit.at("yaw_rate.long_run"), 3.0) << "noise of the steering lasts as long as the car takes";
    const VehicleAnalysis other = validate(read_study(study, recorded(seed + 100, 120.0), silent), found, silent);
    inside += pooled_inside(other.open_loop) / static_cast<double>(kDrives);
  }
  EXPECT_NEAR(inside, 0.955, 0.015);
}

TEST(DriveOpenLoop, OfAWrongParameterLeavesItsBandsSoonAndTheRowSaysSo) {
  const VehicleParameters<double> p = family_car();
  const Drive drive(lively_drive(p, 3), reference_drive_sensors(), 3);
  for (double VehicleParameters<double>::*field :
       {&VehicleParameters<double>::C_f, &VehicleParameters<double>::C_r, &VehicleParameters<double>::I_z}) {
    VehicleParameters<double> wrong = p;
    wrong.*field *= 1.3;
    const DriveOpenLoop driven = drive.driven(p, bicycle_estimate(wrong), {.times = {.duration_s = 60.0}});
    const OpenLoopState& yaw_rate = state_of(driven, "yaw_rate");
    EXPECT_LT(yaw_rate.horizon_s, 15.0) << "the true model holds for 57 s";
    EXPECT_EQ(yaw_rate.held, 0u);
    EXPECT_LT(pooled_inside(driven), 0.9);
    const std::vector<Evidence> rows = open_loop_evidence(driven);
    const Evidence row = row_of(rows, estimation::Check::kOpenLoopHorizon);
    EXPECT_FALSE(row.passed()) << says(row);
    EXPECT_NE(row.cause, estimation::Cause::kNone);
    EXPECT_FALSE(advice_of(row).empty());
  }
}

// What the residual had beyond the sensors where the model was identified is in the bands of its forecasts.
TEST(DriveOpenLoop, WidensItsBandsByTheResidualOfItsIdentification) {
  VehicleParameters<double> wrong = family_car();
  wrong.C_f *= 1.1;
  const Drive drive(lively_drive(family_car(), 3), reference_drive_sensors(), 3);
  const DriveOpenLoopOptions options{.times = {.duration_s = 60.0}, .offsets = {{}}};
  estimation::Estimate estimate = bicycle_estimate(wrong);
  const DriveOpenLoop sure = drive.driven(family_car(), estimate, options);
  estimate.fit["yaw_rate.rmse"] = state_of(sure, "yaw_rate").fit.rmse * kDegree;
  estimate.fit["accel_y.rmse"] = state_of(sure, "accel_y").fit.rmse;
  const DriveOpenLoop widened = drive.driven(family_car(), estimate, options);
  EXPECT_LT(pooled_inside(sure), 0.8);
  EXPECT_NEAR(pooled_inside(widened), 0.95, 0.04);
  EXPECT_EQ(state_of(widened, "yaw_rate").held, 1u);
}

// A bias of today is none of the vehicle: found in the first seconds, as far as these tell the three apart.
TEST(DriveOpenLoop, FindsTheBiasesOfTheDay) {
  const VehicleParameters<double> p = family_car();
  Drive drive(lively_drive(p, 5), testing::perfect_sensors(), 1);
  for (double& r : drive.signals[DriveSignal::kYawRate].value) r += 0.02;
  for (double& a : drive.signals[DriveSignal::kAccelY].value) a += 0.2;
  for (const auto& [signal, sigma] : {std::pair{DriveSignal::kYawRate, 1e-4}, std::pair{DriveSignal::kAccelY, 1e-3}})
    drive.signals[signal].sigma = sigma;
  const DriveOpenLoop found = drive.driven(
      p, bicycle_estimate(p),
      {.times = {.duration_s = 60.0}, .offsets = {{DriveUnknown::kYawRateBias, DriveUnknown::kAccelYBias}}});
  ASSERT_EQ(found.windows.size(), 1u);
  ASSERT_EQ(found.windows[0].start.size(), 4u);
  EXPECT_NEAR(found.windows[0].start[2].value, 0.02, 1e-4);
  EXPECT_NEAR(found.windows[0].start[3].value, 0.2, 1e-3);
  EXPECT_LT(state_of(found, "yaw_rate").normalised_rmse, 1e-3);
  const DriveOpenLoop as_it_is = drive.driven(p, bicycle_estimate(p), {.times = {.duration_s = 60.0}, .offsets = {{}}});
  EXPECT_GT(state_of(as_it_is, "yaw_rate").shares.bias, 0.99);
  EXPECT_TRUE(as_it_is.offsets.empty());
  // On the drive that it was identified from the estimate knows them.
  estimation::Estimate own =
      estimate_of({{"C_f", p.C_f}, {"C_r", p.C_r}, {"I_z", p.I_z}, {"yaw_rate_bias", 0.02}, {"accel_y_bias", 0.2}});
  const DriveOpenLoop known = drive.driven(p, own, {.times = {.duration_s = 60.0}}, OpenLoopUse::kHoldout);
  EXPECT_THAT(known.offsets, ElementsAre("steer_bias"));
  EXPECT_LT(state_of(known, "yaw_rate").normalised_rmse, 1e-3);
}

TEST(DriveOpenLoop, LooksAtNothingThatIdentificationHasUsedUnlessItIsAnotherDrive) {
  const VehicleParameters<double> p = family_car();
  Drive drive(lively_drive(p, 5), reference_drive_sensors(), 1);
  drive.segments.holdout = {{10.0, 20.0}, {40.0, 43.0}};
  drive.segments.identification = {{21.0, 39.0}};
  const DriveOpenLoopOptions options{.times = {.duration_s = 100.0}};
  const DriveOpenLoop own = drive.driven(p, bicycle_estimate(p), options, OpenLoopUse::kHoldout);
  ASSERT_EQ(own.windows.size(), 1u) << "three seconds are too short";
  EXPECT_NEAR(own.windows[0].span.begin, 10.0, 0.01);
  EXPECT_NEAR(own.windows[0].span.end, 21.0, 0.02);
  EXPECT_THAT(own.text, HasSubstr("that identification did not see"));
  const DriveOpenLoop other = drive.driven(p, bicycle_estimate(p), options, OpenLoopUse::kOtherDrive);
  ASSERT_EQ(other.windows.size(), 1u);
  EXPECT_NEAR(other.windows[0].span.end, 59.9, 0.02) << "the whole drive";
  const DriveOpenLoop part =
      drive.driven(p, bicycle_estimate(p), {.times = {.duration_s = 8.0}}, OpenLoopUse::kOtherHoldout);
  ASSERT_EQ(part.windows.size(), 1u);
  EXPECT_NEAR(part.windows[0].span.duration(), 8.0, 0.02);
}

TEST(DriveOpenLoop, OfACarThatSpinsIsCutThereAndTheRowFails) {
  VehicleParameters<double> p = family_car();
  p.C_r *= 0.25;  // oversteering: unstable at 20 m/s
  const Drive drive(lively_drive(family_car(), 5), reference_drive_sensors(), 1);
  const DriveOpenLoop driven = drive.driven(p, bicycle_estimate(p), {.times = {.duration_s = 60.0}});
  ASSERT_FALSE(driven.windows.empty());
  const bool missed = driven.windows[0].diverged || state_of(driven, "yaw_rate").normalised_rmse > 1.0;
  EXPECT_TRUE(missed);
  const std::vector<Evidence> rows = open_loop_evidence(driven);
  EXPECT_TRUE(std::ranges::any_of(rows, [](const Evidence& row) { return !row.passed(); }));
}

TEST(DriveOpenLoop, FollowsHeadingAndPathOfTheCarItIsAndStraysFromAnother) {
  const VehicleParameters<double> p = family_car();
  const VehicleTrajectory trajectory = lively_drive(p, 5);
  DriveSensorSet sensors = testing::perfect_sensors();
  sensors[DriveSensorKind::kPosition] = {.enabled = true, .rate_Hz = 100.0};
  Drive drive(trajectory, sensors, 1);
  ASSERT_FALSE(drive.signals[DriveSignal::kLateralVelocity].available()) << "the path needs it and takes the model's";
  drive.signals[DriveSignal::kYaw].value.assign(
      trajectory.yaw.begin(), trajectory.yaw.begin() + std::ssize(drive.signals[DriveSignal::kX].value));
  const DriveOpenLoopOptions options{.times = {.duration_s = 60.0}, .offsets = {{}}};
  const DriveOpenLoop exact = drive.driven(p, bicycle_estimate(p), options);
  ASSERT_TRUE(exact.path.heading && exact.path.position);
  EXPECT_LT(exact.path.heading->at_end, 0.01 * kDegree);
  EXPECT_LT(exact.path.position->at_end, 0.05) << "after 1.1 km, most of it by the test's own Euler steps";
  EXPECT_NEAR(exact.path.distance_m, 20.0 * 56.9, 25.0);
  EXPECT_EQ(exact.states.size(), 2U) << "the lateral velocity was not measured, and is not scored";
  EXPECT_GT(exact.windows[0].first_left_s, 56.0);
  Drive biased = drive;  // the sensor's, which is neither the model's error nor a part of the heading
  for (double& r : biased.signals[DriveSignal::kYawRate].value) r += 0.02;
  const DriveOpenLoop by_heading =
      biased.driven(p, bicycle_estimate(p), {.times = {.duration_s = 60.0}, .offsets = {{DriveUnknown::kYawRateBias}}});
  EXPECT_LT(by_heading.path.position->at_end, 1.0);
  biased.signals[DriveSignal::kYaw].value.clear();
  const DriveOpenLoop by_positions =
      biased.driven(p, bicycle_estimate(p), {.times = {.duration_s = 60.0}, .offsets = {{DriveUnknown::kYawRateBias}}});
  EXPECT_LT(by_positions.path.position->at_end, 30.0) << "of 1140 m: the course of both ends has its sideslip";
  VehicleParameters<double> softer = p;
  softer.C_r *= 0.9;
  const DriveOpenLoop wrong = drive.driven(p, bicycle_estimate(softer), options);
  EXPECT_GT(wrong.path.position->rmse, 20.0 * exact.path.position->rmse);
  EXPECT_GT(wrong.path.heading->rmse, 20.0 * exact.path.heading->rmse);
}

TEST(DriveOpenLoop, OfAStiffCarIsNotHeldByHoldingTenOfItsPeriods) {
  DriveOpenLoop driven{{.times = {.duration_s = 10.0}, .inputs = "steering and speed"}, 0.042, {}};
  driven.states.push_back(
      {.name = "yaw_rate", .unit = "deg/s", .normalised_rmse = 0.1, .horizon_s = 1.5, .windows = 3});
  const std::vector<Evidence> left = open_loop_evidence(driven);
  EXPECT_EQ(row_of(left, estimation::Check::kOpenLoopHorizon).outcome, Outcome::kCare)
      << "36 of its periods, and a second and a half";
  EXPECT_NEAR(row_of(left, estimation::Check::kOpenLoopHorizon).value, 1.5, 1e-12);
  EXPECT_THAT(says(row_of(left, estimation::Check::kOpenLoopHorizon)), HasSubstr("0.042 s, is shorter"));
  driven.states[0].horizon_s = 10.5;
  EXPECT_EQ(row_of(open_loop_evidence(driven), estimation::Check::kOpenLoopHorizon).outcome, Outcome::kPassed);
  driven.yaw_period_s = 1.5;
  EXPECT_EQ(row_of(open_loop_evidence(driven), estimation::Check::kOpenLoopHorizon).outcome, Outcome::kCare)
      << "7 slow periods";
}

TEST(DriveOpenLoop, SaysWhyNothingWasDrivenAndIsSilentWhereNothingIsAskedFor) {
  const VehicleParameters<double> p = family_car();
  const Drive drive(lively_drive(p, 5, 0.02, 20.0), reference_drive_sensors(), 1);
  EXPECT_TRUE(drive.driven(p, bicycle_estimate(p), {}).text.empty());
  const DriveOpenLoop no_inertia =
      drive.driven(p, estimate_of({{"C_f", p.C_f}, {"C_r", p.C_r}}), {.times = {.duration_s = 20.0}});
  EXPECT_FALSE(no_inertia.available());
  EXPECT_THAT(no_inertia.text, HasSubstr("has no I_z"));
  EXPECT_TRUE(drive
                  .driven(p, estimate_of({{"C_f", p.C_f}, {"C_r", p.C_r}}), {.times = {.duration_s = 20.0}},
                          OpenLoopUse::kHoldout)
                  .available())
      << "an inertia that was not estimated is the study's";
  EXPECT_TRUE(open_loop_evidence(no_inertia).empty());
  Drive unused = drive;
  unused.segments.holdout.clear();
  EXPECT_THAT(unused.driven(p, bicycle_estimate(p), {.times = {.duration_s = 20.0}}).text,
              HasSubstr("no unseen stretch lasts 4 s"));
}

}  // namespace
}  // namespace veridyn::vehicle
