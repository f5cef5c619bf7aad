#include "veridyn/io/mavlink/mavlink_messages.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/io/packets/packet_layout.hpp"

namespace veridyn::io {
namespace {

MavlinkField field(std::string_view name, GatherType type, std::string_view unit = "1", double scale = 1.0) {
  return {.name = name, .type = type, .unit = unit, .scale = scale};
}
MavlinkField array(std::string_view name, GatherType type, std::uint32_t count, std::string_view unit = "1") {
  return {.name = name, .type = type, .unit = unit, .count = count};
}
MavlinkField extension(MavlinkField f) {
  f.extension = true;
  return f;
}
/// All bits set: not known.
MavlinkField optional(MavlinkField f) {
  f.none_is_all_ones = true;
  return f;
}

constexpr double kMilliG = 1e-3 * kGravity;

/// Three fields with the same prefix or suffix.
struct Triple {
  std::string_view x, y, z;
};
void add(std::vector<MavlinkField>& fields, const Triple& names, GatherType type, std::string_view unit,
         double scale = 1.0) {
  for (const std::string_view name : {names.x, names.y, names.z}) fields.push_back(field(name, type, unit, scale));
}

constexpr Triple kAcc{"xacc", "yacc", "zacc"}, kGyro{"xgyro", "ygyro", "zgyro"}, kMag{"xmag", "ymag", "zmag"};
constexpr Triple kVelocityNames{"vx", "vy", "vz"}, kAngleNames{"roll", "pitch", "yaw"};
constexpr Triple kRates{"rollspeed", "pitchspeed", "yawspeed"};

MavlinkField boot_ms() { return field("time_boot_ms", GatherType::kUint32, "ms"); }
MavlinkField stamp_us() { return field("time_usec", GatherType::kUint64, "us"); }

/// Accelerations in thousandths of g, rates in mrad/s, fields in mgauss.
void add_scaled_imu(std::vector<MavlinkField>& fields) {
  add(fields, kAcc, GatherType::kInt16, "m/s^2", kMilliG);
  add(fields, kGyro, GatherType::kInt16, "rad/s", 1e-3);
  add(fields, kMag, GatherType::kInt16, "mG");
}

MavlinkMessage scaled_imu(std::uint32_t id, std::string_view name) {
  MavlinkMessage m{id, name, {boot_ms()}};
  add_scaled_imu(m.fields);
  m.fields.push_back(extension(field("temperature", GatherType::kInt16, "degC", 0.01)));
  return m;
}

MavlinkMessage scaled_pressure(std::uint32_t id, std::string_view name) {
  return {id,
          name,
          {boot_ms(), field("press_abs", GatherType::kFloat, "mbar"), field("press_diff", GatherType::kFloat, "mbar"),
           field("temperature", GatherType::kInt16, "degC", 0.01),
           extension(field("temperature_press_diff", GatherType::kInt16, "degC", 0.01))}};
}

constexpr std::array<std::string_view, 16> kServos{"servo1_raw",  "servo2_raw",  "servo3_raw",  "servo4_raw",
                                                   "servo5_raw",  "servo6_raw",  "servo7_raw",  "servo8_raw",
                                                   "servo9_raw",  "servo10_raw", "servo11_raw", "servo12_raw",
                                                   "servo13_raw", "servo14_raw", "servo15_raw", "servo16_raw"};
constexpr std::array<std::string_view, 18> kChannels{
    "chan1_raw",  "chan2_raw",  "chan3_raw",  "chan4_raw",  "chan5_raw",  "chan6_raw",
    "chan7_raw",  "chan8_raw",  "chan9_raw",  "chan10_raw", "chan11_raw", "chan12_raw",
    "chan13_raw", "chan14_raw", "chan15_raw", "chan16_raw", "chan17_raw", "chan18_raw"};

MavlinkMessage servo_output() {
  MavlinkMessage m{36, "SERVO_OUTPUT_RAW", {field("time_usec", GatherType::kUint32, "us")}};
  for (std::size_t i = 0; i < 8; ++i) m.fields.push_back(field(kServos[i], GatherType::kUint16, "us"));
  m.fields.push_back(field("port", GatherType::kUint8));
  for (std::size_t i = 8; i < 16; ++i) m.fields.push_back(extension(field(kServos[i], GatherType::kUint16, "us")));
  m.instance = "port";
  return m;
}

MavlinkMessage rc_channels() {
  MavlinkMessage m{65, "RC_CHANNELS", {boot_ms(), field("chancount", GatherType::kUint8)}};
  for (const std::string_view name : kChannels) m.fields.push_back(optional(field(name, GatherType::kUint16, "us")));
  m.fields.push_back(optional(field("rssi", GatherType::kUint8)));
  return m;
}

/// Longitude, latitude, heights.
void add_gps(std::vector<MavlinkField>& fields) {
  fields.push_back(field("lat", GatherType::kInt32, "deg", 1e-7));
  fields.push_back(field("lon", GatherType::kInt32, "deg", 1e-7));
  fields.push_back(field("alt", GatherType::kInt32, "m", 1e-3));
}

MavlinkMessage gps_raw() {
  MavlinkMessage m{24, "GPS_RAW_INT", {stamp_us(), field("fix_type", GatherType::kUint8)}};
  add_gps(m.fields);
  for (const auto& f : {field("eph", GatherType::kUint16, "1", 0.01), field("epv", GatherType::kUint16, "1", 0.01),
                        field("vel", GatherType::kUint16, "m/s", 0.01), field("cog", GatherType::kUint16, "deg", 0.01),
                        field("satellites_visible", GatherType::kUint8)})
    m.fields.push_back(optional(f));
  for (const auto& f :
       {field("alt_ellipsoid", GatherType::kInt32, "m", 1e-3), field("h_acc", GatherType::kUint32, "m", 1e-3),
        field("v_acc", GatherType::kUint32, "m", 1e-3), field("vel_acc", GatherType::kUint32, "m/s", 1e-3),
        field("hdg_acc", GatherType::kUint32, "deg", 1e-5), field("yaw", GatherType::kUint16, "deg", 0.01)})
    m.fields.push_back(extension(f));
  return m;
}

std::vector<MavlinkMessage> declared() {
  std::vector<MavlinkMessage> all{
      {0,
       "HEARTBEAT",
       {field("type", GatherType::kUint8), field("autopilot", GatherType::kUint8),
        field("base_mode", GatherType::kUint8), field("custom_mode", GatherType::kUint32),
        field("system_status", GatherType::kUint8), field("mavlink_version", GatherType::kUint8)}},
      {22,
       "PARAM_VALUE",
       {array("param_id", GatherType::kText, 16), field("param_value", GatherType::kFloat),
        field("param_type", GatherType::kUint8), field("param_count", GatherType::kUint16),
        field("param_index", GatherType::kUint16)}},
      gps_raw(),
      scaled_imu(26, "SCALED_IMU"),
      scaled_pressure(29, "SCALED_PRESSURE"),
      {31,
       "ATTITUDE_QUATERNION",
       {boot_ms(), field("q1", GatherType::kFloat), field("q2", GatherType::kFloat), field("q3", GatherType::kFloat),
        field("q4", GatherType::kFloat)}},
      servo_output(),
      rc_channels(),
      {74,
       "VFR_HUD",
       {field("airspeed", GatherType::kFloat, "m/s"), field("groundspeed", GatherType::kFloat, "m/s"),
        field("heading", GatherType::kInt16, "deg"), field("throttle", GatherType::kUint16, "1", 0.01),
        field("alt", GatherType::kFloat, "m"), field("climb", GatherType::kFloat, "m/s")}},
      scaled_imu(116, "SCALED_IMU2"),
      scaled_imu(129, "SCALED_IMU3"),
      scaled_pressure(137, "SCALED_PRESSURE2"),
      {140,
       "ACTUATOR_CONTROL_TARGET",
       {stamp_us(), field("group_mlx", GatherType::kUint8), array("controls", GatherType::kFloat, 8)},
       "group_mlx"},
      {168,
       "WIND",
       {field("direction", GatherType::kFloat, "deg"), field("speed", GatherType::kFloat, "m/s"),
        field("speed_z", GatherType::kFloat, "m/s")}},
      {226, "RPM", {field("rpm1", GatherType::kFloat, "rpm"), field("rpm2", GatherType::kFloat, "rpm")}},
      {231,
       "WIND_COV",
       {stamp_us(), field("wind_x", GatherType::kFloat, "m/s"), field("wind_y", GatherType::kFloat, "m/s"),
        field("wind_z", GatherType::kFloat, "m/s"), field("var_horiz", GatherType::kFloat, "m/s"),
        field("var_vert", GatherType::kFloat, "m/s"), field("wind_alt", GatherType::kFloat, "m"),
        field("horiz_accuracy", GatherType::kFloat, "m/s"), field("vert_accuracy", GatherType::kFloat, "m/s")}},
      {253,
       "STATUSTEXT",
       {field("severity", GatherType::kUint8), array("text", GatherType::kText, 50),
        extension(field("id", GatherType::kUint16)), extension(field("chunk_seq", GatherType::kUint8))}},
      {295,
       "AIRSPEED",
       {field("id", GatherType::kUint8), field("airspeed", GatherType::kFloat, "m/s"),
        field("temperature", GatherType::kInt16, "degC", 0.01), field("raw_press", GatherType::kFloat, "mbar"),
        field("flags", GatherType::kUint8)},
       "id"},
      {375,
       "ACTUATOR_OUTPUT_STATUS",
       {stamp_us(), field("active", GatherType::kUint32), array("actuator", GatherType::kFloat, 32)}},
  };
  const auto find = [&](std::uint32_t id) -> std::vector<MavlinkField>& {
    return std::ranges::find(all, id, &MavlinkMessage::id)->fields;
  };
  add(find(31), kRates, GatherType::kFloat, "rad/s");
  find(31).push_back(extension(array("repr_offset_q", GatherType::kFloat, 4)));

  MavlinkMessage attitude{30, "ATTITUDE", {boot_ms()}};
  add(attitude.fields, kAngleNames, GatherType::kFloat, "rad");
  add(attitude.fields, kRates, GatherType::kFloat, "rad/s");
  all.push_back(attitude);

  MavlinkMessage local{32, "LOCAL_POSITION_NED", {boot_ms()}};
  add(local.fields, {"x", "y", "z"}, GatherType::kFloat, "m");
  add(local.fields, kVelocityNames, GatherType::kFloat, "m/s");
  all.push_back(local);

  MavlinkMessage global{33, "GLOBAL_POSITION_INT", {boot_ms()}};
  add_gps(global.fields);
  global.fields.push_back(field("relative_alt", GatherType::kInt32, "m", 1e-3));
  add(global.fields, kVelocityNames, GatherType::kInt16, "m/s", 0.01);
  global.fields.push_back(optional(field("hdg", GatherType::kUint16, "deg", 0.01)));
  all.push_back(global);

  // By its XML without units; ArduPilot, which sends it, fills it as SCALED_IMU.
  MavlinkMessage raw{27, "RAW_IMU", {stamp_us()}};
  add_scaled_imu(raw.fields);
  raw.fields.push_back(extension(field("id", GatherType::kUint8)));
  raw.fields.push_back(extension(field("temperature", GatherType::kInt16, "degC", 0.01)));
  raw.instance = "id";
  all.push_back(raw);

  MavlinkMessage highres{105, "HIGHRES_IMU", {stamp_us()}};
  add(highres.fields, kAcc, GatherType::kFloat, "m/s^2");
  add(highres.fields, kGyro, GatherType::kFloat, "rad/s");
  add(highres.fields, kMag, GatherType::kFloat, "mG", 1000.0);
  for (const auto& f :
       {field("abs_pressure", GatherType::kFloat, "mbar"), field("diff_pressure", GatherType::kFloat, "mbar"),
        field("pressure_alt", GatherType::kFloat, "m"), field("temperature", GatherType::kFloat, "degC"),
        field("fields_updated", GatherType::kUint16), extension(field("id", GatherType::kUint8))})
    highres.fields.push_back(f);
  highres.instance = "id";
  all.push_back(highres);
  return all;
}

const char* declared_type(GatherType type) {
  switch (type) {
    case GatherType::kInt8:
      return "int8_t";
    case GatherType::kInt16:
      return "int16_t";
    case GatherType::kUint16:
      return "uint16_t";
    case GatherType::kInt32:
      return "int32_t";
    case GatherType::kUint32:
      return "uint32_t";
    case GatherType::kInt64:
      return "int64_t";
    case GatherType::kUint64:
      return "uint64_t";
    case GatherType::kFloat:
      return "float";
    case GatherType::kDouble:
      return "double";
    case GatherType::kText:
      return "char";
    default:
      return "uint8_t";
  }
}

/// The message with the places of its fields, its sizes and its CRC_EXTRA. Fields of the payload are ordered by the
/// size of their type, the largest first; extensions follow as they are declared.
MavlinkMessage laid_out(MavlinkMessage m) {
  std::vector<MavlinkField*> order;
  for (MavlinkField& f : m.fields) order.push_back(&f);
  const auto extensions =
      std::stable_partition(order.begin(), order.end(), [](const MavlinkField* f) { return !f->extension; });
  std::stable_sort(order.begin(), extensions,
                   [](const MavlinkField* a, const MavlinkField* b) { return a->element_size() > b->element_size(); });
  std::uint16_t crc = mavlink_crc(std::string(m.name) + " ");
  for (MavlinkField* const f : order) {
    f->offset = m.size;
    m.size += f->count * f->element_size();
    if (f->extension) continue;
    m.least_size = m.size;
    crc = mavlink_crc(std::string(declared_type(f->type)) + " " + std::string(f->name) + " ", crc);
    if (f->count > 1) crc = mavlink_crc(std::string(1, static_cast<char>(f->count)), crc);
  }
  m.crc_extra = static_cast<std::uint8_t>((crc & 0xffU) ^ (crc >> 8U));
  return m;
}

}  // namespace

std::uint32_t MavlinkField::element_size() const {
  // A text is an array of characters.
  return type == GatherType::kText ? 1U : static_cast<std::uint32_t>(size_of(type));
}

const MavlinkField* MavlinkMessage::find(std::string_view field_name) const {
  const auto found = std::ranges::find(fields, field_name, &MavlinkField::name);
  return found == fields.end() ? nullptr : &*found;
}

const MavlinkMessage* find_mavlink_message(std::uint32_t id) {
  constexpr std::size_t kIds = 512;
  static const std::vector<MavlinkMessage> messages = [] {
    std::vector<MavlinkMessage> all;
    for (MavlinkMessage& m : declared()) all.push_back(laid_out(std::move(m)));
    return all;
  }();
  static const std::array<const MavlinkMessage*, kIds> by_id = [] {
    std::array<const MavlinkMessage*, kIds> places{};
    for (const MavlinkMessage& m : messages) places[m.id] = &m;
    return places;
  }();
  return id < kIds ? by_id[id] : nullptr;
}

std::uint16_t mavlink_crc(std::string_view bytes, std::uint16_t crc) {
  // Polynomial 0x1021, the least significant bit first.
  static constexpr std::array<std::uint16_t, 256> kTable = [] {
    std::array<std::uint16_t, 256> table{};
    for (unsigned byte = 0; byte < table.size(); ++byte) {
      unsigned value = byte;
      for (int bit = 0; bit < 8; ++bit) value = (value & 1U) != 0 ? value >> 1U ^ 0x8408U : value >> 1U;
      table[byte] = static_cast<std::uint16_t>(value);
    }
    return table;
  }();
  for (const char c : bytes)
    crc = static_cast<std::uint16_t>(crc >> 8U ^ kTable[(crc ^ static_cast<unsigned char>(c)) & 0xffU]);
  return crc;
}

}  // namespace veridyn::io
