#pragma once

#include <algorithm>
#include <cmath>
#include <deque>

#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// The state of an actuator: command in, deflection out. The lag is discretised exactly for a command held over a step;
/// the delay is rounded to whole steps. The surface stays where it is until the servo has taken up the play.
class Servo {
 public:
  Servo(const Actuator& actuator, double start, double step)
      : actuator_(actuator),
        step_(step),
        follow_(actuator.time_constant > 0.0 ? -std::expm1(-step / actuator.time_constant) : 1.0),
        servo_(std::clamp(start, actuator.lower, actuator.upper)),
        position_(servo_),
        waiting_(static_cast<std::size_t>(std::lround(actuator.delay / step)), start) {}

  [[nodiscard]] double position() const { return position_; }

  void advance(double command) {
    if (!waiting_.empty()) {
      waiting_.push_back(command);
      command = waiting_.front();
      waiting_.pop_front();
    }
    command = std::clamp(command, actuator_.lower, actuator_.upper);
    const double reach = actuator_.rate_limit * step_;
    servo_ += std::clamp(follow_ * (command - servo_), -reach, reach);
    const double play = 0.5 * actuator_.free_play;
    position_ = std::clamp(position_, servo_ - play, servo_ + play);
  }

 private:
  Actuator actuator_;
  double step_;
  double follow_;
  double servo_;     ///< before the play
  double position_;  ///< of the surface
  std::deque<double> waiting_;
};

}  // namespace veridyn::aircraft
