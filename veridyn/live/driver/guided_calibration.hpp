#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/live/driver/wheel_calibration.hpp"

namespace veridyn::live {

/// What the driver is asked for, in this order.
enum class CalibrationStep {
  kRest,
  kLeft,
  kRight,
  kCentre,
  kThrottleDown,
  kThrottleUp,
  kBrakeDown,
  kBrakeUp,
  kDone,
};

/// Finds out which axis is what by asking the driver to move one thing after the other. Without a device or a terminal:
/// events in; a prompt and, after each confirmation, the next step or a reason to repeat this one out.
class GuidedCalibration {
 public:
  /// @param axes of the device, with their ranges @param lock of the wheel from the centre to either side [rad], which
  /// no device says
  /// @throws InputError where there are fewer than two axes, one has no range, or the lock is not above zero
  GuidedCalibration(std::span<const WheelAxis> axes, double lock);

  [[nodiscard]] CalibrationStep step() const { return step_; }
  /// What the driver is to do now, one sentence.
  [[nodiscard]] std::string_view prompt() const;
  void take(const WheelEvent& event) { positions_.take(event); }
  /// The driver has done it. @return why it cannot be; nothing: on to the next step
  std::optional<std::string> confirm();
  /// One step back.
  void back();
  /// @throws InputError where it is not done
  [[nodiscard]] WheelCalibration calibration() const;

 private:
  using Refusal = std::optional<std::string>;
  /// An axis and how far it is from rest, as a share of its range.
  struct Moved {
    const WheelAxis* axis = nullptr;
    double share = 0.0;
  };
  [[nodiscard]] std::int32_t at(std::uint16_t code) const { return positions_.value(code); }
  [[nodiscard]] const WheelAxis& axis(std::uint16_t code) const;
  [[nodiscard]] double share_from_rest(const WheelAxis& axis) const;
  /// The axis that moved most, or why it is not clear.
  [[nodiscard]] Refusal find_moved(std::string_view what, Moved& moved) const;
  Refusal take_left();
  Refusal take_right();
  Refusal take_centre();
  Refusal take_pedal_down(std::string_view name, PedalCalibration& pedal);
  Refusal take_pedal_up(std::string_view name, PedalCalibration& pedal) const;

  std::vector<WheelAxis> axes_;  ///< `value`: at rest
  WheelAxes positions_;
  WheelCalibration result_;
  CalibrationStep step_ = CalibrationStep::kRest;
};

}  // namespace veridyn::live
