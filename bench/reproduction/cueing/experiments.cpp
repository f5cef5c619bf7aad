#include "bench/reproduction/cueing/experiments.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/cueing/platform/platform_simulator.hpp"
#include "veridyn/cueing/washout/classical_washout.hpp"
#include "veridyn/cueing/washout/tilt_washout.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/vehicle/model/builtin_vehicles.hpp"
#include "veridyn/vehicle/simulation/stepped_drive.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::cueing {
namespace {

constexpr double kControlStep = 0.01;  // [s]

/// From 0 to 1 with a continuous second derivative.
double smooth(double part) {
  const double s = std::clamp(part, 0.0, 1.0);
  return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
}

/// Up, along, down and level again [rad].
double ramp_angle(double t) {
  constexpr double kRamp = 30.0 * kDegree;
  return kRamp * (smooth((t - 2.0) / 0.6) - 2.0 * smooth((t - 8.0) / 1.2) + smooth((t - 15.0) / 0.6));
}

recording::MotionSample standing() {
  recording::MotionSample s;
  s.frame = Frame::kFrd;
  s.force = recording::force_at_rest(Frame::kFrd);
  return s;
}

/// One fifth of a car, driven along by its wheels.
class ScaledCar {
 public:
  ScaledCar() : drive_(model()) { drive_.reset(0.0); }
  /// Specific force forward after a step. @param wanted acceleration [m/s^2]
  double step(double wanted) {
    const auto& p = drive_.model().parameters();
    const double torque = p.mass * wanted * drive_.model().options().longitudinal->wheel_radius;
    drive_.step({.drive_torque = std::max(torque, 0.0), .brake_torque = std::max(-torque, 0.0)}, kControlStep);
    return drive_.motion().force.x();
  }
  /// Nose up [rad].
  [[nodiscard]] double pitch() const { return -drive_.state().vehicle(vehicle::kPitch); }
  [[nodiscard]] double position() const { return drive_.state().vehicle(vehicle::kX); }

 private:
  using Tyre = vehicle::LinearTyre<double>;
  static vehicle::FourWheelModel<double, Tyre> model();
  vehicle::SteppedDrive<Tyre> drive_;
};

}  // namespace

Experiment ramp(PlatformAxis axis) {
  const bool pitches = axis == PlatformAxis::kPitch;
  const Eigen::Index about = pitches ? 1 : 0;
  ClassicalDesign design;
  design.force_gain = design.rate_gain = {1.0, 1.0, 1.0};
  design.tilt_rate = 60.0 * kDegree;
  ClassicalWashout washout(design);
  Experiment e{.time = {}, .curves = {{"road", {}}, {"with washout", {}}, {"without washout", {}}}};
  double turned = 0.0, before = 0.0;
  for (int k = 0; k <= 2400; ++k) {
    const double t = kControlStep * k, angle = ramp_angle(t);
    recording::MotionSample s = standing();
    const Eigen::Vector3d attitude = angle * Eigen::Vector3d::Unit(about);
    s.time = t;
    s.rate(about) = k == 0 ? 0.0 : (angle - before) / kControlStep;
    s.attitude = numerics::quaternion_from_euler(attitude.x(), attitude.y(), 0.0);
    s.attitude_from = recording::Origin::kDerived;
    s.force = numerics::R_body_from_ned(attitude.x(), attitude.y(), 0.0) * s.force;
    const PlatformCommand c = k == 0 ? washout.reset(s) : washout.step(s, kControlStep);
    turned += k == 0 ? 0.0 : s.rate(about) * kControlStep;
    const double tilt = std::asin(std::clamp(tilted_force(s.force)(about) / kGravity, -1.0, 1.0));
    e.time.push_back(t);
    e.curves[0].values.push_back(angle);
    e.curves[1].values.push_back(c.angle(about));
    e.curves[2].values.push_back(turned + tilt);
    before = angle;
  }
  return e;
}

vehicle::FourWheelModel<double, vehicle::LinearTyre<double>> ScaledCar::model() {
  const vehicle::VehicleParameters<double>& p = vehicle::builtin_vehicle("reference_1to5").parameters;
  vehicle::FourWheelOptions options;
  options.longitudinal.emplace();
  options.longitudinal->wheel_radius = 0.06;
  options.longitudinal->wheel_inertia = 5e-4;
  options.longitudinal->drag_area = 0.02;
  Tyre front, rear;
  front.stiffness = p.C_f;
  rear.stiffness = p.C_r;
  return {p, {front, front, rear, rear}, options};
}

Experiment level_track() {
  constexpr double kPixel = 1.0 / 250.0, kCamera = 0.02;  // [m], [s]
  constexpr std::size_t kFrames = 16;                     // 0.3 s of them
  constexpr std::size_t kLag = 15;                        // samples from the middle of the parabola to now
  ScaledCar car;
  numerics::CausalFilter naive(numerics::low_pass(2.0, 1.0)), compensated(numerics::low_pass(2.0, 1.0));
  naive.reset(0.0);
  compensated.reset(0.0);
  const auto leaning = [](double force) { return std::asin(std::clamp(force / kGravity, -1.0, 1.0)); };
  Experiment e{.time = {}, .curves = {{"naive", {}}, {"with the camera", {}}}};
  std::vector<double> force, seen;
  double camera = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double t = kControlStep * k;
    // Starts, coasts and brakes, again and again.
    const double phase = std::fmod(t, 8.0), wanted = phase < 1.0 ? 0.0 : phase < 4.0 ? 1.2 : phase < 7.0 ? -1.2 : 0.0;
    // The car leans back and forth on its springs as well: that pitch is not a false one.
    force.push_back(car.step(wanted) - kGravity * std::sin(car.pitch()));
    if (k % 2 == 0) seen.push_back(kPixel * std::round(car.position() / kPixel));
    if (k % 2 == 0 && seen.size() >= kFrames) {
      Eigen::Matrix<double, kFrames, 3> terms;
      Eigen::Matrix<double, kFrames, 1> places;
      for (std::size_t i = 0; i < kFrames; ++i) {
        const double s = kCamera * (static_cast<double>(i) - 0.5 * (kFrames - 1.0));
        terms.row(i) << 1.0, s, 0.5 * s * s;
        places(i) = seen[seen.size() - kFrames + i];
      }
      camera = terms.colPivHouseholderQr().solve(places)(2);
    }
    const double then = force.size() > kLag ? force[force.size() - 1 - kLag] : 0.0;
    e.time.push_back(t);
    e.curves[0].values.push_back(naive.step(leaning(force.back()), kControlStep));
    e.curves[1].values.push_back(compensated.step(leaning(then - camera), kControlStep));
  }
  return e;
}

double reached(PlatformAxis axis, double ordered) {
  const Platform& platform = built_in_platform("three_axis_measured");
  PlatformSimulator simulator(platform);
  PlatformState command;
  simulator.reset(command);
  for (int k = 0; k < 1000; ++k) {
    set_axis(command, axis, {ordered * smooth(kControlStep * k / 4.0), 0.0, 0.0});
    simulator.step(command, kControlStep);
  }
  return cueing::axis(simulator.state(), axis).position;
}

double held_tilt(PlatformAxis axis, double force) {
  TiltDesign design;
  design.force_gain = {1.0, 1.0};
  const auto washout = design.make(built_in_platform("three_axis_measured"));
  recording::MotionSample s = standing();
  washout->reset(s);
  const bool pitches = axis == PlatformAxis::kPitch;
  if (pitches) {
    s.force.x() += force;
  } else {
    s.force.y() -= force;
  }
  PlatformCommand c;
  for (int k = 0; k < 3000; ++k) c = washout->step(s, kControlStep);
  return reached(axis, c.angle(pitches ? 1 : 0));
}

}  // namespace veridyn::cueing
