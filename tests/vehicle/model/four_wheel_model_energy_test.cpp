#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "tests/vehicle/model/moments.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/ode.hpp"

// The energy of the four-wheel model, stored and exchanged.

namespace veridyn::vehicle {
namespace {

using testing::any_moment;
using testing::every_option;
using testing::linear_car;
using testing::LinearCar;
using testing::Moment;
using testing::rates_at;
using testing::trailing_car;
using testing::uneven_car;
using testing::with_longitudinal;

/// What a spring by table stores from rest to a travel: Simpson's rule, exact for its cubics between the rows.
double stored(const SpringCurve& curve, double travel) {
  std::vector<double> at{0.0, travel};
  for (const double row : curve.travels()) {
    if (row > std::min(0.0, travel) && row < std::max(0.0, travel)) at.push_back(row);
  }
  std::ranges::sort(at);
  double sum = 0.0;
  for (std::size_t i = 1; i < at.size(); ++i) {
    const double width = at[i] - at[i - 1];
    sum += width / 6.0 * (curve.force(at[i - 1]) + 4.0 * curve.force(at[i] - 0.5 * width) + curve.force(at[i]));
  }
  return travel < 0.0 ? -sum : sum;
}
ceres::Jet<double, 1> stored(const SpringCurve& curve, const ceres::Jet<double, 1>& travel) {
  ceres::Jet<double, 1> out(stored(curve, travel.a));
  out.v = (stored(curve, travel.a + 1e-5) - stored(curve, travel.a - 1e-5)) / 2e-5 * travel.v;
  return out;
}

const AxleSuspension& suspension(const FourWheelOptions& options, bool front) {
  return front ? options.suspension_f : options.suspension_r;
}

// Written independently of the model, with absolute heights and loads instead of deviations: what the body and the
// wheels have and what is stored in springs, tyres and weight.
template <typename Scalar>
Scalar energy(const VehicleParameters<double>& p, const FourWheelState<Scalar>& s, const PerWheel<Scalar>& road,
              const FourWheelOptions& options) {
  const double g = options.gravity * std::cos(options.longitudinal ? options.longitudinal->grade : 0.0);
  const double sprung = p.mass - 4.0 * p.unsprung_mass;
  const double ahead = 2.0 * p.unsprung_mass * (p.b - p.a) / sprung;
  Scalar e = 0.5 * p.mass * (s(kU) * s(kU) + s(kV) * s(kV)) + 0.5 * p.I_z * s(kR) * s(kR) +
             0.5 * sprung * s(kHeaveRate) * s(kHeaveRate) + 0.5 * p.I_x * s(kRollRate) * s(kRollRate) +
             0.5 * p.I_y * s(kPitchRate) * s(kPitchRate) + sprung * g * s(kHeave);
  std::array<Scalar, 4> stretch;  // wheel above corner
  for (Eigen::Index i = 0; i < 4; ++i) {
    const bool front = i < 2;
    const double x = (front ? p.a : -p.b) - ahead;
    const double y = (i % 2 == 0 ? 0.5 : -0.5) * (front ? p.track_f : p.track_r);
    const double above = p.cg_height - suspension(options, front).roll_centre;
    const Scalar corner = s(kHeave) + y * s(kRoll) - x * s(kPitch) +
                          0.5 * (above * s(kRoll) * s(kRoll) + p.cg_height * s(kPitch) * s(kPitch));
    stretch[i] = s(kWheelHeight + i) - corner;
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    const bool front = i < 2;
    const double load = p.mass * g * (front ? p.b : p.a) / (2.0 * (p.a + p.b));
    const double K = front ? p.K_sf : p.K_sr, K_t = front ? p.K_tf : p.K_tr;
    const double squeezed = (load - p.unsprung_mass * g) / K;  // of the spring at rest
    e += 0.5 * p.unsprung_mass * s(kWheelHeightRate + i) * s(kWheelHeightRate + i) +
         p.unsprung_mass * g * s(kWheelHeight + i);
    const SpringCurve& curve = suspension(options, front).spring;
    if (curve.empty()) {
      e += 0.5 * K * (squeezed + stretch[i]) * (squeezed + stretch[i]);
    } else {
      e += (load - p.unsprung_mass * g) * stretch[i] + stored(curve, stretch[i]);
    }
    if (i % 2 == 0) {
      const Scalar twist = stretch[i] - stretch[i + 1];
      e += 0.5 * (front ? p.K_bf : p.K_br) * twist * twist;
    }
    const Scalar flat = load / K_t + road[i] - s(kWheelHeight + i);
    if (flat > 0.0) e += 0.5 * K_t * flat * flat;
  }
  if (options.longitudinal) {
    for (Eigen::Index i = 0; i < 4; ++i)
      e += 0.5 * options.longitudinal->wheel_inertia * s(kWheelSpin + i) * s(kWheelSpin + i);
  }
  return e;
}

/// What comes in: of tyres, dampers, road, holding force, drag, grade and torques [W].
double power(const LinearCar<double>& car, const Moment& m, const FourWheelRates<double>& rates,
             const PerWheel<double>& road_rate) {
  const VehicleParameters<double>& p = car.parameters();
  const FourWheelState<double>& s = m.state;
  double sum = rates.holding_force * (s(kU) - p.cg_height * s(kPitchRate));
  const double ahead = 2.0 * p.unsprung_mass * (p.b - p.a) / (p.mass - 4.0 * p.unsprung_mass);
  const Eigen::Vector3d velocity(s(kU), s(kV), 0.0), spin(s(kRollRate), s(kPitchRate), s(kR));
  for (std::size_t i = 0; i < kWheels; ++i) {
    const double x = car.wheel_x()(signed_index(i)), y = car.wheel_y()(signed_index(i));
    const AxleSuspension& axle = suspension(car.options(), is_front(i));
    const double above = p.cg_height - axle.roll_centre;
    const double stretching = s(kWheelHeightRate + i) - s(kHeaveRate) - y * s(kRollRate) + (x - ahead) * s(kPitchRate) -
                              above * s(kRoll) * s(kRollRate) - p.cg_height * s(kPitch) * s(kPitchRate);
    Eigen::Vector3d contact = velocity + spin.cross(Eigen::Vector3d(x, y, -p.cg_height));
    contact.y() += (is_left(i) ? 2.0 : -2.0) * axle.roll_centre / (is_front(i) ? p.track_f : p.track_r) * stretching;
    EXPECT_NEAR(rates.contact_x(i), contact.x(), 1e-12);
    EXPECT_NEAR(rates.contact_y(i), contact.y(), 1e-12);
    const Eigen::Vector3d force =
        Eigen::AngleAxisd((is_front(i) ? m.steer : 0.0) + rates.suspension_steer(i), Eigen::Vector3d::UnitZ()) *
        Eigen::Vector3d(rates.Fx(i), rates.Fy(i), 0.0);
    const AerodynamicLift& air = car.options().lift;
    const double lifted = 0.25 * air.air_density * (is_front(i) ? air.area_f : air.area_r) * s(kU) * s(kU);
    sum += rates.aligning_moment(i) * s(kR) + lifted * (s(kHeaveRate) - (x - ahead) * s(kPitchRate));
    sum += force.dot(contact) + rates.Fz(i) * road_rate[i];
    sum -= (is_front(i) ? p.C_sf : p.C_sr) * stretching * stretching;
    if (const auto& l = car.options().longitudinal) {
      const double drive = is_front(i) ? l->front_drive_share : 1.0 - l->front_drive_share;
      const double brake = is_front(i) ? l->front_brake_share : 1.0 - l->front_brake_share;
      const double friction = 0.5 * brake * m.brake + l->rolling_resistance * rates.Fz(i) * l->wheel_radius;
      sum += (0.5 * drive * m.drive - l->wheel_radius * rates.Fx(i)) * s(kWheelSpin + i) -
             friction * std::abs(s(kWheelSpin + i));
    }
  }
  if (const auto& l = car.options().longitudinal) {
    sum -= s(kU) *
           (0.5 * l->air_density * l->drag_area * s(kU) * s(kU) + p.mass * car.options().gravity * std::sin(l->grade));
  }
  return sum;
}

// d/dt of the energy along the derivative (by automatic differentiation) is the power, at any motion.
TEST(FourWheelModel, GainsEnergyOnlyFromForcesAtMovingPoints) {
  using Jet = ceres::Jet<double, 1>;
  const VehicleParameters<double> p = uneven_car();
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int off_the_ground = 0;
  for (const auto& [longitudinal, every] : {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
    FourWheelOptions options = every ? every_option() : FourWheelOptions{};
    if (longitudinal) options.longitudinal = LongitudinalParameters{.grade = 0.05};
    const auto car = trailing_car(p, options);
    for (int round = 0; round < 200; ++round) {
      const Moment m = any_moment(generator);
      const auto rates = rates_at(car, m);
      FourWheelState<Jet> moving;
      for (Eigen::Index i = 0; i < kFourWheelStates; ++i) {
        moving(i).a = m.state(i);
        moving(i).v(0) = rates.derivative(i);
      }
      PerWheel<double> road_rate{};
      PerWheel<Jet> road;
      for (std::size_t i = 0; i < kWheels; ++i) {
        road_rate[i] = any(generator);
        road[i].a = m.road[i];
        road[i].v(0) = road_rate[i];
        off_the_ground += rates.Fz(i) == 0.0 ? 1 : 0;
      }
      const double expected = power(car, m, rates, road_rate);
      // The rate of a spring by table is a difference of what it stores.
      EXPECT_NEAR(energy(p, moving, road, car.options()).v(0), expected,
                  (every ? 1e-7 : 1e-10) * (1e4 + std::abs(expected)));
    }
  }
  EXPECT_GT(off_the_ground, 50);
}

/// A car driven over a road of bumps, with the work done on it integrated along by the same method (the last state).
class EnergyBalance {
 public:
  using Augmented = Eigen::Matrix<double, kFourWheelStates + 1, 1>;
  EnergyBalance(const LinearCar<double>& car, double steer, double bump) : car_(car), steer_(steer), bump_(bump) {}

  struct Result {
    double error = 0.0;      ///< |energy gained - work done| as a share of what was exchanged
    double exchanged = 0.0;  ///< the absolute power over time [J]
    int off_the_ground = 0;  ///< steps with a wheel off
  };
  [[nodiscard]] Result run(double duration, double step) const {
    Augmented at = Augmented::Zero();
    at.head<kFourWheelStates>() = car_.steady_start(20.0);
    const double start = energy_at(at);
    Result result;
    const auto derivative = [&](double t, const Augmented& x) {
      const Moment m = moment(t, x);
      const FourWheelRates<double> rates = rates_at(car_, m);
      Augmented d;
      d << rates.derivative, power(car_, m, rates, road_rates(m, rates));
      return d;
    };
    const long steps = std::lround(duration / step);
    for (long k = 0; k < steps; ++k) {
      const double t = static_cast<double>(k) * step;
      const WheelArray<double> Fz = rates_at(car_, moment(t, at)).Fz;
      result.off_the_ground += Fz.minCoeff() == 0.0 ? 1 : 0;
      result.exchanged += step * std::abs(derivative(t, at)(kFourWheelStates));
      at = numerics::runge_kutta_4_step(derivative, t, at, step);
    }
    result.error = std::abs(energy_at(at) - start - at(kFourWheelStates)) / result.exchanged;
    return result;
  }

 private:
  [[nodiscard]] Moment moment(double t, const Augmented& x) const {
    Moment m{x.head<kFourWheelStates>(), steer_ * std::sin(4.0 * t), 800.0, 0.0, {}};
    for (std::size_t i = 0; i < kWheels; ++i) {
      const Eigen::Vector2d at = place(m, i);
      m.road[i] = bump_ * std::sin(0.7 * at.x()) * std::cos(0.5 * at.y());
    }
    return m;
  }
  [[nodiscard]] Eigen::Vector2d place(const Moment& m, std::size_t i) const {
    return m.state.head<2>() + Eigen::Rotation2Dd(m.state(kYaw)) *
                                   Eigen::Vector2d(car_.wheel_x()(signed_index(i)), car_.wheel_y()(signed_index(i)));
  }
  [[nodiscard]] PerWheel<double> road_rates(const Moment& m, const FourWheelRates<double>& rates) const {
    PerWheel<double> out{};
    for (std::size_t i = 0; i < kWheels; ++i) {
      const Eigen::Vector2d at = place(m, i), arm = at - m.state.head<2>();
      const Eigen::Vector2d velocity = rates.derivative.head<2>() + m.state(kR) * Eigen::Vector2d(-arm.y(), arm.x());
      out[i] = bump_ * (0.7 * std::cos(0.7 * at.x()) * std::cos(0.5 * at.y()) * velocity.x() -
                        0.5 * std::sin(0.7 * at.x()) * std::sin(0.5 * at.y()) * velocity.y());
    }
    return out;
  }
  [[nodiscard]] double energy_at(const Augmented& x) const {
    const Moment m = moment(0.0, x);
    return energy<double>(car_.parameters(), m.state, m.road, car_.options());
  }

  LinearCar<double> car_;
  double steer_, bump_;
};

TEST(FourWheelModel, BalancesItsEnergyOverAViolentDriveOnABumpyRoad) {
  for (const bool longitudinal : {false, true}) {
    const auto car = linear_car(uneven_car(), longitudinal ? with_longitudinal({.grade = 0.05}) : FourWheelOptions{});
    const EnergyBalance smooth(car, 0.05, 0.010);
    const auto coarse = smooth.run(1.0, 1e-3), fine = smooth.run(1.0, 5e-4), finest = smooth.run(1.0, 1.25e-4);
    EXPECT_EQ(fine.off_the_ground, 0);
    EXPECT_GT(fine.exchanged, 500.0);
    EXPECT_NEAR(std::log2(coarse.error / fine.error), 4.0, 0.5);
    EXPECT_LT(finest.error, 1e-10);
    const auto jumping = EnergyBalance(car, 0.12, 0.08).run(1.0, 2e-5);
    EXPECT_GT(jumping.off_the_ground, 5000);
    EXPECT_LT(jumping.error, 1e-8);
  }
}

// Tables make the third derivative jump: of the order of four the integration keeps at least three.
TEST(FourWheelModel, BalancesItsEnergyWithEveryOption) {
  const EnergyBalance balance(trailing_car(uneven_car(), every_option()), 0.05, 0.010);
  const auto coarse = balance.run(1.0, 1e-3), fine = balance.run(1.0, 2.5e-4), finest = balance.run(1.0, 6.25e-5);
  EXPECT_GT(fine.exchanged, 500.0);
  EXPECT_LT(fine.error, coarse.error / 64.0);
  EXPECT_LT(finest.error, 1e-8);
}

TEST(FourWheelModel, KeepsItsEnergyWhereNothingTakesIt) {
  VehicleParameters<double> p = uneven_car();
  p.C_sf = p.C_sr = 0.0;
  const LinearTyre<double> ice{.stiffness = 0.0, .slip_stiffness = 0.0};
  const LinearCar<double> car(p, {ice, ice, ice, ice});
  Moment m{car.steady_start(20.0), 0.0, 0.0, 0.0, {}};
  m.state(kRollRate) = 1.0;
  m.state(kHeaveRate) = 0.6;
  m.state(kPitchRate) = -0.4;
  const auto stored = [&] { return energy<double>(p, m.state, {}, car.options()); };
  const auto derivative = [&](double, const FourWheelState<double>& x) {
    return rates_at(car, {x, 0.0, 0.0, 0.0, {}}).derivative;
  };
  const double start = stored(), at_rest = energy<double>(p, car.steady_start(20.0), {}, car.options());
  double worst = 0.0;
  int off_the_ground = 0;
  for (int k = 0; k < 40000; ++k) {
    m.state = numerics::runge_kutta_4_step(derivative, 0.0, m.state, 5e-5);
    worst = std::max(worst, std::abs(stored() - start));
    const WheelArray<double> Fz = rates_at(car, m).Fz;
    off_the_ground += Fz.minCoeff() == 0.0 ? 1 : 0;
  }
  EXPECT_GT(start - at_rest, 400.0);
  EXPECT_LT(worst, 1e-7 * (start - at_rest));
  EXPECT_GE(off_the_ground, 0);
}

}  // namespace
}  // namespace veridyn::vehicle
