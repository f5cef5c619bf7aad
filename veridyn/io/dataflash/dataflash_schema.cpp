#include "veridyn/io/dataflash/dataflash_schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <set>

#include "veridyn/core/error.hpp"

namespace veridyn::io {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = text.find(separator);
    std::string_view part = text.substr(0, end);
    while (!part.empty() && part.front() == ' ') part.remove_prefix(1);
    while (!part.empty() && part.back() == ' ') part.remove_suffix(1);
    parts.push_back(part);
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

// ArduPilot's labels (LogStructure.h, log_Units) in the words of parse_unit.
std::string readable_unit(std::string_view label) {
  static const std::map<std::string, std::string, std::less<>> words{{"deglatitude", "deg"},
                                                                     {"deglongitude", "deg"},
                                                                     {"degheading", "deg"},
                                                                     {"deg/s/s", "deg/s^2"},
                                                                     {"m/s/s", "m/s^2"},
                                                                     {"rad/s/s", "rad/s^2"},
                                                                     {"Gauss", "gauss"},
                                                                     {"mGauss", "mG"},
                                                                     {"A.s", "A s"},
                                                                     {"Ah", "A h"},
                                                                     {"mAh", "mA h"},
                                                                     {"W.s", "W s"},
                                                                     {"J", "J"},
                                                                     {"W.h", "W h"},
                                                                     {"Wh", "W h"},
                                                                     {"Ohm", "V/A"},
                                                                     {"Watt", "W"},
                                                                     {"degC", "degC"},
                                                                     {"C", "degC"},
                                                                     {"RPM", "rpm"},
                                                                     {"km/h", "km/h"},
                                                                     {"mm/s", "mm/s"},
                                                                     {"kg/m/m/m", "kg/m^3"},
                                                                     {"UNKNOWN", "1"},
                                                                     {"instance", "1"},
                                                                     {"satellites", "1"},
                                                                     {"B", "1"},
                                                                     {"ppm", "1"}};
  if (const auto found = words.find(label); found != words.end()) return found->second;
  try {
    return parse_unit(label).name;
  } catch (const InputError&) {
    return "1";
  }
}

// A multiplier is written as a float that was widened: 0.0099999998 means 0.01.
double intended_decimal(double value) {
  const auto narrow = static_cast<float>(value);
  if (static_cast<double>(narrow) != value) return value;
  const std::string digits = fmt::format("{}", narrow);
  double result = value;
  std::from_chars(digits.data(), digits.data() + digits.size(), result);
  return result;
}

bool scales_itself(char type) { return dataflash_scale(type) != 1.0; }

// Units of the messages that matter for flight, as ArduPilot's documentation of log messages gives them: for logs
// without FMTU (before 2018). "message: fields=unit; ...", the scale after '*'.
constexpr std::string_view kKnown =
    "IMU: GyrX,GyrY,GyrZ=rad/s; AccX,AccY,AccZ=m/s^2; Temp,T=degC\n"
    "ACC: AccX,AccY,AccZ=m/s^2\n"
    "GYR: GyrX,GyrY,GyrZ=rad/s\n"
    "ATT: DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw=deg\n"
    "AHR2: Roll,Pitch,Yaw,Lat,Lng=deg; Alt=m\n"
    "POS: Lat,Lng=deg; Alt,RelAlt,RelHomeAlt,RelOriginAlt=m\n"
    "GPS: Lat,Lng,GCrs,Yaw=deg; Alt,RelAlt=m; Spd,VZ=m/s; GMS=ms\n"
    "GPA: HAcc,VAcc=m; SAcc=m/s\n"
    "BARO: Alt=m; Press=Pa; Temp,GndTemp=degC; CRt=m/s\n"
    "ARSP: Airspeed=m/s; DiffPress,RawPress,Offset=Pa; Temp=degC\n"
    "CTUN: NavRoll,Roll,NavPitch,Pitch=deg; AccY=m/s^2; Aspd,As=m/s; ThrOut,ThrDem=%\n"
    "NTUN: Yaw,TargBrg,TBrg,NavBrg,TLat,TLng=deg; WpDist,Dist,AltErr,AltE,Alt,XT=m; Arspd,AspdE=m/s; GSpdCM=cm/s\n"
    "MAG: MagX,MagY,MagZ,OfsX,OfsY,OfsZ,MOfsX,MOfsY,MOfsZ,MOX,MOY,MOZ=mG\n"
    "NKF1: Roll,Pitch,Yaw=deg; VN,VE,VD,dPD=m/s; PN,PE,PD,OH=m; GX,GY,GZ=deg/s\n"
    "NKF2: GSX,GSY,GSZ=1; VWN,VWE=m/s; MN,ME,MD,MX,MY,MZ=mG\n"
    "NKF6: Roll,Pitch,Yaw=deg; VN,VE,VD,dPD=m/s; PN,PE,PD,OH=m; GX,GY,GZ=deg/s\n"
    "NKF7: VWN,VWE=m/s; MN,ME,MD,MX,MY,MZ=mG\n"
    "XKF1: Roll,Pitch,Yaw=deg; VN,VE,VD,dPD=m/s; PN,PE,PD,OH=m; GX,GY,GZ=deg/s\n"
    "XKF2: VWN,VWE=m/s; MN,ME,MD,MX,MY,MZ=mG\n"
    "EKF1: Roll,Pitch,Yaw=deg; VN,VE,VD=m/s; PN,PE,PD=m\n"
    "EKF2: VWN,VWE=m/s; MN,ME,MD,MX,MY,MZ=mG\n"
    "RCIN: C1,C2,C3,C4,C5,C6,C7,C8,C9,C10,C11,C12,C13,C14,Chan1,Chan2,Chan3,Chan4,Chan5,Chan6,Chan7,Chan8=us\n"
    "RCOU: C1,C2,C3,C4,C5,C6,C7,C8,C9,C10,C11,C12,C13,C14,Chan1,Chan2,Chan3,Chan4,Chan5,Chan6,Chan7,Chan8,"
    "Ch1,Ch2,Ch3,Ch4,Ch5,Ch6,Ch7,Ch8,Ch9,Ch10,Ch11,Ch12=us\n"
    "AOA: AOA,SSA=deg\n"
    "RPM: rpm1,rpm2,RPM1,RPM2=rpm\n"
    "VIBE: VibeX,VibeY,VibeZ=m/s^2\n"
    "BAT: Volt,VoltR=V; Curr=A; CurrTot=mA h; Temp=degC\n"
    "POWR: Vcc,VServo=V\n"
    "TERR: TerrH,CHeight=m\n"
    "ORGN: Alt=m\n"
    "CMD: Alt=m\n"
    "CAM: Roll,Pitch,Yaw=deg; Alt,RelAlt,GPSAlt=m\n"
    "SIM: Roll,Pitch,Yaw=deg; Alt=m\n"
    "SIM2: PN,PE,PD=m; VN,VE,VD,As=m/s\n"
    "SIDD: Time=s; F=Hz; Gx,Gy,Gz=deg/s; Ax,Ay,Az=m/s^2\n"
    "PIDR: \nPIDP: \nPIDY: \nPIDS: \n";

using KnownTable = std::map<std::string, std::map<std::string, KnownUnit, std::less<>>, std::less<>>;

const KnownTable& known_table() {
  static const KnownTable table = [] {
    KnownTable result;
    for (const std::string_view line : split(kKnown, '\n')) {
      const std::size_t colon = line.find(':');
      if (colon == std::string_view::npos) continue;
      auto& fields = result[std::string(line.substr(0, colon))];
      for (const std::string_view group : split(line.substr(colon + 1), ';')) {
        const std::size_t equals = group.find('=');
        if (equals == std::string_view::npos) continue;
        for (const std::string_view name : split(group.substr(0, equals), ',')) {
          fields[std::string(name)] = KnownUnit{std::string(group.substr(equals + 1)), 1.0};
        }
      }
    }
    return result;
  }();
  return table;
}

}  // namespace

std::uint32_t dataflash_size(char character) {
  switch (character) {
    case 'b':
    case 'B':
    case 'M':
      return 1;
    case 'h':
    case 'H':
    case 'c':
    case 'C':
    case 'g':
      return 2;
    case 'i':
    case 'I':
    case 'f':
    case 'n':
    case 'e':
    case 'E':
    case 'L':
      return 4;
    case 'd':
    case 'q':
    case 'Q':
      return 8;
    case 'N':
      return 16;
    case 'Z':
    case 'a':
      return 64;
    default:
      return 0;
  }
}

double dataflash_scale(char character) {
  switch (character) {
    case 'c':
    case 'C':
    case 'e':
    case 'E':
      return 0.01;
    case 'L':
      return 1e-7;
    default:
      return 1.0;
  }
}

std::vector<DataFlashColumn> dataflash_columns(const DataFlashFormat& format, bool binary) {
  std::vector<DataFlashColumn> columns;
  std::set<std::string> taken;
  const auto labels = split(format.labels, ',');
  std::uint32_t offset = 3;
  for (std::size_t i = 0; i < format.characters.size(); ++i) {
    const char type = format.characters[i];
    const std::uint32_t size = dataflash_size(type);
    if (binary && (size == 0 || offset + size > format.length)) break;
    DataFlashColumn column;
    column.type = type;
    column.offset = offset;
    column.name = internal::printable(i < labels.size() ? labels[i] : std::string_view());
    if (column.name.empty()) column.name = fmt::format("column{}", i + 1);
    for (int copy = 2; !taken.insert(column.name).second; ++copy) {
      const std::string_view label = i < labels.size() && !labels[i].empty() ? labels[i] : "column";
      column.name = fmt::format("{}_{}", internal::printable(label), copy);
    }
    columns.push_back(std::move(column));
    offset += size;
  }
  return columns;
}

std::optional<DataFlashFormat> parse_dataflash_format(std::string_view payload) {
  if (payload.size() < 86) return std::nullopt;
  const auto text = [&](std::size_t begin, std::size_t size) {
    const std::string_view field = payload.substr(begin, size);
    return std::string(field.substr(0, field.find('\0')));
  };
  DataFlashFormat format;
  format.type = static_cast<std::uint8_t>(payload[0]);
  format.length = static_cast<std::uint8_t>(payload[1]);
  format.name = text(2, 4);
  format.characters = text(6, 16);
  format.labels = text(22, 64);
  const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  if (format.length < 3 || format.name.empty() || !std::all_of(format.name.begin(), format.name.end(), word)) {
    return std::nullopt;
  }
  if (format.type == 128 && format.length != 89) return std::nullopt;
  return format;
}

void DataFlashUnits::add_unit(char id, std::string_view label) { units_[id] = readable_unit(label); }

void DataFlashUnits::add_multiplier(char id, double value) {
  if (std::isfinite(value) && value != 0.0) multipliers_[id] = intended_decimal(value);
}

void DataFlashUnits::add_format(std::uint8_t type, std::string_view unit_ids, std::string_view multiplier_ids) {
  formats_[type] = {std::string(unit_ids), std::string(multiplier_ids)};
}

void DataFlashUnits::apply(const DataFlashFormat& format, std::vector<DataFlashColumn>& columns, bool binary) const {
  const auto& ids = formats_[format.type];
  for (std::size_t i = 0; i < columns.size(); ++i) {
    DataFlashColumn& column = columns[i];
    column.scale = binary ? dataflash_scale(column.type) : 1.0;
    if (ids && !units_.empty()) {
      const auto& [unit_ids, multiplier_ids] = *ids;
      if (i < unit_ids.size()) {
        if (const auto unit = units_.find(unit_ids[i]); unit != units_.end()) column.unit = unit->second;
      }
      if (i < multiplier_ids.size() && !scales_itself(column.type)) {
        if (const auto found = multipliers_.find(multiplier_ids[i]); found != multipliers_.end()) {
          column.scale *= found->second;
        }
      }
    } else {
      const KnownUnit known = known_ardupilot_unit(format.name, column.name);
      column.unit = column.type == 'L' ? "deg" : known.unit;
      column.scale *= known.scale;
    }
  }
}

std::optional<std::size_t> DataFlashUnits::instance_column(const DataFlashFormat& format,
                                                           const std::vector<DataFlashColumn>& columns) const {
  const auto is_count = [&](std::size_t i) {
    return std::string_view("bBMhHiI").find(columns[i].type) != std::string_view::npos;
  };
  if (const auto& ids = formats_[format.type]) {
    const std::size_t i = ids->first.find('#');
    if (i != std::string::npos && i < columns.size() && is_count(i)) return i;
    return std::nullopt;
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string& name = columns[i].name;
    if ((name == "I" || name == "Instance" || name == "Inst") && columns[i].type == 'B') return i;
  }
  return std::nullopt;
}

std::optional<DataFlashTime> dataflash_time(const std::vector<DataFlashColumn>& columns) {
  const auto find = [&](std::string_view name) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i].name == name && std::string_view("QqIid").find(columns[i].type) != std::string_view::npos)
        return i;
    }
    return std::nullopt;
  };
  if (const auto i = find("TimeUS")) return DataFlashTime{*i, 1e-6};
  const auto ms = find("TimeMS");
  if (const auto stamp = find("T");
      stamp && (!ms || find("Week") ||
                std::any_of(columns.begin(), columns.end(), [](const auto& c) { return c.name == "Week"; }))) {
    return DataFlashTime{*stamp, 1e-3};
  }
  if (ms) return DataFlashTime{*ms, 1e-3};
  return std::nullopt;
}

KnownUnit known_ardupilot_unit(std::string_view message, std::string_view field) {
  const KnownTable& table = known_table();
  auto found = table.find(message);
  if (found == table.end() && !message.empty() && std::isdigit(static_cast<unsigned char>(message.back())) != 0) {
    found = table.find(message.substr(0, message.size() - 1));  // IMU2, MAG3, ACC1
  }
  if (found == table.end()) return {};
  const auto unit = found->second.find(field);
  return unit == found->second.end() ? KnownUnit{} : unit->second;
}

}  // namespace veridyn::io
