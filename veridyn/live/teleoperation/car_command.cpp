#include "veridyn/live/teleoperation/car_command.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/live/teleoperation/quantised.hpp"

namespace veridyn::live {
namespace {

constexpr double kSteeringStep = 1e-4;  // [rad]
constexpr double kForceStep = 0.05;     // [N]
constexpr double kBrakeStep = 1e-4;
constexpr std::uint16_t kNoEcho = 0xFFFF;

}  // namespace

void CommandRange::validate() const {
  if (!(steering > 0.0 && steering <= 3.2))
    throw InputError("range.steering", fmt::format("is {} rad; must be > 0 and <= 3.2", steering));
  if (!(drive_force > 0.0 && drive_force <= 1600.0))
    throw InputError("range.drive_force", fmt::format("is {} N; must be > 0 and <= 1600", drive_force));
}

std::string_view what_is_wrong(const CarCommand& command, const CommandRange& range) {
  // Half a step, and what the last digit of a multiple of it costs.
  constexpr double kHalf = 0.500001;
  if (!(std::abs(command.steering) <= range.steering + kHalf * kSteeringStep)) return "steering";
  if (!(std::abs(command.drive_force) <= range.drive_force + kHalf * kForceStep)) return "drive_force";
  if (!(command.brake >= 0.0 && command.brake <= 1.0)) return "brake";
  return {};
}

void encode_echo(const std::optional<Echo>& echo, LittleEndianWriter& out) {
  const bool known = echo && echo->age >= 0 && echo->age / kEchoAgeStep < kNoEcho;
  out.put(known ? echo->run : std::uint16_t{0});
  out.put(known ? echo->sequence : std::uint16_t{0});
  out.put(known ? static_cast<std::uint16_t>(echo->age / kEchoAgeStep) : kNoEcho);
}

std::optional<Echo> decode_echo(LittleEndianReader& in) {
  Echo echo;
  echo.run = in.get<std::uint16_t>();
  echo.sequence = in.get<std::uint16_t>();
  const auto age = in.get<std::uint16_t>();
  if (age == kNoEcho) return std::nullopt;
  echo.age = age * kEchoAgeStep;
  return echo;
}

void encode_command(const CommandPayload& payload, std::span<std::uint8_t> out) {
  LittleEndianWriter write(out);
  write.put(quantised<std::int16_t>(payload.command.steering, kSteeringStep));
  write.put(quantised<std::int16_t>(payload.command.drive_force, kForceStep));
  write.put(quantised<std::uint16_t>(payload.command.brake, kBrakeStep));
  encode_echo(payload.echo, write);
}

std::optional<CommandPayload> decode_command(Bytes payload) {
  if (payload.size() != kCommandPayload) return std::nullopt;
  LittleEndianReader read(payload);
  CommandPayload result;
  result.command.steering = read.get<std::int16_t>() * kSteeringStep;
  result.command.drive_force = read.get<std::int16_t>() * kForceStep;
  result.command.brake = read.get<std::uint16_t>() * kBrakeStep;
  result.echo = decode_echo(read);
  return result;
}

}  // namespace veridyn::live
