#include "veridyn/live/rig/live_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/cueing/platform/platform_file.hpp"
#include "veridyn/io/packets/known_packets.hpp"

namespace veridyn::live {
namespace {

/// Layouts from which a motion can be had.
std::vector<io::PacketLayout> read_layouts(const StudyTable& live) {
  if (live.is_table("packet")) {
    const StudyTable packet = live.table("packet");
    std::vector<io::PacketLayout> one = {io::read_packet_layout(packet)};
    try {
      static_cast<void>(PacketIntake(one));
    } catch (const InputError& error) {
      live.fail("packet", error.what());
    }
    return one;
  }
  std::vector<std::string> names = {"any"};
  std::vector<io::PacketLayout> usable;
  for (const io::PacketLayout& layout : io::known_packets()) {
    try {
      static_cast<void>(PacketIntake({layout}));
      names.push_back(layout.name);
      usable.push_back(layout);
    } catch (const InputError&) {
      // No motion in it: engine and pedals only.
    }
  }
  const std::string name = live.text_or("packet", "any");
  if (name == "any") return usable;
  for (const io::PacketLayout& layout : usable) {
    if (layout.name == name) return {layout};
  }
  live.fail("packet", fmt::format("= '{}' is no known packet with a motion ({})", name, fmt::join(names, ", ")));
}

}  // namespace

Sender parse_address(std::string_view text, const std::string& place) {
  Sender s;
  const char *at = text.data(), *const end = text.data() + text.size();
  const auto part = [&](unsigned long most, char before) {
    if (before != '\0') {
      if (at == end || *at != before) return -1L;
      ++at;
    }
    unsigned long value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || value > most) return -1L;
    at = next;
    return static_cast<long>(value);
  };
  bool right = true;
  for (int i = 0; i < 4 && right; ++i) {
    const long byte = part(255, i == 0 ? '\0' : '.');
    right = byte >= 0;
    if (right) s.address = s.address * 256U + static_cast<std::uint32_t>(byte);
  }
  const long port = right ? part(65535, ':') : -1L;
  if (!right || port < 1 || at != end)
    throw InputError(place, fmt::format("= '{}' is no address: takes four numbers and a port, 127.0.0.1:4123", text));
  s.port = static_cast<std::uint16_t>(port);
  return s;
}

namespace {

/// An address, or the device of a serial line.
void read_platform(const StudyTable& live, LiveStudy& s) {
  const std::string platform = live.text("platform");
  if (!platform.starts_with('/')) {
    s.platform = parse_address(platform, live.place("platform"));
    if (s.telemetry == s.platform) live.fail("platform", "is where telemetry comes in");
    if (live.has("baud")) live.fail("baud", "is of a serial line; the platform has an address");
    return;
  }
  s.platform_line.device = platform;
}

/// How orders are written, and whether they are answered.
void read_format(const StudyTable& live, LiveStudy& s) {
  const std::string_view name = name_of(s.format.kind);
  const bool own = s.format.kind == OrderFormatKind::kVeridyn;
  if (!own && s.options.answers)
    live.fail("answers", fmt::format("must be false: a platform of format '{}' does not answer orders", name));
  if (live.has("text") && s.format.kind != OrderFormatKind::kFlypt)
    live.fail("text", fmt::format("is of 'flypt'; format is '{}'", name));
  if (own && !s.platform_line.device.empty())
    live.fail("platform", "is a serial line, on which formats without answers go only; 'veridyn' takes an address");
  std::size_t longest = 0;
  try {
    longest = OrderFormat(s.format, s.cueing.platform).longest();
  } catch (const InputError& error) {
    live.fail(s.format.kind == OrderFormatKind::kFlypt ? "text" : "format", error.what());
  }
  constexpr double kBitsAByte = 10.0;
  const double most = static_cast<double>(s.platform_line.baud) / (kBitsAByte * static_cast<double>(longest));
  if (!s.platform_line.device.empty() && s.options.rate > most)
    live.fail("rate", fmt::format("is {:g} Hz; {} bit/s carry {:.0f} orders of {} bytes a second", s.options.rate,
                                  s.platform_line.baud, std::floor(most), longest));
}

}  // namespace

std::string platform_name(const LiveStudy& study) {
  return study.platform_line.device.empty() ? to_string(study.platform) : study.platform_line.device.string();
}

LiveStudy read_live_study(const Study& study) {
  const StudyTable& root = study.root();
  if (!root.has("live"))
    throw InputError(root.place("live"),
                     "is missing: the table [live] says where telemetry comes from and orders go to");
  if (!root.has("platform"))
    throw InputError(root.place("platform"),
                     "is missing: the limits of a platform that moves are not guessed; [platform] names one "
                     "(subject = \"three_axis\") or states them");
  LiveStudy s;
  s.cueing = cueing::read_study_without_drive(study);
  for (const char* key : {"data", "drive", "subject", "road"}) root.accept(key);
  if (s.cueing.algorithms.size() != 1)
    root.table("cue").fail("algorithms", fmt::format("names {}; a platform follows one", s.cueing.algorithms.size()));
  s.cueing.response.reset();  // `veridyn cue` without --live measures it
  const StudyTable live = root.table("live");
  LiveStudy::keys().read(live, s);
  static_cast<void>(virtual_vehicle_keys().read(live.table_or_empty("vehicle")));  // refused here too where it is wrong
  if (live.has("circuit")) {
    const StudyTable table = live.table("circuit");
    s.circuit = vehicle::read_circuit(table, s.cueing.seed);
    s.circuit_drive = CircuitDriveOptions::keys().read(table);
  }
  if (live.text("telemetry") == "car") {
    s.car = CarStudy::keys().read(live.table_or_empty("car"));
    s.driver = read_driver(live, s.car->range);
    if (live.has("camera")) {
      const StudyTable camera = live.table("camera");
      s.camera = CameraStudy::keys().read(camera);
      camera.accept("fusion");  // read by whoever fuses
      camera.accept("view");    // by the virtual camera, as the next
      camera.accept("tracker");
    }
    if (live.has("stop")) s.telemetry = parse_address(live.text("stop"), live.place("stop"));
  } else {
    s.telemetry = parse_address(live.text("telemetry"), live.place("telemetry"));
    if (live.has("camera")) live.fail("camera", "is for telemetry = \"car\", whose inertial sensors go with it");
    for (const char* key : {"car", "driver"}) live.accept(key);
  }
  read_platform(live, s);
  if (s.car && !s.platform_line.device.empty())
    live.fail("platform", "is a serial line; with a car the platform takes orders at an address");
  s.layouts = read_layouts(live);
  read_format(live, s);
  RigOptions& o = s.options;
  o.sensor = s.car ? s.car->sensor : s.cueing.motion.place;
  o.driver = s.cueing.driver;
  if (s.cueing.motion.gravity != recording::GravityIn::kDecide) {
    const bool in = s.cueing.motion.gravity == recording::GravityIn::kYes;
    for (io::PacketLayout& layout : s.layouts) {
      if (layout.gravity_in && *layout.gravity_in != in)
        s.cueing.notes.push_back(fmt::format("accelerations of {} are taken {} gravity, as [cue] says", layout.sender,
                                             in ? "with" : "without"));
      layout.gravity_in = in;
    }
  }
  return s;
}

Study self_contained(const Study& study, const LiveStudy& live) {
  Study out = live.driver ? with_calibration(study, *live.driver) : study;
  if (!study.root().table("platform").has("file")) return out;
  std::string keys;
  for (const auto& [key, value] : cueing::platform_keys(live.cueing.platform))
    keys += fmt::format("{}{} = {}", keys.empty() ? "" : ", ", key, value);
  const std::array<std::string, 1> overrides = {"platform={" + keys + "}"};
  return Study::parse(out.to_toml(), out.name(), out.folder(), overrides);
}

}  // namespace veridyn::live
