// veridyn rig vehicle|platform STUDY: the virtual rig, so that anyone can run all of a live rig at home.
#include <fmt/format.h>

#include "apps/veridyn/live/rig_camera.hpp"
#include "apps/veridyn/live/rig_car.hpp"
#include "apps/veridyn/live/rig_test.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/live/rig/live_study.hpp"
#include "veridyn/live/virtual/virtual_platform.hpp"
#ifdef VERIDYN_HAS_SOCKETS
#include "veridyn/live/link/udp_socket.hpp"
#include "veridyn/live/threads/timely_thread.hpp"
#endif

namespace veridyn::app {
namespace {

using namespace veridyn::live;

#ifdef VERIDYN_HAS_SOCKETS

/// Until Ctrl-C or --seconds.
class UntilOver {
 public:
  UntilOver(const Arguments& arguments, Nanoseconds start)
      : interruption_(arguments.common.interruption),
        end_(arguments.number("--seconds") > 0.0 ? start + nanoseconds(arguments.number("--seconds")) : 0) {}
  [[nodiscard]] bool over(Nanoseconds now) const { return interruption_.requested() || (end_ != 0 && now >= end_); }

 private:
  Interruption interruption_;
  Nanoseconds end_;
};

/// The virtual platform reads the project's own packet only.
void refuse_others_platform(const LiveStudy& study) {
  if (study.format.kind != OrderFormatKind::kVeridyn)
    throw InputError("live.format", fmt::format("= '{}' is not read by the virtual platform; 'veridyn' is",
                                                name_of(study.format.kind)));
}

int rig_platform(const Arguments& arguments) {
  const CommonOptions& options = arguments.common;
  const Study file = Study::load(arguments.text("STUDY"), options.overrides);
  const LiveStudy study = read_live_study(file);
  file.root().finish();
  refuse_others_platform(study);
  ignore_broken_pipes();
  UdpSocket socket(study.platform, "live.platform");
  VirtualPlatform platform(study.cueing.platform);
  RealClock clock;
  const UntilOver until(arguments, clock.now());
  print_line(options,
             fmt::format("platform {} takes orders at {}", study.cueing.platform.name, to_string(study.platform)));
  static_cast<void>(make_thread_timely());  // a device does not wait for other work on the machine
  std::string commander;
  std::uint64_t refused = 0;
  while (!until.over(clock.now())) {
    constexpr Nanoseconds kStep = 5 * kMillisecond;
    socket.wait(clock.now() + kStep);
    while (const auto datagram = socket.receive()) {
      if (const auto answer = platform.take(*datagram)) {
        const AnswerBytes bytes = encode(*answer);
        socket.send_to(datagram->sender, {bytes.data(), bytes.size()});
      }
      platform.step(clock.now());
    }
    platform.step(clock.now());
    if (platform.commander() != commander) {
      commander = platform.commander();
      print_line(options, fmt::format("{} commands the platform", commander));
    }
    if (platform.counts().refused > refused && refused == 0)
      print_line(options,
                 fmt::format("orders of {} are refused: {} commands the platform", platform.last_refused(), commander));
    refused = platform.counts().refused;
  }
  const VirtualPlatform::Counts& c = platform.counts();
  Summary summary;
  summary["orders_followed"] = c.followed;
  summary["orders_outside_limits"] = c.outside;
  summary["jumps"] = c.jumps;
  summary["orders_beyond_acceleration"] = c.too_hard;
  summary["orders_of_others_refused"] = c.refused;
  summary["orders_old"] = c.old;
  summary["unreadable"] = c.unreadable;
  summary["silences"] = c.silences;
  print_summary(summary, options);
  print_line(
      options,
      fmt::format("{} orders followed, {} beyond limits, {} jumps, {} beyond its acceleration, {} of other programs "
                  "refused, {} unreadable",
                  c.followed, c.outside, c.jumps, c.too_hard, c.refused, c.unreadable));
  return c.outside + c.jumps + c.too_hard > 0 ? kFailed : kDone;
}

/// The vehicle of a study and what it is called: on the circuit, or on the study's drive.
std::pair<std::string, VirtualVehicle> driven_vehicle(const Study& file, const LiveStudy& study,
                                                      const CommonOptions& options) {
  const VirtualVehicleOptions sending =
      virtual_vehicle_keys().read(file.root().table("live").table_or_empty("vehicle"));
  if (study.circuit) {
    const auto car = vehicle::read_vehicle(file.root().table("subject"), vehicle::VehicleNeeds::kFourWheel);
    return {car.name + " on the circuit",
            VirtualVehicle(circuit_drive(car, study.circuit, study.circuit_drive, study.options.sensor), sending)};
  }
  TerminalProgress progress = progress_of(options);
  cueing::CueingStudy drive = cueing::read_study(file, progress);
  if (progress.interrupted()) throw Interrupted();
  file.root().finish();
  if (drive.vehicle.size() < 2)
    throw InputError(file.name(), "the drive has fewer than two samples: nothing can be sent of it");
  // Packets say what happens where the sensor is.
  for (recording::MotionSample& s : drive.vehicle) s = recording::at_place(s, drive.motion.place);
  return {drive.drive, VirtualVehicle(std::move(drive.vehicle), sending)};
}

int rig_vehicle(const Arguments& arguments) {
  const CommonOptions& options = arguments.common;
  const Study file = Study::load(arguments.text("STUDY"), options.overrides);
  const LiveStudy study = read_live_study(file);
  file.root().finish();  // before the drive is read, which takes [live] as it is
  ignore_broken_pipes();
  auto [name, vehicle] = driven_vehicle(file, study, options);
  UdpSocket socket = UdpSocket::connected(study.telemetry, "live.telemetry");
  RealClock clock;
  const Nanoseconds start = clock.now();
  const UntilOver until(arguments, start);
  print_line(options, fmt::format("{} drives, packets to {}", name, to_string(study.telemetry)));
  static_cast<void>(make_thread_timely());  // a vehicle does not wait for other work on the machine
  std::uint64_t not_sent = 0;
  while (!until.over(clock.now())) {
    clock.sleep_until(start + vehicle.due());
    if (const auto packet = vehicle.next(); packet && !socket.send(*packet)) ++not_sent;
  }
  Summary summary;
  summary["packets_sent"] = vehicle.sent() - not_sent;
  summary["packets_lost_on_purpose"] = vehicle.lost();
  print_summary(summary, options);
  print_line(options, fmt::format("{} packets sent", vehicle.sent() - not_sent));
  return kDone;
}

#else

int rig_platform(const Arguments&) {
  throw InputError("rig", "this program was built without sockets (see VERIDYN_SOCKETS)");
}

int rig_vehicle(const Arguments& arguments) { return rig_platform(arguments); }

#endif

}  // namespace

Command rig_command() {
  const std::vector<Argument> arguments = {
      {.name = "STUDY", .help = "study file with [live]", .required = true},
      {.name = "--seconds", .help = "end after this time; 0: with Ctrl-C", .value = 0.0}};
  return {
      .name = "rig",
      .summary = "the virtual rig: a vehicle that sends telemetry, a platform that follows orders",
      .commands = {
          {.name = "vehicle",
           .summary = "drives the study's drive again and again and sends it as packets",
           .arguments = arguments,
           .example = "veridyn rig vehicle examples/studies/cueing/live.toml",
           .run = rig_vehicle},
          {.name = "platform",
           .summary = "follows orders as the study's platform would, answers them and counts what is beyond its limits",
           .arguments = arguments,
           .example = "veridyn rig platform examples/studies/cueing/live.toml",
           .run = rig_platform},
          rig_test_command(),
          rig_car_command(),
          rig_camera_command(),
          rig_wheel_command()}};
}

}  // namespace veridyn::app
