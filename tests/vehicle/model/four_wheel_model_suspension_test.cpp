#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "tests/support/refusal.hpp"
#include "tests/vehicle/cars.hpp"
#include "tests/vehicle/model/moments.hpp"
#include "tests/vehicle/simulation/drives.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/model/four_wheel_analysis.hpp"

// What suspension geometry, compliance, trail and air do to steady driving, in closed form.

namespace veridyn::vehicle {
namespace {

using testing::drive;
using testing::linear_car;
using testing::LinearCar;
using testing::trailing_car;
using testing::uneven_car;

constexpr double kSpeed = 25.0;

/// In a steady turn on linear tyres, per lateral acceleration: body and axles by hand. Springs and tyres of an axle are
/// in series; the links bring h F past the springs.
struct SteadyTurn {
  explicit SteadyTurn(const VehicleParameters<double>& p, const FourWheelOptions& options = {}) {
    const double L = p.a + p.b;
    const std::array<double, 2> h{options.suspension_f.roll_centre, options.suspension_r.roll_centre};
    const std::array<double, 2> track{p.track_f, p.track_r};
    const std::array<double, 2> spring{p.K_sf + 2.0 * p.K_bf, p.K_sr + 2.0 * p.K_br}, tyre{p.K_tf, p.K_tr};
    force = {p.mass * p.b / L, p.mass * p.a / L};
    double stiffness = 0.0, moment = 0.0;
    double tilting = (p.mass - 4.0 * p.unsprung_mass) * kGravity * p.cg_height;
    for (std::size_t i = 0; i < 2; ++i) {
      spring_roll[i] = 0.5 * track[i] * track[i] * spring[i];
      tyre_roll[i] = 0.5 * track[i] * track[i] * tyre[i];
      const double share = spring_roll[i] / (spring_roll[i] + tyre_roll[i]);
      stiffness += share * tyre_roll[i];
      moment += force[i] * (p.cg_height - h[i] + share * h[i]);
      tilting -= (force[i] * kGravity - 2.0 * p.unsprung_mass * kGravity) * h[i];
    }
    roll = moment / (stiffness - tilting);
    for (std::size_t i = 0; i < 2; ++i) {
      axle_roll[i] = (tyre_roll[i] * roll - h[i] * force[i]) / (spring_roll[i] + tyre_roll[i]);
      transfer[i] = (spring_roll[i] * axle_roll[i] + h[i] * force[i]) / track[i];
    }
  }
  std::array<double, 2> force{}, spring_roll{}, tyre_roll{};
  double roll = 0.0;                  ///< of the body [rad s^2/m]
  std::array<double, 2> axle_roll{};  ///< of the body against the axle, front and rear
  std::array<double, 2> transfer{};   ///< of load from a left to a right tyre [kg]
};

FourWheelResponse steady(const LinearCar<double>& car) { return frequency_response(linearise(car, kSpeed), 1e-7); }

/// K of r/delta = u/(L + K u^2) [rad s^2/m].
double understeer_gradient(const LinearCar<double>& car) {
  const double L = car.parameters().a + car.parameters().b;
  return (kSpeed / steady(car).yaw_rate.real() - L) / (kSpeed * kSpeed);
}

TEST(FourWheelModel, RollsAboutItsRollCentres) {
  const VehicleParameters<double> p = uneven_car();
  FourWheelOptions options;
  options.suspension_f.roll_centre = 0.05;
  options.suspension_r.roll_centre = 0.22;
  const FourWheelResponse response = steady(linear_car(p, options));
  const double roll = response.roll.real() / response.lateral_acceleration.real();
  EXPECT_NEAR(roll, SteadyTurn(p, options).roll, 1e-6 * roll);
  EXPECT_LT(roll, 0.7 * SteadyTurn(p).roll);  // what the test would miss without them
  EXPECT_NEAR(understeer_gradient(linear_car(p, options)), understeer_gradient(linear_car(p)), 1e-9);
  // A body with its centre of gravity at roll centres of that height does not roll, but for the tyres beneath.
  VehicleParameters<double> stiff = p;
  stiff.K_tf = stiff.K_tr = 1e9;
  options.suspension_f.roll_centre = options.suspension_r.roll_centre = p.cg_height;
  EXPECT_NEAR(steady(linear_car(stiff, options)).roll.real(), 0.0, 1e-4 * response.roll.real());
}

// Of each axle: the springs' share in its roll and h F at once; together m a c and what gravity tilts.
TEST(FourWheelModel, TransfersLoadBySpringsAndLinks) {
  const VehicleParameters<double> p = uneven_car();
  FourWheelOptions options;
  options.suspension_f.roll_centre = 0.05;
  options.suspension_r.roll_centre = 0.22;
  const auto out = drive(linear_car(p, options), [](double) { return Controls{.steer = 0.004}; }, {.duration = 15.0});
  const double a_y = out.lateral_acceleration.back();
  ASSERT_NEAR(out.yaw_acceleration.back(), 0.0, 1e-9);
  const SteadyTurn expected(p, options);
  for (std::size_t axle = 0; axle < 2; ++axle) {
    const double moved = 0.5 * (out.Fz[2 * axle + 1].back() - out.Fz[2 * axle].back());
    // Terms of second order: forces turned by the steer angle, links that jack the body up.
    EXPECT_NEAR(moved, expected.transfer[axle] * a_y, 2e-3 * moved) << axle;
    EXPECT_GT(moved, 50.0);
  }
  const double tilting =
      p.mass * p.cg_height * a_y +
      ((p.mass - 4.0 * p.unsprung_mass) * p.cg_height * kGravity -
       2.0 * kGravity *
           (0.05 * (0.5 * expected.force[0] - p.unsprung_mass) + 0.22 * (0.5 * expected.force[1] - p.unsprung_mass))) *
          out.roll.back();
  const double couple =
      0.5 * p.track_f * (out.Fz[1].back() - out.Fz[0].back()) + 0.5 * p.track_r * (out.Fz[3].back() - out.Fz[2].back());
  EXPECT_NEAR(couple, tilting, 1e-3 * couple);
}

TEST(FourWheelModel, RollSteerAddsTheAxlesRollToTheUndersteerGradient) {
  const VehicleParameters<double> p = uneven_car();
  const double none = understeer_gradient(linear_car(p));
  FourWheelOptions options;
  options.suspension_f = {.roll_centre = 0.04, .roll_steer = -0.06};
  options.suspension_r = {.roll_centre = 0.10, .roll_steer = 0.09};
  const SteadyTurn turn(p, options);
  const double change = 0.06 * turn.axle_roll[0] + 0.09 * turn.axle_roll[1];
  EXPECT_NEAR(understeer_gradient(linear_car(p, options)) - none, change, 1e-6 * change);
  EXPECT_GT(change, 0.1 * std::abs(none));
}

TEST(FourWheelModel, BumpSteerActsInRollAsHalfTheTrackOfRollSteer) {
  const VehicleParameters<double> p = uneven_car();
  FourWheelOptions bump, roll;
  bump.suspension_f.bump_steer = -0.1;
  bump.suspension_r.bump_steer = 0.05;
  roll.suspension_f.roll_steer = -0.1 * 0.5 * p.track_f;
  roll.suspension_r.roll_steer = 0.05 * 0.5 * p.track_r;
  EXPECT_NEAR(understeer_gradient(linear_car(p, bump)), understeer_gradient(linear_car(p, roll)), 1e-9);
  EXPECT_GT(understeer_gradient(linear_car(p, bump)), 1.01 * understeer_gradient(linear_car(p)));
}

// Wheels that turn by c F: slip angles of F/C and -c F of steer.
TEST(FourWheelModel, ComplianceSteerAddsTheAxlesForcesToTheUndersteerGradient) {
  const VehicleParameters<double> p = uneven_car();
  const double none = understeer_gradient(linear_car(p));
  const double c_f = -5e-6, c_r = 1.5e-6;
  FourWheelOptions options;
  options.suspension_f.compliance_steer = c_f;
  options.suspension_r.compliance_steer = c_r;
  const SteadyTurn turn(p);
  const double change = -c_f * 0.5 * turn.force[0] + c_r * 0.5 * turn.force[1];
  EXPECT_NEAR(understeer_gradient(linear_car(p, options)) - none, change, 1e-6 * change);
  // With lagging slip the steady state is the same.
  options.relaxation_length = 0.4;
  EXPECT_NEAR(understeer_gradient(linear_car(p, options)) - none, change, 1e-5 * change);
}

// Forces act a trail t behind the wheels: moments about the centre of gravity balance with a - t and b + t.
TEST(FourWheelModel, AligningMomentsMoveForceToTheFrontAxle) {
  const VehicleParameters<double> p = uneven_car();
  FourWheelOptions options;
  EXPECT_EQ(understeer_gradient(trailing_car(p, options)), understeer_gradient(linear_car(p)));  // off by default
  options.aligning_moment = true;
  const double t = 0.03, L = p.a + p.b;
  const double front = p.mass * (p.b + t) / L, rear = p.mass * (p.a - t) / L;
  const double expected = 0.5 * front / p.C_f - 0.5 * rear / p.C_r;
  const double found = understeer_gradient(trailing_car(p, options));
  EXPECT_NEAR(found, expected, 1e-6 * expected);
  EXPECT_GT(found, 1.1 * understeer_gradient(linear_car(p)));
  const auto out = [&] {
    FourWheelRates<double> rates;
    const auto car = trailing_car(p, options);
    FourWheelState<double> state = car.steady_start(kSpeed);
    state(kV) = -0.5;
    car.rates(state, car.wheel_controls(0.02), {}, rates);
    return rates;
  }();
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_NEAR(out.aligning_moment[i], -t * out.Fy[i], 1e-12);
}

struct TyreWithoutMoment {
  [[nodiscard]] TyreForces<double> forces(const double& /*load*/, const double& /*ratio*/, const double& angle,
                                          const double& /*camber*/) const {
    return {0.0, 5e4 * angle};
  }
  [[nodiscard]] double cornering_stiffness(const double& /*load*/) const { return 5e4; }
};

TEST(FourWheelModel, RefusesAligningMomentsOfTyresThatHaveNone) {
  FourWheelOptions options;
  options.aligning_moment = true;
  EXPECT_EQ(why([&] { (void)FourWheelModel<double, TyreWithoutMoment>({}, {}, options); }),
            "vehicle: aligning_moment needs a tyre that has one");
}

// A spring whose table is its constant rate is that rate; one that stiffens rolls less as it travels.
TEST(FourWheelModel, SpringsByTableTakeThePlaceOfRates) {
  VehicleParameters<double> p = uneven_car();
  FourWheelOptions options;
  options.suspension_f.spring = SpringCurve({-0.1, 0.1}, {-0.1 * p.K_sf, 0.1 * p.K_sf});
  options.suspension_r.spring = SpringCurve({-0.1, 0.1}, {1000.0 - 0.1 * p.K_sr, 1000.0 + 0.1 * p.K_sr});
  const auto by_rate = steady(linear_car(p));
  EXPECT_NEAR(steady(linear_car(p, options)).roll.real(), by_rate.roll.real(), 1e-7);
  p.K_sf = p.K_sr = 1.0;  // not used
  EXPECT_NEAR(steady(linear_car(p, options)).roll.real(), by_rate.roll.real(), 1e-7);
  // Statics of a body that is lifted and let down: heave where the springs carry the weight of a raised corner.
  p = uneven_car();
  const SpringCurve progressive({-0.10, -0.03, 0.03, 0.10}, {-2200.0, -700.0, 800.0, 4000.0});
  options.suspension_f.spring = options.suspension_r.spring = progressive;
  const auto car = linear_car(p, options);
  FourWheelState<double> state = car.steady_start(kSpeed);
  state(kHeave) = -0.05;
  FourWheelRates<double> rates;
  car.rates(state, car.wheel_controls(0.0), {}, rates);
  for (Eigen::Index i = 0; i < 4; ++i) EXPECT_NEAR(rates.suspension_force[i], progressive.force(0.05), 1e-9);
  EXPECT_NEAR(rates.derivative(kHeaveRate), 4.0 * progressive.force(0.05) / (p.mass - 4.0 * p.unsprung_mass), 1e-10);
}

// Each axle's tyres carry less by what the air lifts there, from the first moment on.
TEST(FourWheelModel, RestsInTheLiftOfTheAir) {
  const VehicleParameters<double> p = uneven_car();
  for (const bool curved : {false, true}) {
    FourWheelOptions options;
    options.lift = {.area_f = 0.3, .area_r = -0.6, .air_density = 1.2};
    if (curved) options.suspension_r.spring = SpringCurve({-0.1, 0.0, 0.1}, {-2000.0, 0.0, 3500.0});
    const auto car = linear_car(p, options);
    const FourWheelState<double> start = car.steady_start(50.0);
    FourWheelRates<double> rates;
    car.rates(start, car.wheel_controls(0.0), {}, rates);
    for (const Eigen::Index i :
         std::array<Eigen::Index, 5>{kHeaveRate, kPitchRate, kRollRate, kWheelHeightRate, kWheelHeightRate + 2})
      EXPECT_NEAR(rates.derivative(i), 0.0, 1e-9) << i;
    const double pressure = 0.5 * 1.2 * 50.0 * 50.0;
    // Gravity's moment on the pitched body is carried too.
    const double moved = (p.mass - 4.0 * p.unsprung_mass) * kGravity * p.cg_height * start(kPitch) / (p.a + p.b);
    EXPECT_NEAR(rates.Fz[0], car.rest_loads()[0] + 0.5 * (-0.3 * pressure + moved), 1.0);
    EXPECT_NEAR(rates.Fz[2], car.rest_loads()[2] + 0.5 * (0.6 * pressure - moved), 1.0);
    EXPECT_NEAR(rates.Fz.sum(), p.mass * kGravity + 0.3 * pressure, 1e-8);
    EXPECT_LT(start(kPitch), 0.0);  // lifted in front and pressed down behind
    EXPECT_EQ(linear_car(p).steady_start(50.0)(kHeave), 0.0);
  }
}

// Drag alone: m_eff u' = -B u^2, 1/u = 1/u_0 + B t/m_eff. Lift changes the loads and not that.
TEST(FourWheelModel, CoastsDownInDragWhateverLiftsIt) {
  const VehicleParameters<double> p = uneven_car();
  const LongitudinalParameters l{.wheel_inertia = 0.8, .drag_area = 0.9, .rolling_resistance = 0.0};
  FourWheelOptions options;
  options.longitudinal = l;
  options.lift = {.area_f = 0.2, .area_r = 0.3};
  const LinearTyre<double> stiff{.stiffness = 60000.0, .slip_stiffness = 3e6};  // hardly slips
  const LinearCar<double> car(p, {stiff, stiff, stiff, stiff}, options);
  const auto out = drive(car, testing::hands_off, {.duration = 30.0, .speed = 50.0});
  ASSERT_EQ(out.end, DriveEnd::kCompleted) << out.message();
  const double B = 0.5 * l.air_density * l.drag_area;
  const double mass = p.mass + 4.0 * l.wheel_inertia / (l.wheel_radius * l.wheel_radius);
  for (const std::size_t k : {std::size_t{1000}, out.size() - 1})
    EXPECT_NEAR(out.u[k], 1.0 / (1.0 / 50.0 + B * out.time[k] / mass), 2e-3) << k;
  EXPECT_LT(out.u.back(), 35.0);
  EXPECT_NEAR(out.Fz[0].front() + out.Fz[1].front() + out.Fz[2].front() + out.Fz[3].front(),
              p.mass * kGravity - 0.5 * 1.225 * 0.5 * 2500.0, 1e-6);
}

}  // namespace
}  // namespace veridyn::vehicle
