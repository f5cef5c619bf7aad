// Open loop against the equations of motion of four cars, written out and integrated here once more.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/vehicle/identification/validation/open_loop_drive.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::OpenLoopState;
using estimation::OpenLoopWindow;
using Drive = testing::OpenLoopDrive;
using testing::estimate_of;
using testing::family_car;
using testing::state_of;

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

TEST(DriveOpenLoopEquations, DrivesAndScoresAsEquationsWrittenOutHere) {
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

}  // namespace
}  // namespace veridyn::vehicle
