#include "veridyn/live/teleoperation/car_report.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/live/teleoperation/quantised.hpp"

namespace veridyn::live {
namespace {

constexpr double kAccelerationStep = 0.005;  // [m/s^2]
constexpr double kRateStep = 0.001;          // [rad/s]
constexpr double kAngleStep = 1e-4;          // [rad]
constexpr double kWheelStep = 0.02;          // [rad/s]
constexpr double kBatteryStep = 0.001;       // [V]
// On the line for a number that is none.
constexpr std::int16_t kNoNumber = INT16_MIN;
constexpr std::uint16_t kNoBattery = UINT16_MAX;

bool fits(double value, double step) { return std::abs(value) <= 32767.0 * step; }

bool is_voltage(double value) { return value >= 0.0 && value <= (kNoBattery - 1) * kBatteryStep; }

void put_number(LittleEndianWriter& out, double value, double step) {
  out.put(fits(value, step) ? quantised<std::int16_t>(value, step) : kNoNumber);
}

double get_number(LittleEndianReader& in, double step) {
  const auto steps = in.get<std::int16_t>();
  return steps == kNoNumber ? kNaN : steps * step;
}

}  // namespace

std::string_view what_is_wrong(const CarSensors& sensors) {
  const auto all = [](const auto& values, double step) {
    return std::all_of(values.begin(), values.end(), [&](double value) { return fits(value, step); });
  };
  if (!all(sensors.acceleration, kAccelerationStep)) return "acceleration";
  if (!all(sensors.rate, kRateStep)) return "rate";
  if (!fits(sensors.steering, kAngleStep)) return "steering";
  if (!all(sensors.wheel_speeds, kWheelStep)) return "wheel_speeds";
  if (!is_voltage(sensors.battery)) return "battery";
  return {};
}

void encode_report(const ReportPayload& payload, std::span<std::uint8_t> out) {
  LittleEndianWriter write(out);
  const CarSensors& sensors = payload.sensors;
  write.put(payload.time_us);
  for (const double value : sensors.acceleration) put_number(write, value, kAccelerationStep);
  for (const double value : sensors.rate) put_number(write, value, kRateStep);
  put_number(write, sensors.steering, kAngleStep);
  for (const double value : sensors.wheel_speeds) put_number(write, value, kWheelStep);
  write.put(is_voltage(sensors.battery) ? quantised<std::uint16_t>(sensors.battery, kBatteryStep) : kNoBattery);
  write.put(payload.received);
  write.put(static_cast<std::uint8_t>(payload.state));
  encode_echo(payload.echo, write);
}

std::optional<ReportPayload> decode_report(Bytes payload) {
  if (payload.size() != kReportPayload) return std::nullopt;
  LittleEndianReader read(payload);
  ReportPayload result;
  CarSensors& sensors = result.sensors;
  result.time_us = read.get<std::uint32_t>();
  for (double& value : sensors.acceleration) value = get_number(read, kAccelerationStep);
  for (double& value : sensors.rate) value = get_number(read, kRateStep);
  sensors.steering = get_number(read, kAngleStep);
  for (double& value : sensors.wheel_speeds) value = get_number(read, kWheelStep);
  const auto battery = read.get<std::uint16_t>();
  sensors.battery = battery == kNoBattery ? kNaN : battery * kBatteryStep;
  result.received = read.get<std::uint16_t>();
  const auto state = read.get<std::uint8_t>();
  result.echo = decode_echo(read);
  if (state >= kCarStates) return std::nullopt;
  result.state = static_cast<CarState>(state);
  return result;
}

}  // namespace veridyn::live
