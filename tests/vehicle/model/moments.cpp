#include "tests/vehicle/model/moments.hpp"

namespace veridyn::vehicle::testing {

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

FourWheelOptions every_option() {
  FourWheelOptions options;
  options.suspension_f = {.roll_centre = 0.06,
                          .roll_steer = -0.05,
                          .bump_steer = 0.2,
                          .compliance_steer = -4e-6,
                          .spring = SpringCurve({-0.08, -0.02, 0.03, 0.08}, {-2000.0, -600.0, 900.0, 4000.0})};
  options.suspension_r = {.roll_centre = 0.15,
                          .roll_steer = 0.08,
                          .bump_steer = -0.1,
                          .compliance_steer = 2e-6,
                          .spring = SpringCurve({-0.1, 0.0, 0.05}, {-2500.0, 0.0, 1500.0})};
  options.lift = {.area_f = 0.2, .area_r = -0.5};
  options.aligning_moment = true;
  return options;
}

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

}  // namespace veridyn::vehicle::testing
