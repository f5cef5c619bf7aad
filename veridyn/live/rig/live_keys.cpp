// The keys of `[live]` and the tables in it.
#include <limits>

#include "veridyn/io/packets/packet_layout.hpp"
#include "veridyn/live/rig/live_study.hpp"

namespace veridyn::live {
namespace {

const KeyTable<RigOptions>& rig_keys() {
  using O = RigOptions;
  const auto delay = [](O& o) -> double& { return o.even.delay; };
  const auto extrapolate = [](O& o) -> double& { return o.even.extrapolate; };
  const auto stale_after = [](O& o) -> double& { return o.intake.stale_after; };
  static const auto table =
      KeyTable<O>("live")
          .flag("answers", &O::answers, "whether the platform answers orders; formats of others have no answers")
          .number("rate", &O::rate, "Hz", from_to(20.0, 4000.0), "of orders: a packet waits up to a period")
          .number("delay", delay, "s", from_to(0.0, 0.5), "of the motion, so that packets may come late")
          .number("extrapolate", extrapolate, "s", from_to(0.0, 0.2),
                  "how far the motion goes on in a straight line where they come later still")
          .number("spikes", &O::spikes, "m/s^3", from_to(50.0, 1e6),
                  "largest change of a specific force: crashes and landings are kept off the platform")
          .number("soft_start", &O::soft_start, "s", from_to(0.5, 60.0), "until the platform follows the whole motion")
          .number("hold", &O::hold, "s", from_to(0.0, 10.0), "the last order stands when telemetry is lost")
          .number("fade", &O::fade, "s", from_to(0.5, 60.0), "time in which the platform moves to park")
          .number("lost_after", &O::lost_after, "s", from_to(0.05, 5.0),
                  "telemetry counts as lost after this long without an accepted packet")
          .number("frozen_after", &O::frozen_after, "s", from_to(0.1, 60.0),
                  "telemetry counts as frozen after this long of unchanged motion while the vehicle moves")
          .number("stale_after", stale_after, "s", from_to(0.01, 5.0),
                  "a packet later than the quickest ones by this much is stale")
          .number("unanswered_after", &O::unanswered_after, "s", from_to(0.02, 5.0),
                  "without an answer of the platform")
          .choice("signs", &O::signs,
                  {{"before", SignCheck::kBefore}, {"while", SignCheck::kWhile}, {"off", SignCheck::kOff}},
                  "when signs, axes and units are checked: before the platform moves, while it does, not at all");
  return table;
}

}  // namespace

const KeyTable<LiveStudy>& LiveStudy::keys() {
  using S = LiveStudy;
  std::vector<std::pair<std::string, OrderFormatKind>> formats;
  for (std::size_t i = 0; i < kOrderFormats; ++i)
    formats.emplace_back(name_of(static_cast<OrderFormatKind>(i)), static_cast<OrderFormatKind>(i));
  const auto baud = [](S& s) -> int& { return s.platform_line.baud; };
  const auto format = [](S& s) -> OrderFormatKind& { return s.format.kind; };
  const auto text = [](S& s) -> std::string& { return s.format.text; };
  static const auto table =
      KeyTable<S>("live", "Where motion comes from and goes to.")
          .elsewhere({"telemetry", "", "an address, `\"car\"`", "",
                      "where packets are listened to, `0.0.0.0:4123`: from other machines too; `car`: reports of the "
                      "car of `[live.car]`, driven by `[live.driver]`"})
          .required()
          .elsewhere({"packet", "", "", "`\"any\"`",
                      "which packets: recognised by content, a name of formats.md, or a table `[live.packet]`", true})
          .within("packet", io::packet_layout_keys(), [](const StudyTable&, S&) {})
          .elsewhere({"stop", "", "an address", "none",
                      "with a car: where datagrams `VSTOP1`, emergency stops, are listened to", true})
          .elsewhere({"platform", "", "an address, a device", "",
                      "where orders go; a device is a serial line, `/dev/ttyUSB0`"})
          .required()
          .count("baud", baud, 1200, 4'000'000, "of the serial line [bit/s]")
          .choice("format", format, formats, "how orders are written")
          .text("text", text, "of `flypt`: `{axis}`, `{axis:unit}` or `{axis:unit:.3f}`")
          .otherwise("`P={pitch:deg:.3f},R={roll:deg:.3f},H={heave:mm:.2f}\\n`")
          .with(&S::options, rig_keys())
          .other({"page", "", "an address", "none", "where the run is shown in a browser", true},
                 [](const StudyTable& t, const std::string& key, S& s) {
                   s.page = parse_address(t.text(key), t.place(key));
                 })
          .file("page_token", &S::page_token,
                "file with the token that controls on the page require; needed beyond loopback, drawn at random "
                "otherwise")
          .number("page_rate", &S::page_rate, "Hz", from_to(1.0, 60.0), "how often the page moves");
  return table;
}

const KeyTable<CameraStudy>& CameraStudy::keys() {
  static const auto table = KeyTable<CameraStudy>("live.camera", "A camera above the track of `telemetry = \"car\"`.")
                                .other({"address", "", "an address", "", "of `veridyn camera track --serve`"},
                                       [](const StudyTable& t, const std::string& key, CameraStudy& c) {
                                         c.address = parse_address(t.text(key), t.place(key));
                                       })
                                .required();
  return table;
}

const KeyTable<VirtualVehicleOptions>& virtual_vehicle_keys() {
  using O = VirtualVehicleOptions;
  static const auto table =
      KeyTable<O>("live.vehicle", "How the virtual vehicle sends its telemetry.")
          .number("rate", &O::rate, "Hz", from_to(1.0, 4000.0), "of packets")
          .number("jitter", &O::jitter, "s", from_to(0.0, 1.0), "packets are sent late by a random time up to this")
          .number("loss", &O::loss, "1", from_to(0.0, 0.99), "share of packets that are not sent")
          .number("clock_drift", &O::clock_drift, "1", from_to(-0.01, 0.01), "its clock runs fast by this share")
          .count("seed", &O::seed, 0, std::numeric_limits<long long>::max(), "of jitter and loss");
  return table;
}

std::vector<StudyKeys> study_keys() {
  return all_of(LiveStudy::keys(), virtual_vehicle_keys(), CircuitDriveOptions::keys(), CarStudy::keys(),
                DriverStudy::keys(), CameraStudy::keys());
}

}  // namespace veridyn::live
