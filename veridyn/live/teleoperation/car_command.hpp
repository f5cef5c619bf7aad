#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "veridyn/live/serial/little_endian.hpp"
#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// Kinds of frames between operator and car.
inline constexpr std::uint8_t kCommandKind = 1, kReportKind = 2;

/// Limits of what the car may be ordered. Both ends hold every command against it: the operator before it is sent, the
/// car before it is executed.
struct CommandRange {
  double steering = 0.6;       ///< largest road-wheel angle to either side [rad]; at most 3.2
  double drive_force = 100.0;  ///< largest forward or backward [N]; at most 1600

  /// @throws InputError where one is not above zero or beyond what a frame can hold
  void validate() const;
};

/// What the driver asks of the car. Frame flu: steering to the left and force forward are positive.
struct CarCommand {
  double steering = 0.0;     ///< road-wheel angle [rad]; sent in steps of 1e-4
  double drive_force = 0.0;  ///< at the wheels, all together [N]; negative is backward; sent in steps of 0.05
  double brake = 0.0;        ///< 0 released to 1 full; sent in steps of 1e-4

  bool operator==(const CarCommand&) const = default;
};

/// The first quantity that is not finite or out of range, "steering", "drive_force" or "brake"; empty where all are
/// well. A value on the limit is within, one that half a step of sending takes beyond it too.
[[nodiscard]] std::string_view what_is_wrong(const CarCommand& command, const CommandRange& range);

/// What ages of echoes are rounded down to.
inline constexpr Nanoseconds kEchoAgeStep = 100'000;

/// Which of the other end's frames was received last and how long ago, so that the other end can tell how old this is.
struct Echo {
  std::uint16_t run = 0;
  std::uint16_t sequence = 0;  ///< its lowest 16 bits
  Nanoseconds age = 0;         ///< since it was received; sent in steps of 0.1 ms, rounded down, at most 6.5534 s
};

/// Payload of a command, 12 bytes: steering i16 | drive force i16 | brake u16 | echo: run u16, sequence u16, age u16.
inline constexpr std::size_t kCommandPayload = 12;
struct CommandPayload {
  CarCommand command;
  std::optional<Echo> echo;  ///< none: no report was received within 6.5534 s (age 0xffff)
};

/// @param payload its command within what a frame can hold, see `what_is_wrong`
/// @param out of `kCommandPayload` bytes
void encode_command(const CommandPayload& payload, std::span<std::uint8_t> out);
/// Nothing where the size is not that of a command. Values are held against no range here.
[[nodiscard]] std::optional<CommandPayload> decode_command(Bytes payload);

/// Echoes are the same in both directions: 6 bytes.
void encode_echo(const std::optional<Echo>& echo, LittleEndianWriter& out);
[[nodiscard]] std::optional<Echo> decode_echo(LittleEndianReader& in);

}  // namespace veridyn::live
