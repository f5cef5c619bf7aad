#include "veridyn/vehicle/simulation/trajectory_table.hpp"

#include <array>
#include <string>

namespace veridyn::vehicle {
namespace {

using T = VehicleTrajectory;

constexpr std::array kQuantities{
    TrajectoryQuantity{"steer", "rad", "steer angle of the front wheels", &T::steer},
    TrajectoryQuantity{"speed", "m/s", "forward speed", &T::u},
    TrajectoryQuantity{"yaw_rate", "rad/s", "yaw rate", &T::r},
    TrajectoryQuantity{"lateral_acceleration", "m/s^2", "horizontal, of the centre of gravity",
                       &T::lateral_acceleration},
    TrajectoryQuantity{"longitudinal_acceleration", "m/s^2", "horizontal, of the centre of gravity",
                       &T::longitudinal_acceleration},
    TrajectoryQuantity{"lateral_velocity", "m/s", "of the centre of gravity", &T::v},
    TrajectoryQuantity{"yaw_acceleration", "rad/s^2", "yaw acceleration", &T::yaw_acceleration},
    TrajectoryQuantity{"x", "m", "earth axes", &T::x},
    TrajectoryQuantity{"y", "m", "earth axes", &T::y},
    TrajectoryQuantity{"yaw", "rad", "heading", &T::yaw},
    TrajectoryQuantity{"roll", "rad", "left side up", &T::roll},
    TrajectoryQuantity{"pitch", "rad", "nose down", &T::pitch},
    TrajectoryQuantity{"heave", "m", "of the sprung mass above its rest", &T::heave},
    TrajectoryQuantity{"roll_rate", "rad/s", "roll rate", &T::roll_rate},
    TrajectoryQuantity{"pitch_rate", "rad/s", "pitch rate", &T::pitch_rate},
    TrajectoryQuantity{"heave_rate", "m/s", "of the sprung mass", &T::heave_rate},
};

constexpr std::array kWheelQuantities{
    WheelQuantity{"slip_angle", "rad", "slip angle", &T::slip_angle},
    WheelQuantity{"slip_ratio", "1", "slip ratio", &T::slip_ratio},
    WheelQuantity{"lateral_force", "N", "wheel axes", &T::Fy},
    WheelQuantity{"longitudinal_force", "N", "wheel axes", &T::Fx},
    WheelQuantity{"normal_force", "N", "static load included", &T::Fz},
    WheelQuantity{"wheel_height", "m", "of the unsprung mass above its rest", &T::wheel_height},
    WheelQuantity{"suspension_travel", "m", "bump positive", &T::suspension_travel},
    WheelQuantity{"road_height", "m", "under the wheel", &T::road},
    WheelQuantity{"wheel_speed", "rad/s", "spin", &T::wheel_speed},
};

}  // namespace

std::span<const TrajectoryQuantity> trajectory_quantities() { return kQuantities; }
std::span<const WheelQuantity> wheel_quantities() { return kWheelQuantities; }

Recording to_recording(const VehicleTrajectory& trajectory) {
  Recording recording;
  recording.frame = Frame::kFlu;
  const TimeBase time = make_time_base(trajectory.time);
  for (const TrajectoryQuantity& q : kQuantities) {
    const std::vector<double>& values = trajectory.*q.values;
    if (!values.empty()) recording.add(make_channel(q.name, q.unit, time, values));
  }
  for (const WheelQuantity& q : kWheelQuantities) {
    for (std::size_t i = 0; i < kWheels; ++i) {
      const std::vector<double>& values = (trajectory.*q.values)[i];
      if (values.empty()) continue;
      recording.add(make_channel(std::string(q.name) + "_" + std::string(kWheelNames[i]), q.unit, time, values));
    }
  }
  return recording;
}

}  // namespace veridyn::vehicle
