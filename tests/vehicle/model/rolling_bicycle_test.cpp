#include "veridyn/vehicle/model/rolling_bicycle.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <type_traits>

#include "tests/vehicle/cars.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/vehicle/tyre/fiala_tyre.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {
namespace {

template <int kStates>
using RollingState = Eigen::Matrix<double, kStates, 1>;
using LinearRolling = RollingBicycle<double, LinearTyre<double>>;

constexpr double kForwardSpeed = 20.0;

LinearRolling rolling_car(BicycleGeometry geometry = BicycleGeometry::kExact) {
  const VehicleParameters<double> p;
  return {.bicycle = {p, {.stiffness = p.C_f}, {.stiffness = p.C_r}, kGravity, geometry},
          .roll = {.gradient = 0.0089, .frequency = 9.0, .damping = 0.25, .arm = 0.35},
          .relaxation_length = 0.3};
}

TEST(RollingBicycle, HoldsItselfOnABankedRoadByTheForceThatGravityTakes) {
  const LinearRolling car = rolling_car();
  RollingState<4> x = RollingState<4>::Zero();
  const double bank = 0.05;
  const auto level = car.rates<4>(x, 0.01, kForwardSpeed);
  const auto banked = car.rates<4>(x, 0.01, kForwardSpeed, {.banked = true, .bank = bank});
  // The sensor feels the tyres; the car slides to the lower, right side.
  EXPECT_DOUBLE_EQ(banked.lateral_acceleration, level.lateral_acceleration);
  EXPECT_NEAR(banked.derivative(0), level.derivative(0) - kGravity * std::sin(bank), 1e-12);
  EXPECT_DOUBLE_EQ(banked.derivative(1), level.derivative(1));
  EXPECT_DOUBLE_EQ(banked.derivative(3), level.derivative(3));
}

TEST(RollingBicycle, GripsByTheLoadOfItsAxles) {
  LinearRolling car = rolling_car();
  RollingState<2> x(0.1, 0.05);
  const auto at_rest = car.rates<2>(x, 0.02, kForwardSpeed);
  car.axle_load = {.acts = true, .downforce_f = 4e-4, .downforce_r = 4e-4};
  // Pressed down equally, both axles and so the whole car have the same more.
  const auto pressed = car.rates<2>(x, 0.02, kForwardSpeed);
  const double more = 1.0 + 4e-4 * kForwardSpeed * kForwardSpeed;
  EXPECT_NEAR(pressed.lateral_acceleration, more * at_rest.lateral_acceleration, 1e-12);
  EXPECT_NEAR(pressed.derivative(1), more * at_rest.derivative(1), 1e-12);
  // What braking takes from the rear axle's static load goes to the front one: m a_x c/L of m g a/L and m g b/L.
  const VehicleParameters<double>& p = car.bicycle.parameters;
  car.axle_load = {.acts = true, .sensitivity = 1.0};
  const auto forces = car.loaded({100.0, 100.0}, 0.0, kForwardSpeed, -5.0);
  const double moved = p.mass * 5.0 * p.cg_height / p.wheelbase();
  EXPECT_NEAR(forces[0] / 100.0 - 1.0, moved / (p.mass * kGravity * p.b / p.wheelbase()), 1e-12);
  EXPECT_NEAR(1.0 - forces[1] / 100.0, moved / (p.mass * kGravity * p.a / p.wheelbase()), 1e-12);
  // Of the braking force a third is in front, half of it on each wheel.
  car.axle_load = {.acts = true, .front_force_share = 1.0 / 3.0};
  const auto steered = car.loaded({100.0, 100.0}, 0.1, kForwardSpeed, -5.0);
  EXPECT_NEAR(steered[0] - 100.0, -p.mass * 5.0 / 6.0 * std::tan(0.1), 1e-9);
  EXPECT_DOUBLE_EQ(steered[1], 100.0);
  car.axle_load = {.acts = true, .sensitivity = 1.0};
  // The load moves by the acceleration along the vehicle, which turning sideways is a part of: a_x = u' - r v.
  const RollingState<2> sliding(0.5, 0.4);
  const auto steady_speed = car.rates<2>(sliding, 0.02, kForwardSpeed);
  const auto no_force_along = car.rates<2>(sliding, 0.02, kForwardSpeed, {.speed_rate = 0.4 * 0.5});
  car.axle_load = {};
  EXPECT_DOUBLE_EQ(no_force_along.derivative(1), car.rates<2>(sliding, 0.02, kForwardSpeed).derivative(1));
  EXPECT_NE(steady_speed.derivative(1), no_force_along.derivative(1));
}

/// Half a second of straight driving, a sine of steering of one second, and what follows.
double single_sine(double t, double amplitude) {
  return amplitude * std::sin(2.0 * kPi * std::clamp(t - 0.5, 0.0, 1.0));
}

/// From straight running through the sine steer, sampled every `every` steps.
template <int kStates>
Eigen::MatrixXd sine_steered(const LinearRolling& model, double amplitude, double duration, double h, int every) {
  const auto derivative = [&](double t, const RollingState<kStates>& x) -> RollingState<kStates> {
    return model.rates<kStates>(x, single_sine(t, amplitude), kForwardSpeed).derivative;
  };
  const auto samples = static_cast<Eigen::Index>(std::lround(duration / (h * every)));
  Eigen::MatrixXd out(samples, kStates);
  RollingState<kStates> x = RollingState<kStates>::Zero();
  for (Eigen::Index k = 0; k < samples; ++k) {
    out.row(k) = x.transpose();
    for (int i = 0; i < every; ++i)
      x = numerics::runge_kutta_4_step(derivative, (static_cast<double>(k) * every + i) * h, x, h);
  }
  return out;
}

/// Largest difference of two columns over the largest value of the second.
double deviation(const Eigen::VectorXd& of, const Eigen::VectorXd& from) {
  return (of - from).cwiseAbs().maxCoeff() / from.cwiseAbs().maxCoeff();
}

TEST(RollingBicycle, WithTwoStatesIsTheBicycleBitForBit) {
  const VehicleParameters<double> p;
  const RollingBicycle<double, FialaTyre<double>> model{
      .bicycle = {.parameters = p, .front = {.stiffness = p.C_f, .mu = 0.9}, .rear = {.stiffness = p.C_r, .mu = 0.9}},
      .roll = {.gradient = 0.01, .arm = 0.4}};
  for (const double v : {-1.3, 0.0, 0.21})
    for (const double r : {-0.4, 0.0, 0.33})
      for (const double steer : {-0.05, 0.0, 0.11}) {
        const auto rates = model.rates<2>(RollingState<2>{v, r}, steer, kForwardSpeed);
        const BicycleRates<double> plane = model.bicycle.rates(v, r, steer, kForwardSpeed);
        EXPECT_EQ(rates.derivative(0), plane.dv);
        EXPECT_EQ(rates.derivative(1), plane.dr);
        EXPECT_EQ(rates.lateral_acceleration, plane.lateral_acceleration);
      }
}

// Whatever the body does: without gradient nothing excites it, without arm it moves no tyre.
TEST(RollingBicycle, WithoutGradientAndArmTheBodyNeitherRollsNorMovesTheTyres) {
  LinearRolling model = rolling_car();
  model.roll.gradient = model.roll.arm = 0.0;
  const RollingState<4> x{0.3, -0.2, 0.04, 0.5};
  const auto rates = model.rates<4>(x, 0.03, kForwardSpeed);
  const BicycleRates<double> plane = model.bicycle.rates(x(0), x(1), 0.03, kForwardSpeed);
  EXPECT_EQ(rates.derivative(0), plane.dv);
  EXPECT_EQ(rates.derivative(1), plane.dr);
  const auto upright = model.rates<4>(RollingState<4>{0.3, -0.2, 0.0, 0.0}, 0.03, kForwardSpeed);
  EXPECT_EQ(upright.derivative(2), 0.0);
  EXPECT_EQ(upright.derivative(3), 0.0);
}

// The steady turn of the bicycle (Newton's method on its rates) is that of the body too, which leans by gradient a_y.
TEST(RollingBicycle, CornersSteadilyWithTheBicycleAndLeansByTheGradient) {
  const LinearRolling model = rolling_car();
  const double steer = 0.04;
  Eigen::Vector2d turn(0.0, 0.3);
  const auto rates_at = [&](const Eigen::Vector2d& s) {
    const BicycleRates<double> rates = model.bicycle.rates(s(0), s(1), steer, kForwardSpeed);
    return Eigen::Vector2d(rates.dv, rates.dr);
  };
  for (int i = 0; i < 20; ++i) {
    constexpr double kStep = 1e-6;
    Eigen::Matrix2d J;
    for (int j = 0; j < 2; ++j) {
      const Eigen::Vector2d step = kStep * Eigen::Vector2d::Unit(j);
      J.col(j) = (rates_at(turn + step) - rates_at(turn - step)) / (2.0 * kStep);
    }
    turn -= J.inverse() * rates_at(turn);
  }
  const auto at_rest = [&]<int kStates>(std::integral_constant<int, kStates>) {
    RollingState<kStates> x = model.steady<kStates>(turn(0), turn(1), steer, kForwardSpeed);
    const auto rates = model.rates<kStates>(x, steer, kForwardSpeed);
    // v' and phi'' of several m/s^2 and rad/s^2 cancel to their rounding.
    EXPECT_LT(rates.derivative.cwiseAbs().maxCoeff(), 1e-11) << kStates;
    EXPECT_NEAR(rates.lateral_acceleration, turn(1) * kForwardSpeed, 1e-11) << kStates;
    return x;
  };
  const RollingState<4> four = at_rest(std::integral_constant<int, 4>());
  const RollingState<6> six = at_rest(std::integral_constant<int, 6>());
  EXPECT_GT(turn(1) * kForwardSpeed, 3.0);  // a turn worth the name
  EXPECT_NEAR(four(2), model.roll.gradient * turn(1) * kForwardSpeed, 1e-13);
  EXPECT_EQ(four(3), 0.0);
  EXPECT_EQ(RollingState<4>(six.head<4>()), four);
}

// Held on the road by an infinitely slow answer of the tyres the body swings alone: with C_f = C_r = 0 the roll's block
// of the linearised matrix has eigenvalues -zeta w +- i w sqrt(1 - zeta^2).
TEST(RollingBicycle, SwingsAtItsFrequencyAndDamping) {
  LinearRolling model = rolling_car();
  model.bicycle.front.stiffness = model.bicycle.rear.stiffness = 0.0;
  const auto eigenvalue = [](const LinearRolling& of) {
    Eigen::MatrixXd A(4, 4);
    for (int j = 0; j < 4; ++j)  // linear in the state without forces
      A.col(j) = of.rates<4>(RollingState<4>::Unit(j), 0.0, kForwardSpeed).derivative;
    const Eigen::VectorXcd all = numerics::general_eigenvalues(A);
    return *std::ranges::max_element(all, {}, [](std::complex<double> e) { return e.imag(); });
  };
  for (const double damping : {0.0, 0.25, 0.7}) {
    model.roll.damping = damping;
    const std::complex<double> found = eigenvalue(model);
    EXPECT_NEAR(found.real(), -damping * model.roll.frequency, 1e-9);
    EXPECT_NEAR(found.imag(), model.roll.frequency * std::sqrt(1.0 - damping * damping), 1e-9);
  }
}

// The same car as a `FourWheelModel` on springs, dampers and bars, tyres nearly rigid upward. With y_i = W/2 its roll
// is
//     I_x phi'' = m c a_y - (K - m_s g c) phi - D phi',  K = W^2/2 (K_sf + 2 K_bf + K_sr + 2 K_br),
//     D = W^2/2 (C_sf + C_sr),
// and its contact points move by c phi'. Tyres of 5e8 N/m give way by 1e-4 of what the springs do; steering of 1e-3 rad
// makes terms of second order (load, heave, pitch) a thousandth of the first: 3e-4 of the largest value.
TEST(RollingBicycle, AgreesWithTheFourWheelModelOnStiffTyres) {
  VehicleParameters<double> p = testing::road_car();
  p.K_tf = p.K_tr = 5e8;
  p.K_bf = 8000.0;
  p.K_br = 3000.0;
  FourWheelOptions options;
  options.geometry = BicycleGeometry::kSmallAngles;
  const testing::LinearCar<double> four = testing::linear_car(p, options);

  const double half_width_squared = 0.5 * p.track_f * p.track_f;
  const double sprung = p.mass - 4.0 * p.unsprung_mass;
  const double springs = half_width_squared * (p.K_sf + 2.0 * p.K_bf + p.K_sr + 2.0 * p.K_br);
  const double stiffness = springs - sprung * kGravity * p.cg_height;
  const double dampers = half_width_squared * (p.C_sf + p.C_sr);
  const double frequency = std::sqrt(stiffness / p.I_x);
  LinearRolling rolling = rolling_car(BicycleGeometry::kSmallAngles);
  rolling.bicycle.parameters = p;
  rolling.roll = {.gradient = p.mass * p.cg_height / stiffness,
                  .frequency = frequency,
                  .damping = dampers / (2.0 * frequency * p.I_x),
                  .arm = p.cg_height};
  ASSERT_EQ(p.track_f, p.track_r);

  constexpr double kAmplitude = 1e-3, kDuration = 3.0, kStep = 2.5e-4;
  constexpr int kEvery = 40;
  const Eigen::MatrixXd bicycle = sine_steered<4>(rolling, kAmplitude, kDuration, kStep, kEvery);
  Eigen::MatrixXd car(bicycle.rows(), 4);
  FourWheelState<double> s = four.steady_start(kForwardSpeed);
  const auto derivative = [&](double t, const FourWheelState<double>& state) -> FourWheelState<double> {
    FourWheelRates<double> rates;
    four.rates(state, four.wheel_controls(single_sine(t, kAmplitude)), {}, rates);
    return rates.derivative;
  };
  for (Eigen::Index k = 0; k < car.rows(); ++k) {
    car.row(k) << s(kV), s(kR), s(kRoll), s(kRollRate);
    for (int i = 0; i < kEvery; ++i)
      s = numerics::runge_kutta_4_step(derivative, (static_cast<double>(k) * kEvery + i) * kStep, s, kStep);
  }
  for (Eigen::Index j = 0; j < 4; ++j) EXPECT_LT(deviation(bicycle.col(j), car.col(j)), 3e-4) << "state " << j;
  // What is compared is seen: without the arm the lateral velocity is another one.
  rolling.roll.arm = 0.0;
  const Eigen::MatrixXd without = sine_steered<4>(rolling, kAmplitude, kDuration, kStep, kEvery);
  EXPECT_GT(deviation(without.col(0), car.col(0)), 0.01);
}

// Slip that lags by a length s is that of s/u before, to first order: half the length, half the difference.
TEST(RollingBicycle, WithAShortRelaxationLengthTendsToThatWithout) {
  LinearRolling model = rolling_car();
  constexpr double kAmplitude = 0.02, kDuration = 2.5, kStep = 2.5e-4;
  const Eigen::MatrixXd at_once = sine_steered<4>(model, kAmplitude, kDuration, kStep, 40);
  const auto difference = [&](double relaxation_length) {
    model.relaxation_length = relaxation_length;
    const Eigen::MatrixXd late = sine_steered<6>(model, kAmplitude, kDuration, kStep, 40);
    return deviation(late.col(1), at_once.col(1));
  };
  const double longer = difference(0.04), shorter = difference(0.02);
  EXPECT_LT(shorter, 0.02);
  EXPECT_GT(shorter, 1e-4);
  EXPECT_NEAR(longer / shorter, 2.0, 0.05);  // second order: s/u = 2 ms over the yaw's 0.1 s
}

TEST(RollingBicycle, MirroredSteeringAndStateGiveMirroredRates) {
  const LinearRolling model = rolling_car();
  RollingState<6> x;
  x << 0.4, -0.3, 0.05, 0.6, 0.03, -0.02;
  const auto left = model.rates<6>(x, 0.07, kForwardSpeed);
  const auto right = model.rates<6>(RollingState<6>(-x), -0.07, kForwardSpeed);
  EXPECT_EQ(left.derivative, RollingState<6>(-right.derivative));
  EXPECT_EQ(left.lateral_acceleration, -right.lateral_acceleration);
  EXPECT_EQ(model.steady<6>(0.4, -0.3, 0.07, kForwardSpeed),
            RollingState<6>(-model.steady<6>(-0.4, 0.3, -0.07, kForwardSpeed)));
  const RollingState<4> body = x.head<4>();
  EXPECT_EQ(model.rates<4>(body, 0.07, kForwardSpeed).derivative,
            RollingState<4>(-model.rates<4>(RollingState<4>(-body), -0.07, kForwardSpeed).derivative));
}

// In steady cornering the body carries a_y: at 1 g it is what is given, at half of it a quarter.
TEST(RollingBicycle, LosesForceWithTheSquareOfTheLoadThatMoves) {
  LinearRolling model = rolling_car();
  model.load_transfer = {.effect = LoadTransfer<double>::Effect::kLoss, .loss = 0.2};
  const std::array<double, 2> slip{0.03, 0.02};
  const std::array<double, 2> whole = model.bicycle.tyre_forces(slip);
  for (const double g : {-0.5, 0.0, 0.5, 1.0}) {
    const RollingState<4> x{0.0, 0.0, g * kGravity * model.roll.gradient, 0.0};
    const std::array<double, 2> left = model.axle_forces<4>(slip, x);
    for (std::size_t axle = 0; axle < 2; ++axle)
      EXPECT_NEAR(left[axle], (1.0 - 0.2 * g * g) * whole[axle], 1e-9 * whole[axle]) << g;
  }
  // What the balance adds in front it takes off behind.
  model.load_transfer.balance = 0.3;
  const std::array<double, 2> shared = model.axle_forces<4>(slip, {0.0, 0.0, kGravity * model.roll.gradient, 0.0});
  EXPECT_NEAR(shared[0], (1.0 - 0.26) * whole[0], 1e-9 * whole[0]);
  EXPECT_NEAR(shared[1], (1.0 - 0.14) * whole[1], 1e-9 * whole[1]);
  // A body without springs' travel to show it by, and two states, have none.
  model.roll.gradient = 0.0;
  EXPECT_EQ(model.axle_forces<4>(slip, {0.0, 0.0, 0.05, 0.0}), whole);
}

// Fiala's force S - S^2/(3 N) + S^3/(27 N^2) of two wheels with N (1 +- x): the mean of 1/(1 +- x) is 1/(1 - x^2), that
// of its square (1 + x^2)/(1 - x^2)^2. At small slip nothing is lost.
TEST(RollingBicycle, WheelsOfUnequalLoadReachTheFrictionLimitSooner) {
  const LinearRolling linear = rolling_car();
  const VehicleParameters<double>& p = linear.bicycle.parameters;
  RollingBicycle<double, FialaTyre<double>> model{
      .bicycle = {.parameters = p, .front = {.stiffness = p.C_f, .mu = 0.9}, .rear = {.stiffness = p.C_r, .mu = 0.9}},
      .roll = linear.roll};
  model.load_transfer = {.effect = LoadTransfer<double>::Effect::kLoads, .share = 0.7, .balance = 0.2};
  const PerWheel<double> load = static_loads(p, kGravity);
  const std::array<double, 2> C{p.C_f, p.C_r}, share{0.7 * 1.2, 0.7 * 0.8};
  for (const double n : {0.0, 0.3, -0.6}) {
    const RollingState<4> x{0.0, 0.0, n * kGravity * model.roll.gradient, 0.0};
    for (const double slip : {1e-6, 0.02, -0.035}) {
      const std::array<double, 2> force = model.axle_forces<4>({slip, slip}, x);
      for (std::size_t axle = 0; axle < 2; ++axle) {
        const double S = C[axle] * std::abs(slip), N = 0.9 * load[axle == 0 ? kFrontLeft : kRearLeft];
        const double moved = share[axle] * n, rest = 1.0 - moved * moved;
        const double closed =
            S - S * S / (3.0 * N * rest) + S * S * S * (1.0 + moved * moved) / (27.0 * N * N * rest * rest);
        EXPECT_NEAR(force[axle], std::copysign(closed, slip), 1e-9 * S) << n << ", " << slip;
      }
    }
  }
}

// What dampers carry while the body is on its way counts as what springs carry: both press on the outer wheel.
TEST(RollingBicycle, DampersMoveLoadAsSpringsDo) {
  LinearRolling model = rolling_car();
  model.load_transfer = {.effect = LoadTransfer<double>::Effect::kLoss, .loss = 0.3};
  const std::array<double, 2> slip{0.03, 0.02};
  const double rate = 0.04 * model.roll.frequency / (2.0 * model.roll.damping);
  EXPECT_EQ(model.axle_forces<4>(slip, {0.0, 0.0, 0.04, 0.0}), model.axle_forces<4>(slip, {0.0, 0.0, 0.0, rate}));
}

// In a steady turn the moments of both axles balance about the centre of gravity, where trail moves both forces back:
// F_f = m a_y (b + t)/L; roll steer is slip that needs no steering. Small angles:
//     delta = L a_y/u^2 + K a_y,  K = m (b + t)/(2 L C_f) - m (a - t)/(2 L C_r) - (e_f - e_r) roll per a_y.
TEST(RollingBicycle, UndersteersByTrailAndRollSteerAsTheBalanceOfASteadyTurnSays) {
  LinearRolling car = rolling_car(BicycleGeometry::kSmallAngles);
  car.trail = 0.03;
  car.roll_steer = {-0.06, 0.04};
  const VehicleParameters<double>& p = car.bicycle.parameters;
  Eigen::Matrix4d A;
  const double small = 1e-6;
  for (Eigen::Index i = 0; i < 4; ++i)
    A.col(i) = car.rates<4>(small * RollingState<4>::Unit(i), 0.0, kForwardSpeed).derivative / small;
  const RollingState<4> B = car.rates<4>(RollingState<4>::Zero(), small, kForwardSpeed).derivative / small;
  const RollingState<4> steady = -A.inverse() * B;
  const double lateral = steady(1) * kForwardSpeed, L = p.wheelbase();
  const double understeer = p.mass * (p.b + car.trail) / (2.0 * L * p.C_f) -
                            p.mass * (p.a - car.trail) / (2.0 * L * p.C_r) + (0.06 + 0.04) * car.roll.gradient;
  EXPECT_NEAR(1.0 / lateral, L / (kForwardSpeed * kForwardSpeed) + understeer, 1e-9);
  EXPECT_NEAR(steady(2), car.roll.gradient * lateral, 1e-9);
}

}  // namespace
}  // namespace veridyn::vehicle
