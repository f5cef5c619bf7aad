#include "tests/aircraft/campaign/faults.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/support/channel_faults.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft::testing {
namespace {

using Names = test::ChannelNames;
using Change = std::function<void(FlightStudy&)>;

const Names kAccel{"accel_x", "accel_y", "accel_z"};
const Names kGyro{"gyro_x", "gyro_y", "gyro_z"};
const Names kAttitude{"roll", "pitch", "yaw"};
const Names kVelocity{"vel_north", "vel_east", "vel_down"};
const Names kPitot{"dynamic_pressure"};
const Names kSurfaces{"elevator", "aileron", "rudder"};

/// A fault of the recording.
Change in_recording(test::RecordingFault fault) {
  return [fault = std::move(fault)](FlightStudy& study) { fault(study.mapped.recording); };
}

Change scaled(Names names, double factor, double offset = 0.0) {
  return in_recording(test::scaled(std::move(names), factor, offset));
}
Change swapped(const char* first, const char* second) { return in_recording(test::swapped(first, second)); }
Change delayed(Names names, double delay_s) { return in_recording(test::delayed(std::move(names), delay_s)); }
Change held(Names names, double period_s) { return in_recording(test::held(std::move(names), period_s)); }
Change frozen(Names names, double share) { return in_recording(test::frozen(std::move(names), share)); }
Change clipped(Names names, double low, double high) {
  return in_recording(test::clipped(std::move(names), low, high));
}
Change quantised(Names names, double step) { return in_recording(test::quantised(std::move(names), step)); }
Change with_spikes(Names names, double size, std::size_t every) {
  return in_recording(test::with_spikes(std::move(names), size, every));
}
Change smoothed(Names names, double time_constant_s) {
  return in_recording(test::smoothed(std::move(names), time_constant_s));
}
Change with_clock(std::function<double(double)> stamp) { return in_recording(test::with_clock(std::move(stamp))); }
Change with_gaps(double every_s, double length_s) { return in_recording(test::with_gaps(every_s, length_s)); }

/// Turns the three channels about an axis of the body.
Change turned(Names names, const Eigen::Vector3d& rotation) {
  return [=](FlightStudy& study) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
    Recording& recording = study.mapped.recording;
    std::array<Channel, 3> c{recording.at(names[0]), recording.at(names[1]), recording.at(names[2])};
    for (std::size_t i = 0; i < c[0].size(); ++i) {
      const Eigen::Vector3d v = R * Eigen::Vector3d(c[0].value[i], c[1].value[i], c[2].value[i]);
      for (std::size_t k = 0; k < 3; ++k) c[k].value[i] = v(k);
    }
    for (Channel& channel : c) recording.set(std::move(channel));
  };
}

/// What a phone calls linear acceleration: specific force plus gravity.
void without_gravity(FlightStudy& study) {
  Recording& recording = study.mapped.recording;
  std::array<Channel, 3> a{recording.at("accel_x"), recording.at("accel_y"), recording.at("accel_z")};
  const Channel &roll = recording.at("roll"), &pitch = recording.at("pitch"), &yaw = recording.at("yaw");
  for (std::size_t i = 0; i < std::min(a[0].size(), roll.size()); ++i) {
    const Eigen::Vector3d g =
        numerics::R_body_from_ned(roll.value[i], pitch.value[i], yaw.value[i]) * Eigen::Vector3d(0.0, 0.0, kGravity);
    for (std::size_t k = 0; k < 3; ++k) a[k].value[i] += g(k);
  }
  for (Channel& channel : a) recording.set(std::move(channel));
}

Change of_subject(std::function<void(Subject&)> change) {
  return [=](FlightStudy& study) { change(study.subject); };
}

std::vector<Fault> all_faults() {
  constexpr double kKnot = 0.514444;
  using estimation::Check;
  using test::NamedBy;
  const NamedBy accel({"accelerometer"}, {Check::kAccelerometerBias, Check::kAccelerometerDelay}),
      gyro({"gyro"}, {Check::kGyroBias, Check::kGyroDelay}), attitude({"attitude", "roll", "pitch", "yaw"}),
      velocity({"ground velocity", "vel_north", "vel_east", "vel_down"}), air({"airspeed", "dynamic_pressure"}),
      alpha({"alpha"}), beta({"beta"}), both({"alpha", "beta"}),
      controls({"controls", "elevator", "aileron", "rudder"}),
      body({"body", "mass", "inertia", "CL_alpha", "CL"}, {Check::kPlausibleLiftSlope}), clock({"time"});
  return {
      {"accelerometer in g", accel, scaled(kAccel, 1.0 / kGravity)},
      {"accelerometer without gravity", accel, without_gravity},
      {"accelerometer x reversed", accel, scaled({"accel_x"}, -1.0)},
      {"accelerometer y reversed", accel, scaled({"accel_y"}, -1.0)},
      {"accelerometer z reversed", accel, scaled({"accel_z"}, -1.0)},
      {"accelerometer x and y swapped", accel, swapped("accel_x", "accel_y")},
      {"accelerometer 5 % high", accel, scaled(kAccel, 1.05)},
      {"accelerometer 20 % high", accel, scaled(kAccel, 1.2)},
      {"accelerometer x off by 0.3 m/s^2", accel, scaled({"accel_x"}, 1.0, 0.3)},
      {"accelerometer z off by 1 m/s^2", accel, scaled({"accel_z"}, 1.0, 1.0)},
      {"accelerometer pitched by 3 deg", accel, turned(kAccel, {0.0, 3.0 * kDegree, 0.0})},
      {"accelerometer z clipped at -11 m/s^2", accel, clipped({"accel_z"}, -11.0, 11.0)},
      {"accelerometer in steps of 1 m/s^2", accel, quantised(kAccel, 1.0)},
      {"accelerometer 0.1 s late", accel, delayed(kAccel, 0.1)},
      {"accelerometer held at 2 Hz", accel, held(kAccel, 0.5)},
      {"accelerometer frozen for 10 %", accel, frozen(kAccel, 0.1)},
      {"gyro in deg/s", gyro, scaled(kGyro, 1.0 / kDegree)},
      {"gyro x reversed", gyro, scaled({"gyro_x"}, -1.0)},
      {"gyro y reversed", gyro, scaled({"gyro_y"}, -1.0)},
      {"gyro z reversed", gyro, scaled({"gyro_z"}, -1.0)},
      {"gyro y and z swapped", gyro, swapped("gyro_y", "gyro_z")},
      {"gyro 5 % high", gyro, scaled(kGyro, 1.05)},
      {"gyro 20 % low", gyro, scaled(kGyro, 0.8)},
      {"gyro y off by 2 deg/s", gyro, scaled({"gyro_y"}, 1.0, 2.0 * kDegree)},
      {"gyro yawed by 5 deg", gyro, turned(kGyro, {0.0, 0.0, 5.0 * kDegree})},
      {"gyro clipped at 20 deg/s", gyro, clipped(kGyro, -20.0 * kDegree, 20.0 * kDegree)},
      {"gyro in steps of 2 deg/s", gyro, quantised(kGyro, 2.0 * kDegree)},
      {"gyro 0.1 s late", gyro, delayed(kGyro, 0.1)},
      {"gyro smoothed over 0.2 s", gyro, smoothed(kGyro, 0.2)},
      {"gyro frozen for 10 %", gyro, frozen(kGyro, 0.1)},
      {"attitude in degrees", attitude, scaled(kAttitude, 1.0 / kDegree)},
      {"roll reversed", attitude, scaled({"roll"}, -1.0)},
      {"pitch reversed", attitude, scaled({"pitch"}, -1.0)},
      {"yaw reversed", attitude, scaled({"yaw"}, -1.0)},
      {"roll and pitch swapped", attitude, swapped("roll", "pitch")},
      {"pitch off by 2 deg", attitude, scaled({"pitch"}, 1.0, 2.0 * kDegree)},
      {"yaw off by 20 deg", attitude, scaled({"yaw"}, 1.0, 20.0 * kDegree)},
      {"attitude 0.2 s late", attitude, delayed(kAttitude, 0.2)},
      {"attitude held at 1 Hz", attitude, held(kAttitude, 1.0)},
      {"attitude frozen for 10 %", attitude, frozen(kAttitude, 0.1)},
      {"vertical velocity reversed", velocity, scaled({"vel_down"}, -1.0)},
      {"velocity in knots", velocity, scaled(kVelocity, 1.0 / kKnot)},
      {"velocity in km/h", velocity, scaled(kVelocity, 3.6)},
      {"velocity 5 % low", velocity, scaled(kVelocity, 0.95)},
      {"north and east swapped", velocity, swapped("vel_north", "vel_east")},
      {"velocity 0.5 s late", velocity, delayed(kVelocity, 0.5)},
      {"velocity held at 1 Hz", velocity, held(kVelocity, 1.0)},
      {"velocity frozen for 10 %", velocity, frozen(kVelocity, 0.1)},
      {"velocity with spikes of 30 m/s", velocity, with_spikes(kVelocity, 30.0, 200)},
      {"dynamic pressure in hPa", air, scaled(kPitot, 0.01)},
      {"dynamic pressure in psf", air, scaled(kPitot, 1.0 / 47.88)},
      {"dynamic pressure 1.5 times", air, scaled(kPitot, 1.5)},
      {"dynamic pressure 1.2 times", air, scaled(kPitot, 1.2)},
      {"dynamic pressure 30 Pa high", air, scaled(kPitot, 1.0, 30.0)},
      {"dynamic pressure 0.5 s late", air, delayed(kPitot, 0.5)},
      {"dynamic pressure frozen for half the flight", air, frozen(kPitot, 0.5)},
      {"dynamic pressure held at 1 Hz", air, held(kPitot, 1.0)},
      {"alpha reversed", alpha, scaled({"alpha"}, -1.0)},
      {"alpha in degrees", alpha, scaled({"alpha"}, 1.0 / kDegree)},
      {"alpha 1.3 times", alpha, scaled({"alpha"}, 1.3)},
      {"alpha off by 3 deg", alpha, scaled({"alpha"}, 1.0, 3.0 * kDegree)},
      {"alpha 0.2 s late", alpha, delayed({"alpha"}, 0.2)},
      {"alpha frozen for half the flight", alpha, frozen({"alpha"}, 0.5)},
      {"alpha and beta swapped", both, swapped("alpha", "beta")},
      {"beta reversed", beta, scaled({"beta"}, -1.0)},
      {"beta 1.3 times", beta, scaled({"beta"}, 1.3)},
      {"beta off by 3 deg", beta, scaled({"beta"}, 1.0, 3.0 * kDegree)},
      {"beta 0.2 s late", beta, delayed({"beta"}, 0.2)},
      {"elevator reversed", controls, scaled({"elevator"}, -1.0)},
      {"elevator 1.3 times", controls, scaled({"elevator"}, 1.3)},
      {"elevator off by 3 deg", controls, scaled({"elevator"}, 1.0, 3.0 * kDegree)},
      {"aileron and rudder swapped", controls, swapped("aileron", "rudder")},
      {"deflections in degrees", controls, scaled(kSurfaces, 1.0 / kDegree)},
      {"elevator 0.2 s late", controls, delayed({"elevator"}, 0.2)},
      {"deflections 0.2 s late", controls, delayed(kSurfaces, 0.2)},
      {"elevator frozen for half the flight", controls, frozen({"elevator"}, 0.5)},
      {"engine in rpm", NamedBy({"engine_speed", "throttle", "CD"}), scaled({"engine_speed"}, 30.0 / kPi)},
      {"engine speed 1.1 times", NamedBy({"engine_speed", "CD"}), scaled({"engine_speed"}, 1.1)},
      {"clock 3 % slow", clock, with_clock([](double t) { return 1.03 * t; })},
      {"clock in ms taken for s", clock, with_clock([](double t) { return 1000.0 * t; })},
      {"clock that jumps by 5 s", clock, with_clock([](double t) { return t > 100.0 ? t + 5.0 : t; })},
      {"gaps of 2 s every 20 s", clock, with_gaps(20.0, 2.0)},
      {"mass 1.3 times", body, of_subject([](Subject& s) { s.mass *= 1.3; })},
      {"inertia in twice its value", body, of_subject([](Subject& s) {
         s.inertia = Inertia{2.0 * s.inertia->Jx, 2.0 * s.inertia->Jy, 2.0 * s.inertia->Jz, 2.0 * s.inertia->Jxz};
       })},
      {"Jx and Jz swapped", body, of_subject([](Subject& s) { std::swap(s.inertia->Jx, s.inertia->Jz); })},
      {"wing area in square feet", body, of_subject([](Subject& s) { s.wing_area *= 10.764; })},
      {"chord taken for span", body, of_subject([](Subject& s) { s.span = s.chord; })},
  };
}

}  // namespace

const std::vector<Fault>& faults() {
  static const std::vector<Fault> all = all_faults();
  return all;
}

const Fault& fault(const std::string& name) {
  const auto found = std::ranges::find(faults(), name, &Fault::name);
  if (found == faults().end()) throw std::invalid_argument("no fault is called " + name);
  return *found;
}

}  // namespace veridyn::aircraft::testing
