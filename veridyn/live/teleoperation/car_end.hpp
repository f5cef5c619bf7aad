#pragma once

#include <cstdint>
#include <optional>

#include "veridyn/core/enum_array.hpp"
#include "veridyn/live/serial/frame.hpp"
#include "veridyn/live/teleoperation/car_report.hpp"
#include "veridyn/live/teleoperation/sent_times.hpp"
#include "veridyn/live/teleoperation/sequence_counter.hpp"

namespace veridyn::live {

/// What became of a command that passed the CRC. Only `kExecuted` keeps the link alive.
enum class CommandVerdict {
  kExecuted,
  kDuplicate,   ///< seen before, or too old to know
  kLate,        ///< out of order: a newer one came before it
  kUnproven,    ///< echoes no report of this run of the car, or none of the last `blind_after`: its age is not known
  kStale,       ///< its age may be above `stale_after`
  kOtherRun,    ///< of another run of the operator while the link to the present one is alive
  kOutOfRange,  ///< a value beyond the range
  kNoCommand,   ///< of another kind or size
};
inline constexpr std::size_t kCommandVerdicts = 8;

struct CarEndOptions {
  CommandRange range = {};
  /// Without an executed command for so long the link is lost and the car brakes. 20 commands at 100 Hz.
  Nanoseconds lost_after = 200 * kMillisecond;
  /// A command is executed only where it is proven to be younger: by the round trip from the report that it echoes.
  Nanoseconds stale_after = 200 * kMillisecond;
  /// And only where the operator has received a report within this time: nobody drives blind.
  Nanoseconds blind_after = 1000 * kMillisecond;
  /// After a lost link: neutral commands for so long before the car drives again, so that one lucky frame is not
  /// enough.
  Nanoseconds neutral_for = 100 * kMillisecond;
  double neutral_force = 0.02;  ///< largest drive force that counts as neutral, of the range
  double neutral_brake = 0.05;  ///< largest brake that counts as released
  double brake_rate = 2.0;      ///< how fast the brake comes when the link is lost [1/s]; 2: fully on in 0.5 s
  double brake_moving = 0.6;    ///< how far, while the car moves
  double brake_holding = 1.0;   ///< and when it stands
  /// The car stands when every wheel has been slower than `standing_speed` [rad/s] for `standing_for`. With a
  /// wheel speed that is NaN it is never known to stand, and `brake_moving` stays.
  double standing_speed = 0.5;
  Nanoseconds standing_for = 300 * kMillisecond;

  /// @throws InputError naming the option: times and rates above zero, shares from 0 to 1
  void validate() const;
};

/// What the car's actuators are to do now.
struct CarActuation {
  CarCommand command;
  CarState state = CarState::kHolding;
};

/// The car's end of the line, without a device: bytes and sensors in, actuation and reports out, each with its time.
/// Deterministic; nothing allocates or throws after construction.
///
/// The car holds its brakes until it hears an operator whose pedals are released. It executes a command only where the
/// command is proven fresh, in order and within range. Without one for `lost_after` it takes off the drive force at
/// once, keeps the steering, brings the brake up smoothly, and holds when it stands. It drives again after
/// `neutral_for` of neutral commands; until then a driver who brakes harder than the car is obeyed, and so is the
/// steering.
class CarEnd {
 public:
  /// @param run another number after each start of the car
  /// @throws InputError as `CarEndOptions::validate`
  CarEnd(const CarEndOptions& options, std::uint16_t run);

  /// Takes bytes of the line. @param now of the car's clock, not before that of any earlier call
  void receive(Bytes bytes, Nanoseconds now);
  /// To be called at the rate of the actuators, 100 Hz or more.
  CarActuation step(const CarSensors& sensors, Nanoseconds now);
  /// The next report, of the sensors given.
  /// @return bytes written; 0 where `out` is shorter than `frame_size(kReportPayload)`
  std::size_t report(const CarSensors& sensors, Nanoseconds now, std::span<std::uint8_t> out);

  [[nodiscard]] CarState state() const { return state_; }
  /// Commands by what became of them, since the start.
  [[nodiscard]] const EnumArray<CommandVerdict, std::uint64_t, kCommandVerdicts>& verdicts() const { return verdicts_; }
  [[nodiscard]] const FrameCounts& frames() const { return decoder_.counts(); }
  /// Commands of the present run of the operator.
  [[nodiscard]] const SequenceCounter& commands() const { return commands_; }
  /// How often the link was lost.
  [[nodiscard]] std::uint64_t links_lost() const { return links_lost_; }
  /// Sequence number of the last executed command.
  [[nodiscard]] std::optional<std::uint32_t> last_executed() const { return last_executed_; }

 private:
  [[nodiscard]] CommandVerdict judge(const SerialFrame& frame, Nanoseconds now);
  /// An upper bound of the age of a command; nothing where there is none.
  [[nodiscard]] std::optional<Nanoseconds> age_bound(const std::optional<Echo>& echo, Nanoseconds now) const;
  void execute(const CarCommand& command, Nanoseconds now);
  [[nodiscard]] bool link_alive(Nanoseconds now) const;
  void lose_link();
  void watch_standstill(const CarSensors& sensors, Nanoseconds now);

  CarEndOptions options_;
  std::uint16_t run_;
  FrameDecoder decoder_;
  EnumArray<CommandVerdict, std::uint64_t, kCommandVerdicts> verdicts_ = {};

  std::optional<std::uint16_t> operator_run_;
  SequenceCounter commands_;
  Nanoseconds newest_at_ = 0;  ///< when the newest command came, executed or not
  std::optional<std::uint32_t> last_executed_;
  std::optional<Nanoseconds> executed_at_;
  std::optional<Nanoseconds> neutral_since_;
  CarCommand wanted_;
  std::uint64_t links_lost_ = 0;

  CarState state_ = CarState::kHolding;
  double own_brake_;  ///< by itself, while not driving
  std::optional<Nanoseconds> last_step_;
  std::optional<Nanoseconds> standing_since_;

  SentTimes reports_;
  std::uint32_t next_report_ = 0;
};

}  // namespace veridyn::live
