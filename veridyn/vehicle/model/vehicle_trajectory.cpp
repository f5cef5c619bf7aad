#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

#include <fmt/format.h>

namespace veridyn::vehicle {

std::string_view to_string(DriveEnd end) {
  switch (end) {
    case DriveEnd::kCompleted:
      return "driven to the end";
    case DriveEnd::kStopped:
      return "the vehicle came to a stop";
    case DriveEnd::kSpun:
      return "the vehicle spun: it goes backwards";
    case DriveEnd::kRolledOver:
      return "the vehicle rolls or pitches beyond 45 deg: the model ends there";
    case DriveEnd::kInterrupted:
      return "interrupted";
    case DriveEnd::kDiverged:
      return "the simulation diverged: the step is too long for these stiffnesses";
  }
  return "";
}

std::string VehicleTrajectory::message() const {
  std::string text = end == DriveEnd::kCompleted ? std::string(to_string(end))
                                                 : fmt::format("{} (at {:.3f} s)", to_string(end), end_time);
  for (std::size_t i = 0; i < lift_offs.size(); ++i) {
    if (i == 8) return text + fmt::format("; {} more", lift_offs.size() - i);
    const LiftOff& l = lift_offs[i];
    text += fmt::format("; wheel {} off the ground from {:.3f} to {:.3f} s", kWheelNames[l.wheel], l.from, l.to);
  }
  return text;
}

}  // namespace veridyn::vehicle
