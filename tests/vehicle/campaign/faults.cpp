#include <algorithm>
#include <stdexcept>
#include <utility>

#include "tests/support/channel_faults.hpp"
#include "tests/vehicle/campaign/campaign.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle::testing {
namespace {

using DriveChange = std::function<void(VehicleStudy&)>;
using test::ChannelNames;

DriveChange in(test::RecordingFault fault) {
  return [fault = std::move(fault)](VehicleStudy& study) { fault(study.log.mapped.recording); };
}
DriveChange scaled(ChannelNames names, double factor, double offset = 0.0) {
  return in(test::scaled(std::move(names), factor, offset));
}
DriveChange late(ChannelNames names, double delay_s) { return in(test::delayed(std::move(names), delay_s)); }
DriveChange frozen(ChannelNames names, double share) { return in(test::frozen(std::move(names), share)); }
DriveChange of_vehicle(std::function<void(VehicleParameters<double>&)> change) {
  return [change = std::move(change)](VehicleStudy& study) { change(study.vehicle); };
}

std::vector<DriveFault> faults_of_sensors() {
  const std::vector<std::string> gyro{"yaw_rate"}, lateral{"accel_y"}, longitudinal{"accel_x"}, speed{"speed"},
      steer{"steer"};
  return {
      {"yaw rate in deg/s", gyro, scaled({"yaw_rate"}, 1.0 / kDegree)},
      {"yaw rate reversed", gyro, scaled({"yaw_rate"}, -1.0)},
      {"yaw rate 1.2 times", gyro, scaled({"yaw_rate"}, 1.2)},
      {"yaw rate 0.8 times", gyro, scaled({"yaw_rate"}, 0.8)},
      {"yaw rate 1.05 times", gyro, scaled({"yaw_rate"}, 1.05)},
      {"yaw rate off by 2 deg/s", gyro, scaled({"yaw_rate"}, 1.0, 2.0 * kDegree)},
      {"yaw rate 0.1 s late", gyro, late({"yaw_rate"}, 0.1)},
      {"yaw rate 0.3 s late", gyro, late({"yaw_rate"}, 0.3)},
      {"yaw rate smoothed over 0.2 s", gyro, in(test::smoothed({"yaw_rate"}, 0.2))},
      {"yaw rate held at 5 Hz", gyro, in(test::held({"yaw_rate"}, 0.2))},
      {"yaw rate frozen for 10 %", gyro, frozen({"yaw_rate"}, 0.1)},
      {"yaw rate clipped at 8 deg/s", gyro, in(test::clipped({"yaw_rate"}, -8.0 * kDegree, 8.0 * kDegree))},
      {"yaw rate in steps of 5 deg/s", gyro, in(test::quantised({"yaw_rate"}, 5.0 * kDegree))},
      {"accel_y in g", lateral, scaled({"accel_y"}, 1.0 / kGravity)},
      {"accel_y reversed", lateral, scaled({"accel_y"}, -1.0)},
      {"accel_y 1.2 times", lateral, scaled({"accel_y"}, 1.2)},
      {"accel_y 0.8 times", lateral, scaled({"accel_y"}, 0.8)},
      {"accel_y off by 1 m/s^2", lateral, scaled({"accel_y"}, 1.0, 1.0)},
      {"accel_y 0.1 s late", lateral, late({"accel_y"}, 0.1)},
      {"accel_y held at 5 Hz", lateral, in(test::held({"accel_y"}, 0.2))},
      {"accel_y frozen for 10 %", lateral, frozen({"accel_y"}, 0.1)},
      {"accel_y clipped at 1 m/s^2", lateral, in(test::clipped({"accel_y"}, -1.0, 1.0))},
      {"accel_y with spikes of 10 m/s^2", lateral, in(test::with_spikes({"accel_y"}, 10.0, 200))},
      {"accel_x and accel_y swapped", {"accel_x", "accel_y"}, in(test::swapped("accel_x", "accel_y"))},
      {"accel_x reversed", longitudinal, scaled({"accel_x"}, -1.0)},
      {"accel_x in g", longitudinal, scaled({"accel_x"}, 1.0 / kGravity)},
      {"speed in km/h", speed, scaled({"speed"}, 3.6)},
      {"speed in knots", speed, scaled({"speed"}, 1.9438)},
      {"speed 1.2 times", speed, scaled({"speed"}, 1.2)},
      {"speed 0.8 times", speed, scaled({"speed"}, 0.8)},
      {"speed 0.5 s late", speed, late({"speed"}, 0.5)},
      {"speed frozen for half the drive", speed, frozen({"speed"}, 0.5)},
      {"steering in degrees", steer, scaled({"steer"}, 1.0 / kDegree)},
      {"hand wheel taken for road wheels", steer, scaled({"steer"}, 15.0)},
      {"steering reversed", steer, scaled({"steer"}, -1.0)},
      {"steering ratio 1.2 times", steer, scaled({"steer"}, 1.2)},
      {"steering ratio 0.8 times", steer, scaled({"steer"}, 0.8)},
      {"steering off by 2 deg", steer, scaled({"steer"}, 1.0, 2.0 * kDegree)},
      {"steering 0.15 s late", steer, late({"steer"}, 0.15)},
      {"steering 0.15 s early", steer, late({"steer"}, -0.15)},
      {"steering frozen for 10 %", steer, frozen({"steer"}, 0.1)},
      {"steering and yaw rate swapped", {"steer", "yaw_rate"}, in(test::swapped("steer", "yaw_rate"))},
  };
}

std::vector<DriveFault> faults_of_clock_and_vehicle() {
  const std::vector<std::string> clock{"time", "stamps", "clock"}, mass{"mass"},
      place{"centre of gravity", "wheelbase"}, base{"wheelbase", "steer", "centre of gravity"};
  return {
      {"clock 3 % slow", clock, in(test::with_clock([](double t) { return 1.03 * t; }))},
      {"clock in ms taken for s", clock, in(test::with_clock([](double t) { return 1000.0 * t; }))},
      {"clock that jumps by 5 s", clock, in(test::with_clock([](double t) { return t > 40.0 ? t + 5.0 : t; }))},
      {"gaps of 1 s every 10 s", clock, in(test::with_gaps(10.0, 1.0))},
      {"mass 1.3 times", mass, of_vehicle([](VehicleParameters<double>& p) { p.mass *= 1.3; })},
      {"a and b swapped", place, of_vehicle([](VehicleParameters<double>& p) { std::swap(p.a, p.b); })},
      {"a 10 % of the wheelbase more, b less", place, of_vehicle([](VehicleParameters<double>& p) {
         const double shift = 0.1 * p.wheelbase();
         p.a += shift;
         p.b -= shift;
       })},
      {"wheelbase 1.2 times", base, of_vehicle([](VehicleParameters<double>& p) {
         p.a *= 1.2;
         p.b *= 1.2;
       })},
      {"start of the yaw inertia 2 times", {"I_z"}, of_vehicle([](VehicleParameters<double>& p) { p.I_z *= 2.0; })},
  };
}

}  // namespace

const std::vector<DriveFault>& drive_faults() {
  static const std::vector<DriveFault> all = [] {
    std::vector<DriveFault> list = faults_of_sensors();
    for (DriveFault& fault : faults_of_clock_and_vehicle()) list.push_back(std::move(fault));
    return list;
  }();
  return all;
}

const DriveFault& drive_fault(const std::string& name) {
  const auto found = std::ranges::find(drive_faults(), name, &DriveFault::name);
  if (found == drive_faults().end()) throw std::invalid_argument("no fault is called " + name);
  return *found;
}

}  // namespace veridyn::vehicle::testing
