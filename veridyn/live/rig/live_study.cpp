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

/// A number within a range, with its unit in the message.
double number_within(const StudyTable& table, std::string_view key, std::string_view unit, double otherwise,
                     double lowest, double highest) {
  const double value = table.number_or(key, unit, otherwise);
  if (!(value >= lowest && value <= highest))
    table.fail(key, fmt::format("is {:g} {}; takes {:g} to {:g} {}", value, unit, lowest, highest, unit));
  return value;
}

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

VirtualVehicleOptions read_virtual_vehicle(const StudyTable& live) {
  const StudyTable table = live.table_or_empty("vehicle");
  VirtualVehicleOptions o;
  o.rate = number_within(table, "rate", "Hz", o.rate, 1.0, 4000.0);
  o.jitter = number_within(table, "jitter", "s", o.jitter, 0.0, 1.0);
  o.loss = number_within(table, "loss", "1", o.loss, 0.0, 0.99);
  o.clock_drift = number_within(table, "clock_drift", "1", o.clock_drift, -0.01, 0.01);
  o.seed = static_cast<std::uint64_t>(table.integer_or("seed", 1));
  return o;
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
  const long long baud = live.integer_or("baud", s.platform_line.baud);
  if (!(baud >= 1200 && baud <= 4'000'000)) live.fail("baud", fmt::format("is {}; takes 1200 to 4000000", baud));
  s.platform_line.baud = static_cast<int>(baud);
}

/// How orders are written, and whether they are answered.
void read_format(const StudyTable& live, LiveStudy& s) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kOrderFormats; ++i) names.emplace_back(name_of(static_cast<OrderFormatKind>(i)));
  const std::string name = live.choice_or("format", names, names.front());
  s.format.kind = static_cast<OrderFormatKind>(std::find(names.begin(), names.end(), name) - names.begin());
  const bool own = s.format.kind == OrderFormatKind::kVeridyn;
  s.options.answers = live.flag_or("answers", s.options.answers);
  if (!own && s.options.answers)
    live.fail("answers", fmt::format("must be false: a platform of format '{}' does not answer orders", name));
  if (live.has("text")) {
    if (s.format.kind != OrderFormatKind::kFlypt) live.fail("text", fmt::format("is of 'flypt'; format is '{}'", name));
    s.format.text = live.text("text");
  }
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
  static_cast<void>(read_virtual_vehicle(live));  // refused here too where it is wrong
  if (live.has("circuit")) {
    const StudyTable table = live.table("circuit");
    s.circuit = vehicle::read_circuit(table, s.cueing.seed);
    s.circuit_drive = read_circuit_drive(table);
  }
  if (live.text("telemetry") == "car") {
    s.car = read_car(live);
    s.driver = read_driver(live, s.car->range);
    if (live.has("camera")) {
      const StudyTable camera = live.table("camera");
      s.camera = CameraStudy{parse_address(camera.text("address"), camera.place("address"))};
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
  if (live.has("page")) s.page = parse_address(live.text("page"), live.place("page"));
  if (live.has("page_token")) s.page_token = live.file("page_token");
  s.page_rate = number_within(live, "page_rate", "Hz", s.page_rate, 1.0, 60.0);
  s.layouts = read_layouts(live);
  RigOptions& o = s.options;
  o.rate = number_within(live, "rate", "Hz", o.rate, 20.0, 4000.0);
  read_format(live, s);
  o.even.delay = number_within(live, "delay", "s", o.even.delay, 0.0, 0.5);
  o.even.extrapolate = number_within(live, "extrapolate", "s", o.even.extrapolate, 0.0, 0.2);
  o.soft_start = number_within(live, "soft_start", "s", o.soft_start, 0.5, 60.0);
  o.hold = number_within(live, "hold", "s", o.hold, 0.0, 10.0);
  o.fade = number_within(live, "fade", "s", o.fade, 0.5, 60.0);
  o.lost_after = number_within(live, "lost_after", "s", o.lost_after, 0.05, 5.0);
  o.frozen_after = number_within(live, "frozen_after", "s", o.frozen_after, 0.1, 60.0);
  o.unanswered_after = number_within(live, "unanswered_after", "s", o.unanswered_after, 0.02, 5.0);
  o.intake.stale_after = number_within(live, "stale_after", "s", o.intake.stale_after, 0.01, 5.0);
  o.spikes = number_within(live, "spikes", "m/s^3", o.spikes, 50.0, 1e6);
  const std::vector<std::string> checks = {"before", "while", "off"};
  const std::string signs = live.choice_or("signs", checks, "before");
  o.signs = signs == "before" ? SignCheck::kBefore : signs == "while" ? SignCheck::kWhile : SignCheck::kOff;
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
