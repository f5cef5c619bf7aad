#pragma once

#include <algorithm>
#include <cmath>
#include <deque>

#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// The state of an actuator: command in, deflection out. The lag is discretised exactly for a command held over a step;
/// the delay is rounded to whole steps.
class Servo {
 public:
  Servo(const Actuator& actuator, double start, double step)
      : actuator_(actuator),
        step_(step),
        follow_(actuator.time_constant > 0.0 ? -std::expm1(-step / actuator.time_constant) : 1.0),
        position_(std::clamp(start, actuator.lower, actuator.upper)),
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
    position_ += std::clamp(follow_ * (command - position_), -reach, reach);
  }

 private:
  Actuator actuator_;
  double step_;
  double follow_;
  double position_;
  std::deque<double> waiting_;
};

}  // namespace veridyn::aircraft
