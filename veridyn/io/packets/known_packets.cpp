#include "veridyn/io/packets/known_packets.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <string>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::io {
namespace {

constexpr double kPerMillisecond = 1e-3;

/// Builds a table from the front to the back.
class LayoutBuilder {
 public:
  LayoutBuilder(std::string name, std::string sender, bool seen) {
    layout_.name = std::move(name);
    layout_.sender = std::move(sender);
    layout_.seen = seen;
  }
  LayoutBuilder& add(std::string name, GatherType type, std::string unit = "1", double factor = 1.0,
                     double bias = 0.0) {
    layout_.fields.push_back({std::move(name), layout_.size, type, std::move(unit), factor, bias});
    return skip(size_of(type));
  }
  LayoutBuilder& f32(std::string name, std::string unit = "1", double factor = 1.0, double bias = 0.0) {
    return add(std::move(name), GatherType::kFloat, std::move(unit), factor, bias);
  }
  /// One after the other, of the same unit.
  LayoutBuilder& f32s(std::initializer_list<std::string> names, const std::string& unit = "1", double factor = 1.0) {
    for (const std::string& name : names) f32(name, unit, factor);
    return *this;
  }
  /// NAME_rl and so on.
  LayoutBuilder& wheels(const std::string& name, const std::array<const char*, 4>& order, const std::string& unit = "1",
                        GatherType type = GatherType::kFloat) {
    for (const char* wheel : order) add(fmt::format("{}_{}", name, wheel), type, unit);
    return *this;
  }
  LayoutBuilder& begins_with(std::string bytes) {
    layout_.begins_with = std::move(bytes);
    return skip(layout_.begins_with.size());
  }
  LayoutBuilder& skip(std::size_t bytes) {
    layout_.size += bytes;
    return *this;
  }
  [[nodiscard]] PacketLayout done(std::size_t size) const {
    VERIDYN_ASSERT(layout_.size == size);
    check(layout_);
    return layout_;
  }
  /// Whether accelerations hold gravity.
  LayoutBuilder& gravity(bool in) {
    layout_.gravity_in = in;
    return *this;
  }
  [[nodiscard]] std::size_t size() const { return layout_.size; }

 private:
  PacketLayout layout_;
};

constexpr std::array<const char*, 4> kFrontFirst = {"fl", "fr", "rl", "rr"}, kRearFirst = {"rl", "rr", "fl", "fr"};

/// OutSim's main part. Its heading is anticlockwise from north (y), ours from x; its nose is up where pitch is
/// positive.
void add_outsim_main(LayoutBuilder& b) {
  constexpr double kPerMetre = 1.0 / 65536.0;
  b.gravity(false)
      .f32s({"ang_vel_x", "ang_vel_y", "ang_vel_z"}, "rad/s")
      .f32("yaw", "rad", 1.0, kPi / 2.0)
      .f32("pitch", "rad", -1.0)
      .f32("roll", "rad")
      .f32s({"world_accel_x", "world_accel_y", "world_accel_z"}, "m/s^2")
      .f32s({"world_velocity_x", "world_velocity_y", "world_velocity_z"}, "m/s");
  for (const char* name : {"pos_x", "pos_y", "pos_z"}) b.add(name, GatherType::kInt32, "m", kPerMetre);
}

PacketLayout outsim(bool with_id) {
  LayoutBuilder b(with_id ? "outsim_id" : "outsim", "Live for Speed OutSim", true);
  b.add("time", GatherType::kUint32, "s", kPerMillisecond);
  add_outsim_main(b);
  if (with_id) b.add("id", GatherType::kInt32);
  return b.done(with_id ? 68 : 64);
}

PacketLayout outgauge(bool with_id) {
  LayoutBuilder b(with_id ? "outgauge_id" : "outgauge", "Live for Speed OutGauge", true);
  b.add("time", GatherType::kUint32, "s", kPerMillisecond)
      .skip(4)  // name of the car
      .add("flags", GatherType::kUint16)
      .add("gear", GatherType::kUint8)
      .add("player", GatherType::kUint8)
      .f32("speed", "m/s")
      .f32("engine_speed", "rad/s", 2.0 * kPi / 60.0)
      .f32("turbo", "Pa", 1e5)
      .f32("engine_temperature", "K", 1.0, 273.15)
      .f32("fuel")
      .f32("oil_pressure", "Pa", 1e5)
      .f32("oil_temperature", "K", 1.0, 273.15)
      .add("dash_lights", GatherType::kUint32)
      .add("show_lights", GatherType::kUint32)
      .f32s({"throttle", "brake", "clutch"})
      .skip(32);  // two displays of text
  if (with_id) b.add("id", GatherType::kInt32);
  return b.done(with_id ? 96 : 92);
}

PacketLayout motion_68() {
  LayoutBuilder b("motion_68", "packet of 68 bytes with a time in seconds", false);
  b.gravity(false)
      .f32("time", "s")
      .f32("yaw", "rad", 1.0, kPi / 2.0)
      .f32("pitch", "rad", -1.0)
      .f32("roll", "rad")
      .f32s({"world_accel_x", "world_accel_y", "world_accel_z"}, "m/s^2")
      .f32s({"world_velocity_x", "world_velocity_y", "world_velocity_z"}, "m/s")
      .f32s({"ang_vel_x", "ang_vel_y", "ang_vel_z"}, "rad/s");
  for (const char* name : {"pos_x", "pos_y", "pos_z"}) b.add(name, GatherType::kInt32, "m", 1.0 / 65536.0);
  return b.add("id", GatherType::kInt32).done(68);
}

/// Axes of the game's world are x, up and -y of ours.
PacketLayout codemasters() {
  LayoutBuilder b("codemasters", "Codemasters telemetry", true);
  const auto world = [&](const std::string& name, const std::string& unit) {
    b.f32(name + "_x", unit).f32(name + "_z", unit).f32(name + "_y", unit, -1.0);
  };
  b.f32("time", "s").f32("lap_time", "s").f32("lap_distance", "m").f32("progress");
  world("pos", "m");
  b.f32("speed", "m/s");
  world("world_velocity", "m/s");
  world("right", "1");
  world("forward", "1");
  b.wheels("suspension", kRearFirst, "mm").wheels("suspension_rate", kRearFirst, "mm/s");
  b.wheels("wheel", kRearFirst, "m/s");
  b.f32s({"throttle", "steering", "brake", "clutch", "gear"});
  b.gravity(false);
  b.f32("accel_y", "m/s^2", kGravity).f32("accel_x", "m/s^2", kGravity);  // lateral g is to the left
  return b.skip(30 * 4).done(264);
}

/// Axes of the car are right, up, forward; of the world east, up, north.
LayoutBuilder forza_sled(std::string name, std::string sender) {
  LayoutBuilder b(std::move(name), std::move(sender), false);
  b.add("race_is_on", GatherType::kInt32).add("time", GatherType::kUint32, "s", kPerMillisecond);
  for (const char* speed : {"engine_speed_max", "engine_speed_idle", "engine_speed"})
    b.f32(speed, "rad/s", 2.0 * kPi / 60.0);
  b.gravity(false).f32("accel_y", "m/s^2", -1.0).f32("accel_z", "m/s^2").f32("accel_x", "m/s^2");
  b.f32("velocity_y", "m/s", -1.0).f32("velocity_z", "m/s").f32("velocity_x", "m/s");
  // A left-handed frame: positive about right is nose down, about up to the right, about forward left side down.
  b.f32("gyro_y", "rad/s").f32("gyro_z", "rad/s", -1.0).f32("gyro_x", "rad/s", -1.0);
  b.f32("yaw", "rad", -1.0, kPi / 2.0).f32("pitch", "rad").f32("roll", "rad", -1.0);
  b.wheels("suspension_share", kFrontFirst).wheels("slip_ratio", kFrontFirst).wheels("wheel", kFrontFirst, "rad/s");
  b.wheels("rumble_strip", kFrontFirst, "1", GatherType::kInt32).wheels("puddle", kFrontFirst);
  b.wheels("surface_rumble", kFrontFirst).wheels("slip_angle", kFrontFirst).wheels("combined_slip", kFrontFirst);
  b.wheels("suspension", kFrontFirst, "m");
  for (const char* of_car : {"car", "class", "performance", "drive_train", "cylinders"})
    b.add(of_car, GatherType::kInt32);
  return b;
}

void add_forza_dash(LayoutBuilder& b) {
  b.f32("pos_x", "m").f32("pos_z", "m").f32("pos_y", "m").f32("speed", "m/s").f32("power", "W").f32("torque", "N m");
  b.wheels("tyre_temperature", kFrontFirst);  // degrees Fahrenheit
  b.f32s({"boost", "fuel"}).f32("distance", "m");
  for (const char* lap : {"best_lap_time", "last_lap_time", "lap_time", "race_time"}) b.f32(lap, "s");
  b.add("lap", GatherType::kUint16).add("race_position", GatherType::kUint8);
  for (const char* pedal : {"throttle", "brake", "clutch", "hand_brake"})
    b.add(pedal, GatherType::kUint8, "1", 1.0 / 255.0);
  b.add("gear", GatherType::kUint8).add("steering", GatherType::kInt8, "1", 1.0 / 127.0);
  b.add("driving_line", GatherType::kInt8).add("ai_brake_difference", GatherType::kInt8);
}

PacketLayout forza_dash(std::string name, std::string sender, std::size_t before, std::size_t after, std::size_t size) {
  LayoutBuilder b = forza_sled(std::move(name), std::move(sender));
  b.skip(before);
  add_forza_dash(b);
  return b.skip(after).done(size);
}

PacketLayout beamng() {
  LayoutBuilder b("beamng", "BeamNG MotionSim", false);
  b.begins_with("BNG1");
  b.f32s({"pos_x", "pos_y", "pos_z"}, "m");
  b.f32s({"world_velocity_x", "world_velocity_y", "world_velocity_z"}, "m/s");
  b.f32s({"sender_accel_x", "sender_accel_y", "sender_accel_z"}, "m/s^2").f32s({"up_x", "up_y", "up_z"});
  b.f32s({"sender_roll", "sender_pitch", "sender_yaw"}, "rad");
  b.f32s({"sender_roll_rate", "sender_pitch_rate", "sender_yaw_rate"}, "rad/s");
  b.f32s({"sender_roll_acceleration", "sender_pitch_acceleration", "sender_yaw_acceleration"}, "rad/s^2");
  return b.done(88);
}

PacketLayout assetto_corsa() {
  LayoutBuilder b("assetto_corsa", "Assetto Corsa RTCarInfo", false);
  b.add("identifier", GatherType::kUint16).skip(2).add("size", GatherType::kInt32);
  b.f32("speed_kmh", "m/s", 1.0 / 3.6).f32("speed_mph", "m/s", 0.44704).f32("speed", "m/s");
  for (const char* flag : {"abs", "abs_acts", "traction_control_acts", "traction_control", "in_pit", "limiter"})
    b.add(flag, GatherType::kUint8);
  b.skip(2);
  for (const char* g : {"sender_accel_vertical", "sender_accel_horizontal", "sender_accel_frontal"})
    b.f32(g, "m/s^2", kGravity);
  for (const char* time : {"lap_time", "last_lap_time", "best_lap_time"})
    b.add(time, GatherType::kInt32, "s", kPerMillisecond);
  b.add("lap", GatherType::kInt32).f32s({"throttle", "brake", "clutch"});
  b.f32("engine_speed", "rad/s", 2.0 * kPi / 60.0).f32("steering").add("gear", GatherType::kInt32);
  b.f32("cg_height", "m").wheels("wheel", kFrontFirst, "rad/s");
  for (const char* each : {"slip_angle", "slip_angle_contact", "slip_ratio", "tyre_slip", "nd_slip", "load", "dy", "mz",
                           "dirt", "camber", "radius", "loaded_radius", "suspension"})
    b.wheels(each, kFrontFirst);
  b.f32("lap_share").f32("slope");
  b.f32("pos_x", "m").f32("pos_z", "m").f32("pos_y", "m", -1.0);
  return b.done(328);
}

/// The project's own, see docs/formats.md.
PacketLayout veridyn_motion() {
  LayoutBuilder b("veridyn", "Veridyn motion", true);
  b.begins_with("VMO1").add("sequence", GatherType::kUint32).add("time", GatherType::kDouble, "s").gravity(true);
  b.f32s({"pos_x", "pos_y", "pos_z"}, "m");
  b.f32s({"world_velocity_x", "world_velocity_y", "world_velocity_z"}, "m/s");
  b.f32s({"accel_x", "accel_y", "accel_z"}, "m/s^2").f32s({"gyro_x", "gyro_y", "gyro_z"}, "rad/s");
  return b.f32s({"roll", "pitch", "yaw"}, "rad").done(76);
}

}  // namespace

PacketLayout outsim2(std::uint32_t options) {
  LayoutBuilder b("outsim2", "Live for Speed OutSim2", true);
  const auto asked = [&](unsigned bit) { return (options & bit) != 0; };
  if (asked(1)) b.begins_with("LFST");
  if (asked(2)) b.add("id", GatherType::kInt32);
  if (asked(4)) b.add("time", GatherType::kUint32, "s", kPerMillisecond);
  if (asked(8)) add_outsim_main(b);
  if (asked(16)) b.f32s({"throttle", "brake"}).f32("steering", "rad").f32s({"clutch", "hand_brake"});
  if (asked(32))
    b.add("gear", GatherType::kUint8).skip(3).f32("engine_speed", "rad/s").f32("engine_torque_most", "N m");
  if (asked(64)) b.f32s({"lap_distance", "indexed_distance"}, "m");
  for (std::size_t i = 0; asked(128) && i < kRearFirst.size(); ++i) {
    const std::string wheel = kRearFirst[i];
    b.f32("suspension_" + wheel, "m").f32("steer_" + wheel, "rad");
    b.f32("force_right_" + wheel, "N").f32("force_forward_" + wheel, "N").f32("load_" + wheel, "N");
    b.f32("wheel_" + wheel, "rad/s").f32("lean_" + wheel, "rad");
    for (const char* byte : {"air_temperature_", "slip_share_", "touching_"}) b.add(byte + wheel, GatherType::kUint8);
    b.skip(1).f32("slip_ratio_" + wheel).f32("tan_slip_angle_" + wheel);
  }
  if (asked(256)) b.f32("steering_torque", "N m").skip(4);
  return b.done(b.size());
}

const std::vector<PacketLayout>& known_packets() {
  static const std::vector<PacketLayout> all = {
      outsim(false),
      outsim(true),
      outsim2(0x1ff),
      outgauge(false),
      outgauge(true),
      motion_68(),
      codemasters(),
      forza_sled("forza_sled", "Forza Motorsport Data Out, sled").done(232),
      forza_dash("forza_dash", "Forza Motorsport 7 Data Out, dash", 0, 0, 311),
      forza_dash("forza_horizon", "Forza Horizon Data Out", 12, 1, 324),
      forza_dash("forza_2023", "Forza Motorsport (2023) Data Out, dash", 0, 20, 331),
      beamng(),
      assetto_corsa(),
      veridyn_motion(),
  };
  return all;
}

const PacketLayout& known_packet(std::string_view name) {
  std::vector<std::string> names;
  for (const PacketLayout& layout : known_packets()) {
    if (layout.name == name) return layout;
    names.push_back(layout.name);
  }
  throw InputError(std::string(name), fmt::format("is no known packet ({})", fmt::join(names, ", ")));
}

}  // namespace veridyn::io
