#include "veridyn/live/driver/guided_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::live {
namespace {

// Less than this share of its range is a hand that trembles or a foot that rests, not an axis that was moved.
constexpr double kMovedShare = 0.1;
// How far from where it was the wheel or a pedal counts as back again, of the way it has moved.
constexpr double kBackShare = 0.1;

}  // namespace

GuidedCalibration::GuidedCalibration(std::span<const WheelAxis> axes, double lock)
    : axes_(axes.begin(), axes.end()), positions_(axes) {
  if (axes.size() < 2) throw InputError("calibration", "a wheel with pedals has two axes or more");
  for (const WheelAxis& each : axes) {
    if (each.lowest >= each.highest || each.code >= kAxisCodes)
      throw InputError("calibration",
                       fmt::format("axis {} has no range: {} to {}", axis_name(each.code), each.lowest, each.highest));
  }
  if (!(lock > 0.0 && lock <= 100.0))
    throw InputError("calibration", fmt::format("the lock of {} rad must be > 0 and <= 100", lock));
  result_.steering.lock = lock;
}

std::string_view GuidedCalibration::prompt() const {
  switch (step_) {
    case CalibrationStep::kRest:
      return "Press each pedal once and release it; let the wheel stand straight, hands off; then confirm.";
    case CalibrationStep::kLeft:
      return "Turn the wheel fully to the left, hold it there and confirm.";
    case CalibrationStep::kRight:
      return "Turn the wheel fully to the right, hold it there and confirm.";
    case CalibrationStep::kCentre:
      return "Let the wheel stand straight again and confirm.";
    case CalibrationStep::kThrottleDown:
      return "Press the throttle fully down, hold it there and confirm.";
    case CalibrationStep::kThrottleUp:
      return "Release the throttle and confirm.";
    case CalibrationStep::kBrakeDown:
      return "Press the brake fully down, hold it there and confirm.";
    case CalibrationStep::kBrakeUp:
      return "Release the brake and confirm.";
    case CalibrationStep::kDone:
      break;
  }
  return "Done.";
}

std::optional<std::string> GuidedCalibration::confirm() {
  Refusal refusal;
  switch (step_) {
    case CalibrationStep::kRest:
      for (WheelAxis& each : axes_) each.value = at(each.code);
      break;
    case CalibrationStep::kLeft:
      refusal = take_left();
      break;
    case CalibrationStep::kRight:
      refusal = take_right();
      break;
    case CalibrationStep::kCentre:
      refusal = take_centre();
      break;
    case CalibrationStep::kThrottleDown:
      refusal = take_pedal_down("throttle", result_.throttle);
      break;
    case CalibrationStep::kThrottleUp:
      refusal = take_pedal_up("throttle", result_.throttle);
      break;
    case CalibrationStep::kBrakeDown:
      refusal = take_pedal_down("brake", result_.brake);
      break;
    case CalibrationStep::kBrakeUp:
      refusal = take_pedal_up("brake", result_.brake);
      if (!refusal) {
        if (const auto problem = result_.problem())
          refusal = fmt::format("{}.{}: {}", problem->table, problem->key, problem->text);
      }
      break;
    case CalibrationStep::kDone:
      return std::nullopt;
  }
  if (!refusal) step_ = static_cast<CalibrationStep>(static_cast<int>(step_) + 1);
  return refusal;
}

void GuidedCalibration::back() {
  if (step_ != CalibrationStep::kRest) step_ = static_cast<CalibrationStep>(static_cast<int>(step_) - 1);
}

WheelCalibration GuidedCalibration::calibration() const {
  if (step_ != CalibrationStep::kDone) throw InputError("calibration", fmt::format("not complete; next: {}", prompt()));
  return result_;
}

const WheelAxis& GuidedCalibration::axis(std::uint16_t code) const {
  return *std::find_if(axes_.begin(), axes_.end(), [&](const WheelAxis& each) { return each.code == code; });
}

double GuidedCalibration::share_from_rest(const WheelAxis& axis) const {
  return (static_cast<double>(at(axis.code)) - axis.value) / (static_cast<double>(axis.highest) - axis.lowest);
}

GuidedCalibration::Refusal GuidedCalibration::find_moved(std::string_view what, Moved& moved) const {
  Moved second;
  for (const WheelAxis& each : axes_) {
    const double share = share_from_rest(each);
    if (std::abs(share) > std::abs(moved.share)) {
      second = moved;
      moved = {&each, share};
    } else if (std::abs(share) > std::abs(second.share)) {
      second = {&each, share};
    }
  }
  if (moved.axis == nullptr || std::abs(moved.share) < kMovedShare)
    return fmt::format("{}: no axis moved by a tenth of its range", what);
  if (std::abs(second.share) >= kMovedShare && std::abs(second.share) > 0.5 * std::abs(moved.share))
    return fmt::format("{}: two axes moved, {} and {}; move one thing only", what, axis_name(moved.axis->code),
                       axis_name(second.axis->code));
  return std::nullopt;
}

GuidedCalibration::Refusal GuidedCalibration::take_left() {
  Moved moved;
  if (Refusal refusal = find_moved("wheel", moved)) return refusal;
  result_.steering.axis = moved.axis->code;
  result_.steering.left = at(moved.axis->code);
  return std::nullopt;
}

GuidedCalibration::Refusal GuidedCalibration::take_right() {
  const WheelAxis& steering = axis(result_.steering.axis);
  const double right = share_from_rest(steering);
  const double left = (static_cast<double>(result_.steering.left) - steering.value) /
                      (static_cast<double>(steering.highest) - steering.lowest);
  if (std::abs(right) < kMovedShare)
    return fmt::format("wheel: axis {} is not a tenth of its range away from the middle", axis_name(steering.code));
  if ((right > 0.0) == (left > 0.0))
    return fmt::format("wheel: it turned the wrong way: axis {} is at {}, on the left of the middle like {}",
                       axis_name(steering.code), at(steering.code), result_.steering.left);
  const double ratio = std::abs(right / left);
  if (ratio > 2.0 || ratio < 0.5)
    return fmt::format(
        "wheel: one lock is more than twice as far from the middle ({}) as the other: {} and {}; turn it "
        "fully, or begin again with the wheel straight",
        steering.value, result_.steering.left, at(steering.code));
  result_.steering.right = at(steering.code);
  return std::nullopt;
}

GuidedCalibration::Refusal GuidedCalibration::take_centre() {
  const WheelAxis& steering = axis(result_.steering.axis);
  const double way = std::abs(static_cast<double>(result_.steering.right) - result_.steering.left) / 2.0;
  const double off = static_cast<double>(at(steering.code)) - steering.value;
  if (std::abs(off) > kBackShare * way)
    return fmt::format("wheel: it does not stand straight: axis {} is at {}, and was at {} at first",
                       axis_name(steering.code), at(steering.code), steering.value);
  // Friction leaves the wheel a little off to the side that it comes from.
  result_.steering.centre = static_cast<std::int32_t>((std::int64_t{at(steering.code)} + steering.value) / 2);
  return std::nullopt;
}

GuidedCalibration::Refusal GuidedCalibration::take_pedal_down(std::string_view name, PedalCalibration& pedal) {
  Moved moved;
  if (Refusal refusal = find_moved(name, moved)) return refusal;
  if (moved.axis->code == result_.steering.axis)
    return fmt::format("{}: the wheel moved (axis {}), not a pedal", name, axis_name(moved.axis->code));
  const std::int32_t pressed = at(moved.axis->code);
  const PedalCalibration& throttle = result_.throttle;
  if (&pedal != &throttle && moved.axis->code == throttle.axis &&
      (pressed > moved.axis->value) == (throttle.pressed > throttle.released))
    return fmt::format("{}: axis {} moves as for the throttle, to {}: their ranges overlap; press the other pedal",
                       name, axis_name(throttle.axis), pressed);
  pedal.axis = moved.axis->code;
  pedal.pressed = pressed;
  return std::nullopt;
}

GuidedCalibration::Refusal GuidedCalibration::take_pedal_up(std::string_view name, PedalCalibration& pedal) const {
  const WheelAxis& own = axis(pedal.axis);
  const double way = std::abs(static_cast<double>(pedal.pressed) - own.value);
  if (std::abs(static_cast<double>(at(own.code)) - own.value) > kBackShare * way)
    return fmt::format("{}: it is not released: axis {} is at {}, and was at {} at first", name, axis_name(own.code),
                       at(own.code), own.value);
  // The rest where it began and this one differ by friction: the one nearer to pressed, so that released is always
  // zero.
  pedal.released = pedal.pressed > own.value ? std::max(at(own.code), own.value) : std::min(at(own.code), own.value);
  return std::nullopt;
}

}  // namespace veridyn::live
