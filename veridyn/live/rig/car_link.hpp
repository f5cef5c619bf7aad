#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "veridyn/live/driver/driver_command.hpp"
#include "veridyn/live/rig/car_study.hpp"
#include "veridyn/live/telemetry/packet_intake.hpp"
#include "veridyn/live/teleoperation/operator_end.hpp"

namespace veridyn::live {

/// What the operator sees of a car.
struct CarStatus {
  LinkQuality link;
  CarCommand command;             ///< the last one
  std::optional<CarState> state;  ///< nothing before the first report
  double battery = 0.0;           ///< [V], NaN where it is not measured
  std::uint64_t restarts = 0;     ///< of the car
};

/// The operator's side of a scaled car without devices and clocks: bytes of the line and events of wheel and pedals in,
/// commands and the car's motion out. The same in at the same times gives the same out, bit for bit. Nothing is
/// allocated or thrown after construction.
class CarLink {
 public:
  static constexpr std::size_t kCommandBytes = frame_size(kCommandPayload);
  using CommandBytes = std::array<std::uint8_t, kCommandBytes>;

  /// @param run of this operator, another one after each start @throws InputError as `OperatorEnd` and the options
  CarLink(const CarStudy& car, const DriverStudy& driver, std::uint16_t run);

  /// Takes bytes of the line up to the end of the next report, or all of them. @param bytes what is left of them
  /// @return the motion that the report holds, at the sensors' place; nothing where acceleration, rates or wheels say
  /// nothing
  std::optional<Telemetry> take_line(Bytes& bytes, Nanoseconds arrival);
  /// Takes records of wheel events; none at all say that the driver is gone.
  void take_driver(Bytes records);
  /// What is to be sent now. @param halt brake fully on and no drive force, until it is over and the throttle has been
  /// released @return how many of the bytes
  std::size_t command(Nanoseconds now, bool halt, CommandBytes& out);

  /// The car's clock against ours.
  [[nodiscard]] const SenderClock& clock() const { return clock_; }
  [[nodiscard]] LinkQuality quality(Nanoseconds now) const { return end_.quality(now); }
  [[nodiscard]] CarStatus status(Nanoseconds now) const;
  [[nodiscard]] const OperatorEnd& end() const { return end_; }
  /// Reports that held a motion, and those without one.
  [[nodiscard]] const PerPacketStatus<std::uint64_t>& counts() const { return counts_; }
  /// The oldest event of wheel and pedals that no command held before the last one did; asked once.
  [[nodiscard]] std::optional<Nanoseconds> take_pedal();

 private:
  [[nodiscard]] std::optional<Telemetry> motion_of(const ReceivedReport& report);

  DriverCommandOptions options_;
  WheelCalibration calibration_;
  double radius_;
  Eigen::Vector3d place_;
  OperatorEnd end_;
  SenderClock clock_;
  std::optional<std::uint32_t> last_report_;
  std::uint64_t restarts_ = 0;
  bool begun_ = false;
  PerPacketStatus<std::uint64_t> counts_ = {};
  WheelEventDecoder decoder_;
  WheelAxes axes_;
  std::optional<DriverInput> input_;
  std::optional<Nanoseconds> pedal_, sent_pedal_;
  bool held_ = true;  ///< until the throttle has been released
  CarCommand last_;   ///< what the last command asked for
};

}  // namespace veridyn::live
