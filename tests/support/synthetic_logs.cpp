#include "tests/support/synthetic_logs.hpp"

#include <cmath>
#include <cstring>

namespace veridyn::testing {
namespace {

std::uint32_t size_of(char c) {
  switch (c) {
    case 'b':
    case 'B':
    case 'M':
      return 1;
    case 'h':
    case 'H':
    case 'c':
    case 'C':
      return 2;
    case 'q':
    case 'Q':
    case 'd':
      return 8;
    case 'N':
      return 16;
    case 'Z':
    case 'a':
      return 64;
    default:
      return 4;
  }
}

template <typename T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_text(std::string& out, const std::string& text, std::size_t size) {
  const std::size_t used = std::min(size, text.size());
  out.append(text, 0, used);
  out.append(size - used, '\0');
}

void put_value(std::string& out, char type, const DataFlashWriter::Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    put_text(out, *text, size_of(type));
    return;
  }
  const double number = std::get<double>(value);
  switch (type) {
    case 'b':
      return put(out, static_cast<std::int8_t>(number));
    case 'B':
    case 'M':
      return put(out, static_cast<std::uint8_t>(number));
    case 'h':
      return put(out, static_cast<std::int16_t>(number));
    case 'H':
      return put(out, static_cast<std::uint16_t>(number));
    case 'c':
      return put(out, static_cast<std::int16_t>(std::lround(number * 100.0)));
    case 'C':
      return put(out, static_cast<std::uint16_t>(std::lround(number * 100.0)));
    case 'i':
      return put(out, static_cast<std::int32_t>(number));
    case 'I':
      return put(out, static_cast<std::uint32_t>(number));
    case 'e':
      return put(out, static_cast<std::int32_t>(std::lround(number * 100.0)));
    case 'E':
      return put(out, static_cast<std::uint32_t>(std::lround(number * 100.0)));
    case 'L':
      return put(out, static_cast<std::int32_t>(std::lround(number * 1e7)));
    case 'q':
      return put(out, static_cast<std::int64_t>(number));
    case 'Q':
      return put(out, static_cast<std::uint64_t>(number));
    case 'd':
      return put(out, number);
    case 'a':
      for (int i = 0; i < 32; ++i) put(out, static_cast<std::int16_t>(number + i));
      return;
    default:
      return put(out, static_cast<float>(number));
  }
}

std::string key_and_value(const std::string& key, std::string_view value) {
  std::string body(1, static_cast<char>(key.size()));
  return body + key + std::string(value);
}

struct Message {
  const char* name;
  const char* characters;
  const char* labels;
  const char* units;
  const char* multipliers;
  int divisor;  ///< logged every n-th step of 50 Hz
};

// Messages, rates and formats as ArduPlane 4.0 logs them.
constexpr Message kFlight[] = {
    {"IMU", "QffffffIIfBBHH", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz", "sEEEooo--O--zz",
     "F000000-----00", 1},
    {"IMU2", "QffffffIIfBBHH", "TimeUS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,EG,EA,T,GH,AH,GHz,AHz", "sEEEooo--O--zz",
     "F000000-----00", 1},
    {"ATT", "QccccCCCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw", "sddddhhdh", "FBBBBBBBB", 2},
    {"CTUN", "Qcccchhhf", "TimeUS,NavRoll,Roll,NavPitch,Pitch,ThrOut,RdrOut,ThrDem,Aspd", "sdddd---n", "FBBBB---0", 2},
    {"RCIN", "QHHHHHHHHHHHHHH", "TimeUS,C1,C2,C3,C4,C5,C6,C7,C8,C9,C10,C11,C12,C13,C14", "sYYYYYYYYYYYYYY",
     "F--------------", 2},
    {"RCOU", "QHHHHHHHHHHHHHH", "TimeUS,C1,C2,C3,C4,C5,C6,C7,C8,C9,C10,C11,C12,C13,C14", "sYYYYYYYYYYYYYY",
     "F--------------", 2},
    {"AETR", "Qhhhhh", "TimeUS,Ail,Elev,Thr,Rudd,Flap", "s-----", "F-----", 2},
    {"XKF1", "QBccCfffffffccce", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,dPD,PN,PE,PD,GX,GY,GZ,OH", "s#ddhnnnnmmmkkkm",
     "F-BBB0000000BBBB", 2},
    {"PIDR", "Qfffffff", "TimeUS,Tar,Act,Err,P,I,D,FF", "s-------", "F-------", 2},
    {"VIBE", "QfffIII", "TimeUS,VibeX,VibeY,VibeZ,Clip0,Clip1,Clip2", "sooo---", "F000---", 2},
    {"ARSP", "QffcffBBfB", "TimeUS,Airspeed,DiffPress,Temp,RawPress,Offset,U,Health,Hfp,Pri", "snPOPP----",
     "F00B00----", 5},
    {"BARO", "QffcfIffB", "TimeUS,Alt,Press,Temp,CRt,SMS,Offset,GndTemp,Health", "smPOnsmO-", "F00B0C?0-", 5},
    {"GPS", "QBIHBcLLeffffB", "TimeUS,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw,U", "s---SmDUmnhnh-",
     "F----0BGGB000-", 10},
};

}  // namespace

DataFlashWriter::DataFlashWriter(bool self_description) {
  formats_["FMT"] = {128, "BBnNZ", 89};
  if (self_description) format(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
}

void DataFlashWriter::format(std::uint8_t type, const std::string& name, const std::string& characters,
                             const std::string& labels, std::uint8_t length) {
  std::uint32_t sum = 3;
  for (const char c : characters) sum += size_of(c);
  if (length == 0) length = static_cast<std::uint8_t>(sum);
  formats_[name] = {type, characters, length};
  bytes_ += "\xA3\x95\x80";
  put(bytes_, type);
  put(bytes_, length);
  put_text(bytes_, name, 4);
  put_text(bytes_, characters, 16);
  put_text(bytes_, labels, 64);
}

void DataFlashWriter::unit_tables() {
  format(219, "UNIT", "QbZ", "TimeUS,Id,Label");
  format(218, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds");
  format(220, "MULT", "Qbd", "TimeUS,Id,Mult");
  const std::pair<char, const char*> kUnits[] = {{'-', ""},
                                                 {'s', "s"},
                                                 {'d', "deg"},
                                                 {'h', "degheading"},
                                                 {'D', "deglatitude"},
                                                 {'k', "deg/s"},
                                                 {'U', "deglongitude"},
                                                 {'E', "rad/s"},
                                                 {'o', "m/s/s"},
                                                 {'n', "m/s"},
                                                 {'m', "m"},
                                                 {'P', "Pa"},
                                                 {'O', "degC"},
                                                 {'Y', "us"},
                                                 {'z', "Hz"},
                                                 {'#', "instance"},
                                                 {'S', "satellites"},
                                                 {'v', "V"},
                                                 {'G', "Gauss"},
                                                 {'?', "UNKNOWN"}};
  for (const auto& [id, label] : kUnits) record("UNIT", {0.0, static_cast<double>(id), std::string(label)});
  // Multipliers are floats in the firmware.
  const std::pair<char, float> kMultipliers[] = {{'-', 0.0F},  {'?', 1.0F},  {'0', 1.0F},  {'A', 0.1F},
                                                 {'B', 0.01F}, {'C', 1e-3F}, {'F', 1e-6F}, {'G', 1e-7F}};
  for (const auto& [id, value] : kMultipliers) {
    record("MULT", {0.0, static_cast<double>(id), static_cast<double>(value)});
  }
}

void DataFlashWriter::units(const std::string& name, const std::string& unit_ids, const std::string& multiplier_ids) {
  record("FMTU", {0.0, static_cast<double>(formats_.at(name).type), unit_ids, multiplier_ids});
}

void DataFlashWriter::record(const std::string& name, const std::vector<Value>& values) {
  const Known& known = formats_.at(name);
  const std::size_t begin = bytes_.size();
  bytes_ += "\xA3\x95";
  put(bytes_, known.type);
  for (std::size_t i = 0; i < known.characters.size() && i < values.size(); ++i) {
    put_value(bytes_, known.characters[i], values[i]);
  }
  bytes_.resize(begin + known.length, '\0');
}

ULogWriter::ULogWriter(std::uint64_t start_us, bool flags) {
  bytes_ = std::string("\x55\x4C\x6F\x67\x01\x12\x35\x01", 8) + pack(start_us);
  if (flags) message('B', std::string(40, '\0'));
}

void ULogWriter::message(char type, std::string_view body) {
  put(bytes_, static_cast<std::uint16_t>(body.size()));
  bytes_ += type;
  bytes_ += body;
}

void ULogWriter::information(const std::string& key, std::string_view value) {
  message('I', key_and_value(key, value));
}

void ULogWriter::information_part(bool continued, const std::string& key, std::string_view value) {
  message('M', std::string(1, continued ? '\1' : '\0') + key_and_value(key, value));
}

void ULogWriter::parameter(const std::string& name, float value) {
  message('P', key_and_value("float " + name, pack(value)));
}

void ULogWriter::parameter(const std::string& name, std::int32_t value) {
  message('P', key_and_value("int32_t " + name, pack(value)));
}

void ULogWriter::default_parameter(std::uint8_t kinds, const std::string& name, float value) {
  message('Q', std::string(1, static_cast<char>(kinds)) + key_and_value("float " + name, pack(value)));
}

void ULogWriter::subscribe(std::uint16_t id, const std::string& topic, std::uint8_t instance) {
  message('A', pack(instance, id) + topic);
}

void ULogWriter::unsubscribe(std::uint16_t id) { message('R', pack(id)); }

void ULogWriter::data(std::uint16_t id, std::string_view payload) { message('D', pack(id) + std::string(payload)); }

void ULogWriter::text(char level, std::uint64_t time_us, const std::string& words) {
  message('L', std::string(1, level) + pack(time_us) + words);
}

void ULogWriter::tagged_text(char level, std::uint16_t tag, std::uint64_t time_us, const std::string& words) {
  message('C', std::string(1, level) + pack(tag, time_us) + words);
}

void ULogWriter::sync() { message('S', std::string_view("\x2F\x73\x13\x20\x25\x0C\xBB\x12", 8)); }

void ULogWriter::dropout(std::uint16_t duration_ms) { message('O', pack(duration_ms)); }

void ULogWriter::append_from_here(int index) {
  const std::uint64_t here = bytes_.size();
  bytes_[16 + 3 + 8] = 1;
  std::memcpy(bytes_.data() + 16 + 3 + 16 + 8 * index, &here, sizeof here);
}

std::string synthetic_dataflash(double megabytes) {
  DataFlashWriter log;
  log.unit_tables();
  std::uint8_t type = 130;
  for (const Message& message : kFlight) {
    log.format(type++, message.name, message.characters, message.labels);
    log.units(message.name, message.units, message.multipliers);
  }
  const auto limit = static_cast<std::size_t>(megabytes * 1e6);
  std::vector<DataFlashWriter::Value> values;
  for (int step = 0; log.bytes().size() < limit; ++step) {
    for (const Message& message : kFlight) {
      if (step % message.divisor != 0) continue;
      values.assign(std::strlen(message.characters), 0.0);
      values[0] = 1e6 + 20000.0 * step;
      for (std::size_t i = 1; i < values.size(); ++i)
        values[i] = static_cast<double>((step * 7 + static_cast<int>(i) * 13) % 100);
      if (message.name == std::string_view("XKF1")) {
        for (double core = 0.0; core < 2.0; ++core) {
          values[1] = core;
          log.record(message.name, values);
        }
      } else {
        log.record(message.name, values);
      }
    }
  }
  return log.take();
}

std::string synthetic_ulog(double megabytes) {
  ULogWriter log;
  log.format(
      "sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;"
      "int32_t accelerometer_timestamp_relative;float[3] accelerometer_m_s2;uint32_t accelerometer_integral_dt;"
      "uint8_t accelerometer_clipping;uint8_t[3] _padding0;");
  log.format(
      "vehicle_attitude:uint64_t timestamp;uint64_t timestamp_sample;float[4] q;float[4] delta_q_reset;"
      "uint8_t quat_reset_counter;uint8_t[7] _padding0;");
  log.format(
      "vehicle_angular_velocity:uint64_t timestamp;uint64_t timestamp_sample;float[3] xyz;uint8_t[4] _padding0;");
  log.format("actuator_controls_0:uint64_t timestamp;uint64_t timestamp_sample;float[8] control;");
  log.format(
      "airspeed:uint64_t timestamp;float indicated_airspeed_m_s;float true_airspeed_m_s;"
      "float air_temperature_celsius;float confidence;");
  log.format("esc_report:uint64_t timestamp;int32_t esc_rpm;float esc_voltage;float esc_current;");
  log.format(
      "esc_status:uint64_t timestamp;uint16_t counter;uint8_t esc_count;uint8_t _padding0;uint32_t spare;"
      "esc_report[4] esc;");
  const char* const topics[] = {"sensor_combined",     "vehicle_attitude", "vehicle_angular_velocity",
                                "actuator_controls_0", "airspeed",         "esc_status"};
  for (std::uint16_t id = 0; id < 6; ++id) log.subscribe(id, topics[id]);
  const auto limit = static_cast<std::size_t>(megabytes * 1e6);
  for (std::uint32_t step = 0; log.bytes().size() < limit; ++step) {
    const std::uint64_t t = 1000000 + 4000ULL * step;
    const float x = static_cast<float>(step % 100) * 0.01F;
    log.data(
        0, pack(t, x, x, x, std::uint32_t{4000}, std::int32_t{-3}, x, x, -9.81F, std::uint32_t{4000}, std::uint8_t{0}));
    log.data(2, pack(t, t - 500, x, x, x));
    log.data(3, pack(t, t - 500, x, x, x, x, x, x, x, x));
    if (step % 2 == 0) log.data(1, pack(t, t - 500, 1.0F, x, x, x, 1.0F, 0.0F, 0.0F, 0.0F, std::uint8_t{1}));
    if (step % 10 == 0) {
      log.data(4, pack(t, 15.0F + x, 15.5F + x, 20.0F, 1.0F));
      std::string escs = pack(t, std::uint16_t{1}, std::uint8_t{4}, std::uint8_t{0}, std::uint32_t{0});
      for (int i = 0; i < 4; ++i) escs += pack(t, std::int32_t{5000 + i}, 12.0F, 3.0F);
      log.data(5, escs);
    }
    if (step % 250 == 0) log.sync();
  }
  return std::move(log.bytes());
}

std::string small_dataflash() {
  DataFlashWriter log;
  log.unit_tables();
  log.format(129, "PARM", "QNf", "TimeUS,Name,Value");
  log.format(130, "MSG", "QZ", "TimeUS,Message");
  log.format(131, "MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn");
  log.format(132, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
  log.units("IMU", "s#EEEooo", "F-000000");
  log.format(133, "ATT", "QccC", "TimeUS,Roll,Pitch,Yaw");
  log.units("ATT", "sddh", "FBBB");
  log.format(134, "GPS", "QLLeh", "TimeUS,Lat,Lng,Alt,MagX");
  log.units("GPS", "sDUmG", "FGGBC");
  log.format(135, "ISBD", "Qa", "TimeUS,x");
  log.format(136, "BARO", "QfcQ", "TimeUS,Alt,Temp,SMS");
  log.units("BARO", "smOs", "F0BF");
  log.record("PARM", {1e6, std::string("SERVO1_TRIM"), 1500.0});
  log.record("MSG", {1e6, std::string("ArduPlane V4.2.3 (abcdef01)")});
  log.record("MODE", {1e6, 5.0, 5.0, 1.0});
  for (int i = 0; i < 8; ++i) {
    const double t = 1e6 + 20000.0 * i;
    log.record("IMU", {t, 0.0, 0.5, -0.25, 0.125 * i, 0.5, 0.25, -9.75});
    log.record("IMU", {t + 10, 1.0, 1.5, -1.25, 0.125 * i, 0.5, 0.25, -9.5});
    log.record("ATT", {t, 12.34, -5.67, 359.99});
    if (i % 2 == 0) log.record("BARO", {t, 100.0 + i, 21.5, t});
    if (i % 4 == 0) log.record("GPS", {t, -37.9596764, 144.7648038, 15.78, 250.0});
  }
  log.record("ISBD", {1.2e6, -3.0});
  return log.take();
}

std::string small_dataflash_text() {
  return "ArduPlane V2.74b\n"
         "\n"
         "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format\n"
         "FMT, 129, 23, PARM, Nf, Name,Value\n"
         "FMT, 130, 45, GPS, BIHBcLLeeEefI, Status,TimeMS,Week,NSats,HDop,Lat,Lng,RelAlt,Alt,Spd,GCrs,VZ,T\n"
         "FMT, 131, 31, IMU, Iffffff, TimeMS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ\n"
         "FMT, 132, 67, MSG, Z, Message\n"
         "FMT, 1, 17, ATT, IccccC, TimeMS,DesRoll,Roll,DesPitch,Pitch,Yaw\n"
         "FMT, 3, 6, MODE, Mh, Mode,ThrCrs\n"
         "FMT, 10, 3, STRT, , \n"
         "PARM, SYSID_SW_MREV, 120\n"
         "PARM, COMPASS_MOT_X, NaN\n"
         "MSG, ArduPlane V2.74b (681dafcf), a text, with commas\n"
         "STRT\n"
         "MODE, FBWA, 424\n"
         "IMU, 1000, 0.5, -0.25, 0.125, 0.5, 0.25, -9.75\n"
         "ATT, 1000, 0.00, 12.34, 0.00, -5.67, 359.99\n"
         "GPS, 3, 511214500, 1768, 7, 1.99, -37.9596764, 144.7648038, 0.05, 15.78, 2.03, 278.85, 2.98, 1010\n"
         "IMU, 1020, 0.5, -0.25, 0.125, 0.5, 0.25, -9.75\n"
         "ATT, 1020, 0.00, 12.40, 0.00, -5.60, 0.01\n";
}

std::string small_ulog() {
  ULogWriter log;
  log.information("char[3] sys_name", "PX4");
  log.information("uint32_t ver_sw_release", pack(std::uint32_t{17498624}));
  log.information_part(false, "char[3] notes", "one");
  log.information_part(false, "char[3] notes", "two");
  log.information_part(true, "char[2] notes", "!!");
  log.parameter("FW_AIRSPD_MIN", 10.5F);
  log.parameter("SYS_AUTOSTART", std::int32_t{2106});
  log.default_parameter(1, "FW_AIRSPD_MIN", 10.0F);
  log.format("sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint8_t clipping;uint8_t[3] _padding0;");
  log.format("esc_report:uint64_t timestamp;int32_t esc_rpm;uint8_t _padding0;");
  log.format("esc_status:uint64_t timestamp;esc_report[2] esc;bool armed;char[4] label;uint8_t[3] _padding0;");
  log.format("vehicle_status:uint64_t timestamp;uint8_t nav_state;uint8_t arming_state;");
  log.subscribe(0, "sensor_combined");
  log.subscribe(1, "esc_status");
  log.subscribe(2, "differential_pressure", 1);
  log.subscribe(3, "vehicle_status");
  log.text('6', 1000000, "[logger] started");
  for (int i = 0; i < 6; ++i) {
    const std::uint64_t t = 1000000 + 4000ULL * static_cast<std::uint64_t>(i);
    const auto x = static_cast<float>(i);
    log.data(0, pack(t, 0.5F * x, -0.25F, 0.125F, static_cast<std::uint8_t>(i)));
    log.data(1, pack(t, t, std::int32_t{5000 + i}, std::uint8_t{0}, t, std::int32_t{-7}, std::uint8_t{0}, true) +
                    std::string("ab\0\0", 4));
    log.data(2, pack(t, -1000.0F));
    if (i % 3 == 0) log.data(3, pack(t, static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i == 0 ? 1 : 2)));
    if (i == 3) log.sync();
  }
  log.format("differential_pressure:uint64_t timestamp;float temperature;");  // after its data
  log.dropout(30);
  log.tagged_text('4', 7, 1010000, "tagged words");
  log.parameter("FW_AIRSPD_MIN", 11.0F);
  return std::move(log.bytes());
}

std::string small_csv() {
  return "# frame: frd\n"
         "time[s],roll[deg],airspeed[m/s],\"odd, name\"[1]\n"
         "0.00,1.5,12.25,1\n"
         "0.02,-2.5,,2\n"
         "0.04,3e1,nan,-3\n"
         "0.06,0,12.5,4\n";
}

namespace {

std::string element(std::uint32_t type, const std::string& data) {
  std::string bytes = pack(type, static_cast<std::uint32_t>(data.size())) + data;
  bytes.resize((bytes.size() + 7) / 8 * 8, '\0');
  return bytes;
}

std::string matrix(std::uint32_t kind, std::int32_t rows, std::int32_t columns, const std::string& name,
                   const std::string& rest) {
  return element(14,
                 element(6, pack(kind, std::uint32_t{0})) + element(5, pack(rows, columns)) + element(1, name) + rest);
}

std::string doubles(const std::vector<double>& values) {
  std::string bytes;
  for (const double value : values) bytes += pack(value);
  return bytes;
}

}  // namespace

std::string small_mat() {
  std::string file = "MATLAB 5.0 MAT-file, written by a test";
  file.resize(124, ' ');
  file += std::string("\x00\x01IM", 4);
  std::string names;
  for (const char* name : {"time", "p", "q", "note"}) {
    std::string padded = name;
    padded.resize(8, '\0');
    names += padded;
  }
  const std::vector<double> time{0.0, 0.02, 0.04};
  // "length of a name" is a small element: its data lie inside of the tag.
  const std::string fields =
      pack(std::uint16_t{5}, std::uint16_t{4}, std::int32_t{8}) + element(1, names) +
      matrix(6, 3, 1, "", element(9, doubles(time))) + matrix(6, 3, 1, "", element(9, doubles({0.1, 0.2, 0.3}))) +
      matrix(10, 3, 1, "", element(3, pack(std::int16_t{-1}, std::int16_t{0}, std::int16_t{7}))) +
      matrix(4, 1, 2, "", element(16, "hi"));
  file += matrix(2, 1, 1, "flight", fields);
  file += matrix(6, 2, 3, "table", element(9, doubles({1, 2, 3, 4, 5, 6})));
  return file;
}

}  // namespace veridyn::testing
