#include "veridyn/vehicle/model/four_wheel_model.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include "tests/vehicle/cars.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {
namespace {

using testing::linear_car;
using testing::LinearCar;

/// Unlike in front and behind in everything, with bars: nothing cancels.
VehicleParameters<double> uneven_car() {
  VehicleParameters<double> p;
  p.track_f = 1.45;
  p.track_r = 1.55;
  p.K_sf = 31000.0;
  p.K_sr = 27000.0;
  p.C_sf = 2500.0;
  p.C_sr = 2100.0;
  p.K_bf = 9000.0;
  p.K_br = 4000.0;
  p.K_tf = 190000.0;
  p.K_tr = 210000.0;
  return p;
}

struct Moment {
  FourWheelState<double> state;
  double steer, drive, brake;
  PerWheel<double> road;
};

/// Any motion, wheels off the ground among them.
Moment any_moment(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Moment m;
  for (Eigen::Index i = 0; i < kFourWheelStates; ++i) m.state(i) = any(generator);
  m.state.segment<4>(kHeave) *= 0.1;
  m.state.segment<4>(kWheelHeight) *= 0.03;
  m.state.segment<4>(kLaggedSlip) *= 0.1;
  m.state(kU) = 20.0 + 5.0 * m.state(kU);
  for (Eigen::Index i = 0; i < 4; ++i) m.state(kWheelSpin + i) = m.state(kU) / 0.3 * (1.0 + 0.05 * any(generator));
  m.steer = 0.1 * any(generator);
  m.drive = 1000.0 * any(generator);
  m.brake = 1000.0 * (1.0 + any(generator));
  for (double& h : m.road) h = 0.02 * any(generator);
  return m;
}

FourWheelRates<double> rates_at(const LinearCar<double>& car, const Moment& m) {
  FourWheelRates<double> out;
  car.rates(m.state, car.wheel_controls(m.steer, m.drive, m.brake), m.road, out);
  return out;
}

FourWheelOptions with_longitudinal(double grade = 0.0) {
  FourWheelOptions options;
  options.longitudinal.emplace().grade = grade;
  return options;
}

TEST(FourWheelModel, StandsStillInItsSpringsOnItsStaticLoads) {
  const VehicleParameters<double> p = uneven_car();
  const auto car = linear_car(p);
  const Moment rest{car.steady_start(20.0), 0.0, 0.0, 0.0, {}};
  const auto rates = rates_at(car, rest);
  for (Eigen::Index i = 0; i < kFourWheelStates; ++i) {
    EXPECT_EQ(rates.derivative(i), i == kX || i == kDistance ? 20.0 : 0.0) << i;
  }
  const double weight = p.mass * 9.80665;
  EXPECT_NEAR(rates.Fz(0) + rates.Fz(1) + rates.Fz(2) + rates.Fz(3), weight, 1e-9);
  EXPECT_NEAR(p.a * (rates.Fz(0) + rates.Fz(1)), p.b * (rates.Fz(2) + rates.Fz(3)), 1e-9);
  for (std::size_t i = 0; i < kWheels; ++i) EXPECT_EQ(rates.Fz(signed_index(i)), static_loads(p, 9.80665)[i]);
}

// Newton and Euler for the whole vehicle from the forces and their places alone.
TEST(FourWheelModel, ChangesMomentumByItsForces) {
  const VehicleParameters<double> p = uneven_car();
  std::mt19937_64 generator(1);
  for (const bool longitudinal : {false, true}) {
    const auto car = linear_car(p, longitudinal ? with_longitudinal(0.05) : FourWheelOptions{});
    for (int round = 0; round < 50; ++round) {
      const Moment m = any_moment(generator);
      const auto rates = rates_at(car, m);
      const auto& d = rates.derivative;
      Eigen::Vector3d force(rates.holding_force, 0.0, 0.0), moment(0.0, 0.0, 0.0);
      if (longitudinal) {
        force.x() -= 0.5 * 1.225 * 0.65 * m.state(kU) * m.state(kU) + p.mass * 9.80665 * std::sin(0.05);
      }
      for (std::size_t i = 0; i < kWheels; ++i) {
        const double angle = is_front(i) ? m.steer : 0.0;
        const Eigen::Vector3d in_wheel(rates.Fx(signed_index(i)), rates.Fy(signed_index(i)), rates.Fz(signed_index(i)));
        const Eigen::Vector3d f = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * in_wheel;
        force += f;
        moment +=
            Eigen::Vector3d(car.wheel_x()(signed_index(i)), car.wheel_y()(signed_index(i)), -p.cg_height).cross(f);
      }
      EXPECT_NEAR(p.mass * (d(kU) - m.state(kR) * m.state(kV)), force.x(), 1e-7);
      EXPECT_NEAR(p.mass * (d(kV) + m.state(kR) * m.state(kU)), force.y(), 1e-7);
      EXPECT_NEAR(p.I_z * d(kR), moment.z(), 1e-7);
      double vertical = (p.mass - 4.0 * p.unsprung_mass) * d(kHeaveRate);
      for (Eigen::Index i = 0; i < 4; ++i) vertical += p.unsprung_mass * d(kWheelHeightRate + i);
      const double across = 9.80665 * (longitudinal ? std::cos(0.05) : 1.0);
      EXPECT_NEAR(vertical, force.z() - p.mass * across, 1e-7);
    }
  }
}

// Written anew from the spec's words, absolute heights and loads instead of deviations: what the body and the wheels
// have and what is stored in springs, tyres and weight.
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
    const Scalar corner =
        s(kHeave) + y * s(kRoll) - x * s(kPitch) + 0.5 * p.cg_height * (s(kRoll) * s(kRoll) + s(kPitch) * s(kPitch));
    stretch[static_cast<std::size_t>(i)] = s(kWheelHeight + i) - corner;
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    const bool front = i < 2;
    const auto w = static_cast<std::size_t>(i);
    const double load = p.mass * g * (front ? p.b : p.a) / (2.0 * (p.a + p.b));
    const double K = front ? p.K_sf : p.K_sr, K_t = front ? p.K_tf : p.K_tr;
    const double squeezed = (load - p.unsprung_mass * g) / K;  // of the spring at rest
    e += 0.5 * p.unsprung_mass * s(kWheelHeightRate + i) * s(kWheelHeightRate + i) +
         p.unsprung_mass * g * s(kWheelHeight + i);
    e += 0.5 * K * (squeezed + stretch[w]) * (squeezed + stretch[w]);
    if (i % 2 == 0) {
      const Scalar twist = stretch[w] - stretch[w + 1];
      e += 0.5 * (front ? p.K_bf : p.K_br) * twist * twist;
    }
    const Scalar flat = load / K_t + road[w] - s(kWheelHeight + i);
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
    const auto w = static_cast<Eigen::Index>(i);
    const double x = car.wheel_x()(signed_index(i)), y = car.wheel_y()(signed_index(i));
    const Eigen::Vector3d contact = velocity + spin.cross(Eigen::Vector3d(x, y, -p.cg_height));
    EXPECT_NEAR(rates.contact_x(signed_index(i)), contact.x(), 1e-12);
    EXPECT_NEAR(rates.contact_y(signed_index(i)), contact.y(), 1e-12);
    const Eigen::Vector3d force = Eigen::AngleAxisd(is_front(i) ? m.steer : 0.0, Eigen::Vector3d::UnitZ()) *
                                  Eigen::Vector3d(rates.Fx(signed_index(i)), rates.Fy(signed_index(i)), 0.0);
    sum += force.dot(contact) + rates.Fz(signed_index(i)) * road_rate[i];
    const double stretching = s(kWheelHeightRate + w) - s(kHeaveRate) - y * s(kRollRate) + (x - ahead) * s(kPitchRate) -
                              p.cg_height * (s(kRoll) * s(kRollRate) + s(kPitch) * s(kPitchRate));
    sum -= (is_front(i) ? p.C_sf : p.C_sr) * stretching * stretching;
    if (const auto& l = car.options().longitudinal) {
      const double drive = is_front(i) ? l->front_drive_share : 1.0 - l->front_drive_share;
      const double brake = is_front(i) ? l->front_brake_share : 1.0 - l->front_brake_share;
      const double friction =
          0.5 * brake * m.brake + l->rolling_resistance * rates.Fz(signed_index(i)) * l->wheel_radius;
      sum += (0.5 * drive * m.drive - l->wheel_radius * rates.Fx(signed_index(i))) * s(kWheelSpin + w) -
             friction * std::abs(s(kWheelSpin + w));
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
  for (const bool longitudinal : {false, true}) {
    const auto car = linear_car(p, longitudinal ? with_longitudinal(0.05) : FourWheelOptions{});
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
        off_the_ground += rates.Fz(signed_index(i)) == 0.0 ? 1 : 0;
      }
      const double expected = power(car, m, rates, road_rate);
      EXPECT_NEAR(energy(p, moving, road, car.options()).v(0), expected, 1e-10 * (1e4 + std::abs(expected)));
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

  const LinearCar<double>& car_;
  double steer_, bump_;
};

TEST(FourWheelModel, BalancesItsEnergyOverAViolentDriveOnABumpyRoad) {
  for (const bool longitudinal : {false, true}) {
    const auto car = linear_car(uneven_car(), longitudinal ? with_longitudinal(0.05) : FourWheelOptions{});
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

/// The same motion seen in a mirror.
Moment in_mirror(const Moment& m) {
  Moment out = m;
  for (const Eigen::Index i : {kY, kYaw, kV, kR, kRoll, kRollRate}) out.state(i) = -m.state(i);
  for (const Eigen::Index block : {kWheelHeight, kWheelHeightRate, kWheelSpin, kLaggedSlip}) {
    for (Eigen::Index i = 0; i < 4; ++i) {
      out.state(block + i) = (block == kLaggedSlip ? -1.0 : 1.0) * m.state(block + (i ^ 1));
    }
  }
  for (std::size_t i = 0; i < kWheels; ++i) out.road[i] = m.road[mirrored(i)];
  out.steer = -m.steer;
  return out;
}

TEST(FourWheelModel, TreatsLeftAndRightAlikeToTheLastBit) {
  std::mt19937_64 generator(3);
  for (const bool longitudinal : {false, true}) {
    FourWheelOptions options = longitudinal ? with_longitudinal() : FourWheelOptions{};
    options.ackermann = 0.4;
    options.relaxation_length = 0.3;
    options.camber_per_roll = 0.2;
    const auto car = linear_car(uneven_car(), options);
    for (int round = 0; round < 100; ++round) {
      const Moment m = any_moment(generator);
      Moment rates{rates_at(car, m).derivative, 0.0, 0.0, 0.0, {}};
      const FourWheelState<double> reflected = rates_at(car, in_mirror(m)).derivative,
                                   expected = in_mirror(rates).state;
      for (Eigen::Index i = 0; i < kFourWheelStates; ++i) EXPECT_EQ(reflected(i), expected(i)) << i;
    }
  }
}

TEST(FourWheelModel, BecomesTheBicycleInSecondOrderOfTrackAndHeight) {
  const auto difference = [](double track, double height) {
    VehicleParameters<double> p;
    p.track_f = p.track_r = track;
    p.cg_height = height;
    const auto car = linear_car(p);
    const BicycleModel<double, LinearTyre<double>> bicycle{p, {.stiffness = p.C_f}, {.stiffness = p.C_r}};
    Moment m{car.steady_start(20.0), 0.06, 0.0, 0.0, {}};
    m.state(kV) = -0.3;
    m.state(kR) = 0.5;
    m.state(kRollRate) = 20.0 * height;  // as lateral forces at the road would have it: in proportion to the height
    m.state(kPitchRate) = 5.0 * height;
    const auto rates = rates_at(car, m);
    const auto wanted = bicycle.rates(-0.3, 0.5, 0.06, 20.0);
    return std::hypot(rates.derivative(kV) - wanted.dv, rates.derivative(kR) - wanted.dr);
  };
  EXPECT_LT(difference(1e-9, 0.0), 1e-11);
  EXPECT_NEAR(difference(0.2, 0.0) / difference(0.1, 0.0), 4.0, 0.01);
  EXPECT_NEAR(difference(1e-9, 0.02) / difference(1e-9, 0.01), 4.0, 0.05);
}

TEST(FourWheelModel, SteersAfterAckermannTowardsOneTurningCentre) {
  FourWheelOptions options;
  options.ackermann = 1.0;
  const auto car = linear_car(uneven_car(), options);
  const double L = 2.25, W = 1.45;
  for (const double steer : {0.3, -0.2}) {
    const auto wheels = car.wheel_controls(steer);
    EXPECT_NEAR(1.0 / std::tan(wheels.steer[1]) - 1.0 / std::tan(wheels.steer[0]), W / L, 1e-12);
    EXPECT_NEAR(0.5 / std::tan(wheels.steer[1]) + 0.5 / std::tan(wheels.steer[0]), 1.0 / std::tan(steer), 1e-12);
  }
  options.ackermann = 0.0;
  const auto parallel = linear_car(uneven_car(), options).wheel_controls(0.3);
  EXPECT_EQ(parallel.steer[0], 0.3);
  EXPECT_EQ(parallel.steer[1], 0.3);
}

/// The rows and columns of the vertical motion at rest, by automatic differentiation.
Eigen::MatrixXd vertical_motion(const VehicleParameters<double>& p, const FourWheelOptions& options = {}) {
  constexpr int kSize = 14;
  using Jet = ceres::Jet<double, kSize>;
  const auto car = linear_car(p.cast<Jet>(), options);
  FourWheelState<Jet> state = car.steady_start(Jet(20.0));
  for (int i = 0; i < kSize; ++i) state(kHeave + i).v(i) = 1.0;
  FourWheelRates<Jet> rates;
  car.rates(state, car.wheel_controls(Jet(0.0)), {}, rates);
  Eigen::MatrixXd matrix(kSize, kSize);
  for (int i = 0; i < kSize; ++i) matrix.row(i) = rates.derivative(kHeave + i).v.transpose();
  return matrix;
}

/// Angular frequencies of an undamped body (inertia M, spring K to four wheels, negative spring G to the ground) on
/// wheels (each of inertia m against it, tyre spring T): the roots of the 2 x 2 characteristic equation.
std::array<double, 2> two_mass_frequencies(double M, double m, double K, double T, double G) {
  // M x'' = -K (x - y) + G x;  m y'' = K (x - y) - T y
  const double A = M * m, B = -(M * (K + T) + m * (K - G)), C = (K - G) * (K + T) - K * K;
  const double root = std::sqrt(B * B - 4.0 * A * C);
  return {std::sqrt((-B - root) / (2.0 * A)), std::sqrt((-B + root) / (2.0 * A))};
}

// Heave, roll and pitch of a car alike in front and behind are three quarter cars of their own.
TEST(FourWheelModel, HeavesRollsAndPitchesAtTheFrequenciesOfTheQuarterCar) {
  VehicleParameters<double> p;
  p.a = p.b = 1.2;
  p.C_sf = p.C_sr = 0.0;
  p.C_f = p.C_r = 1e-9;  // contact points that move would damp
  p.K_sf = p.K_sr = 25000.0;
  p.K_tf = p.K_tr = 200000.0;
  p.K_bf = p.K_br = 6000.0;
  const double sprung = p.mass - 4.0 * p.unsprung_mass, gravity = sprung * 9.80665 * p.cg_height;
  const double y = 0.5 * p.track_f, x = p.a, w = 4.0 * p.unsprung_mass;
  std::vector<double> expected;
  const auto add = [&](double inertia, double wheels, double spring, double tyre, double tilting) {
    for (const double f : two_mass_frequencies(inertia, wheels, spring, tyre, tilting)) expected.push_back(f);
  };
  add(sprung, w, 4.0 * p.K_sf, 4.0 * p.K_tf, 0.0);
  add(p.I_x, w * y * y, 4.0 * (p.K_sf + 2.0 * p.K_bf) * y * y, 4.0 * p.K_tf * y * y, gravity);
  add(p.I_y, w * x * x, 4.0 * p.K_sf * x * x, 4.0 * p.K_tf * x * x, gravity);
  // The fourth: wheels cross over (warp), where the body rests.
  expected.push_back(std::sqrt((p.K_sf + 2.0 * p.K_bf + p.K_tf) / p.unsprung_mass));
  std::sort(expected.begin(), expected.end());
  std::vector<double> found;
  for (const std::complex<double>& e : vertical_motion(p).eigenvalues()) {
    EXPECT_NEAR(e.real(), 0.0, 1e-7);
    if (e.imag() > 0.0) found.push_back(e.imag());
  }
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-7 * expected[i]) << i;
}

TEST(FourWheelModel, MovesTheWholeMassAndIsNotTiltedInTheSourcesConvention) {
  VehicleParameters<double> p;
  p.a = p.b = 1.2;
  p.C_sf = p.C_sr = 0.0;
  FourWheelOptions options;
  options.convention = FourWheelConvention::kSource;
  options.geometry = BicycleGeometry::kSmallAngles;
  const double y = 0.5 * p.track_f;
  const auto heave = two_mass_frequencies(p.mass, 4.0 * p.unsprung_mass, 4.0 * p.K_sf, 4.0 * p.K_tf, 0.0);
  const auto roll =
      two_mass_frequencies(p.I_x, 4.0 * p.unsprung_mass * y * y, 4.0 * p.K_sf * y * y, 4.0 * p.K_tf * y * y, 0.0);
  for (const double wanted : {heave[0], heave[1], roll[0], roll[1]}) {
    double nearest = 1e9;
    for (const std::complex<double>& e : vertical_motion(p, options).eigenvalues()) {
      nearest = std::min(nearest, std::abs(e - std::complex<double>(0.0, wanted)));
    }
    EXPECT_LT(nearest, 1e-6);
  }
  // Slips know nothing of roll, forces have their whole lateral part, tyres may pull while the load ends at zero.
  const auto car = linear_car(p, options);
  Moment m{car.steady_start(20.0), 0.05, 0.0, 0.0, {}};
  m.state(kV) = 0.4;
  m.state(kR) = 0.3;
  m.state(kRollRate) = 0.5;
  m.state(kWheelHeight) = 1.0;
  const auto rates = rates_at(car, m);
  EXPECT_NEAR(rates.slip_angle(0), 0.05 - (0.4 + 1.2 * 0.3) / (20.0 - 0.75 * 0.3), 1e-15);
  EXPECT_NEAR(rates.slip_angle(1), 0.05 - (0.4 + 1.2 * 0.3) / (20.0 + 0.75 * 0.3), 1e-15);
  EXPECT_NEAR(rates.slip_angle(3), -(0.4 - 1.2 * 0.3) / (20.0 + 0.75 * 0.3), 1e-15);
  EXPECT_NEAR(p.mass * rates.lateral_acceleration, rates.Fy(0) + rates.Fy(1) + rates.Fy(2) + rates.Fy(3), 1e-9);
  EXPECT_EQ(rates.Fz(0), 0.0);
  EXPECT_NEAR(rates.derivative(kWheelHeightRate), -(p.K_tf + p.K_sf) / p.unsprung_mass, 1e-9);
}

TEST(FourWheelModel, LagsItsSlipByTheRelaxationLength) {
  FourWheelOptions options;
  options.relaxation_length = 0.5;
  const auto car = linear_car(uneven_car(), options);
  Moment m{car.steady_start(20.0), 0.05, 0.0, 0.0, {}};
  m.state.segment<4>(kLaggedSlip).setConstant(0.02);
  const auto rates = rates_at(car, m);
  EXPECT_EQ(rates.slip_angle(0), 0.02);
  EXPECT_NEAR(rates.Fy(0), 60000.0 * 0.02, 1e-9);
  EXPECT_NEAR(rates.derivative(kLaggedSlip), (0.05 - 0.02) * 20.0 * std::cos(0.05) / 0.5, 1e-9);
  EXPECT_NEAR(rates.derivative(kLaggedSlip + 2), -0.02 * 20.0 / 0.5, 1e-9);
}

struct LeaningTyre {
  [[nodiscard]] TyreForces<double> forces(const double& load, const double& /*ratio*/, const double& /*angle*/,
                                          const double& camber) const {
    return {0.0, load * camber};
  }
  [[nodiscard]] double cornering_stiffness(const double& load) const { return load; }
};

TEST(FourWheelModel, LeansItsWheelsWithTheBody) {
  FourWheelOptions options;
  options.camber_per_roll = 0.3;
  const FourWheelModel<double, LeaningTyre> car(uneven_car(), {}, options);
  FourWheelState<double> state = car.steady_start(20.0);
  state(kRoll) = 0.1;
  FourWheelRates<double> rates;
  car.rates(state, car.wheel_controls(0.0), {}, rates);
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_NEAR(rates.Fy(i), 0.03 * rates.Fz(i), 1e-9);
}

TEST(FourWheelModel, HasTheDerivativesOfItsDifferences) {
  constexpr std::size_t kParameters = kVehicleFields.size() - 1;  // without mu, which is infinite
  using Jet = ceres::Jet<double, kParameters>;
  const VehicleParameters<double> p = uneven_car();
  VehicleParameters<Jet> with_parts = p.cast<Jet>();
  for (std::size_t i = 0; i < kParameters; ++i) field_of(with_parts, i).v(static_cast<Eigen::Index>(i)) = 1.0;
  const auto options = with_longitudinal();
  const auto car = linear_car(with_parts, options);
  std::mt19937_64 generator(4);
  Moment m = any_moment(generator);
  m.state.segment<4>(kWheelHeight) *= 0.1;  // all on the ground: smooth
  m.road = {};
  FourWheelRates<Jet> rates;
  car.rates(m.state.cast<Jet>(), car.wheel_controls(Jet(m.steer), m.drive, m.brake), m.road, rates);
  for (std::size_t i = 0; i < kParameters; ++i) {
    const double step = 1e-5 * field_of(p, i);
    VehicleParameters<double> more = p, less = p;
    field_of(more, i) += step;
    field_of(less, i) -= step;
    const FourWheelState<double> slope =
        (rates_at(linear_car(more, options), m).derivative - rates_at(linear_car(less, options), m).derivative) /
        (2.0 * step);
    for (Eigen::Index k = 0; k < kFourWheelStates; ++k) {
      EXPECT_NEAR(rates.derivative(k).v(static_cast<Eigen::Index>(i)), slope(k), 1e-6 * (1e-3 + std::abs(slope(k))))
          << kVehicleFields[i].name << " to state " << k;
    }
  }
}

TEST(FourWheelModel, NamesOptionsThatMakeNoSense) {
  const auto message = [](const FourWheelOptions& options) {
    try {
      options.validate();
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({}), "");
  EXPECT_EQ(message({.gravity = std::nan("")}), "vehicle: gravity is nan; must be >= 0");
  EXPECT_EQ(message({.ackermann = 1.5}), "vehicle: ackermann is 1.5; must be between 0 (parallel) and 1");
  EXPECT_EQ(message({.relaxation_length = -1.0}), "vehicle: relaxation_length is -1; must be >= 0");
  EXPECT_EQ(message({.longitudinal = LongitudinalParameters{.wheel_inertia = 0.0}}),
            "vehicle: wheel_inertia is 0; must be > 0");
  EXPECT_EQ(message({.longitudinal = LongitudinalParameters{.grade = 1.0}}),
            "vehicle: grade is 1 rad; must be between -0.5 and 0.5");
  EXPECT_EQ(message({.longitudinal = LongitudinalParameters{.front_brake_share = 1.1}}),
            "vehicle: front_brake_share is 1.1; must be between 0 and 1");
}

}  // namespace
}  // namespace veridyn::vehicle
