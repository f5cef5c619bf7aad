// veridyn rig car STUDY: a scaled car without hardware, so that anyone can run all of teleoperation at home.
#include "apps/veridyn/live/rig_car.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <time.h>

#include <cmath>
#include <random>

#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/live/rig/live_study.hpp"
#include "veridyn/live/serial/pseudo_terminal.hpp"
#include "veridyn/live/serial/serial_line.hpp"
#include "veridyn/live/virtual/motion_packet.hpp"
#include "veridyn/live/virtual/noisy_line.hpp"
#include "veridyn/live/virtual/virtual_car.hpp"
#ifdef VERIDYN_HAS_SOCKETS
#include "veridyn/live/link/udp_socket.hpp"
#include "veridyn/live/threads/timely_thread.hpp"
#endif

namespace veridyn::app {
namespace {

using namespace veridyn::live;

#ifdef VERIDYN_HAS_SOCKETS

/// A serial device, or a pseudo-terminal of that name where there is none.
class CarLine {
 public:
  CarLine(const std::filesystem::path& path, int baud) {
    std::error_code error;
    const bool link = std::filesystem::is_symlink(path, error);
    const bool to_terminal = link && std::filesystem::read_symlink(path, error).string().starts_with("/dev/pts/");
    if (std::filesystem::exists(path, error) && !to_terminal) {
      device_.emplace(SerialOptions{.device = path, .baud = baud});
    } else {
      terminal_ = std::make_unique<PseudoTerminal>(path);
    }
  }
  std::size_t read(std::span<std::uint8_t> out) { return terminal_ ? terminal_->read_some(out) : device_->read(out); }
  void write(Bytes bytes) {
    // What does not fit is lost, as on any line that nobody reads.
    if (terminal_) {
      terminal_->write(bytes);
    } else {
      device_->write(bytes);
    }
  }
  [[nodiscard]] bool hung_up() const { return device_ && device_->hung_up(); }
  [[nodiscard]] bool is_terminal() const { return terminal_ != nullptr; }
  /// Waits for bytes, or until then; while the other end is not open, only for the time.
  void wait(Nanoseconds at_most) const {
    const bool watched = terminal_ ? terminal_->is_open() : !device_->hung_up();
    pollfd one{watched ? (terminal_ ? terminal_->descriptor() : device_->descriptor()) : -1, POLLIN, 0};
    const timespec timeout{at_most / kSecond, at_most % kSecond};
    ::ppoll(&one, 1, &timeout, nullptr);
  }

 private:
  std::optional<SerialLine> device_;
  std::unique_ptr<PseudoTerminal> terminal_;
};

/// Sends the true motion.
class TruthSender {
 public:
  explicit TruthSender(const std::optional<Sender>& to) {
    if (to) socket_.emplace(UdpSocket::connected(*to, "live.car.truth"));
  }
  void send(const VirtualCar& car, Nanoseconds now) {
    if (!socket_) return;
    const recording::MotionSample m = car.motion();
    const vehicle::WorldMotion at = car.world();
    std::array<char, kMotionPacketBytes> packet{};
    encode_motion({.sequence = sequence_++,
                   .time = seconds(now),
                   .position = at.position,
                   .velocity = at.velocity,
                   .force = m.force,
                   .rate = m.rate,
                   .attitude = m.attitude},
                  packet);
    socket_->send({packet.data(), packet.size()});
  }

 private:
  std::optional<UdpSocket> socket_;
  std::uint32_t sequence_ = 0;
};

constexpr std::array<const char*, kCommandVerdicts> kVerdictNames = {
    "executed", "duplicate", "late", "unproven", "stale", "of_another_run", "out_of_range", "no_command"};

Summary summary_of(const VirtualCar& car) {
  Summary s;
  for (std::size_t i = 0; i < kCommandVerdicts; ++i)
    s["commands"][kVerdictNames[i]] = car.end().verdicts()[static_cast<CommandVerdict>(i)];
  s["frames_damaged"] = car.end().frames().damaged();
  s["links_lost"] = car.end().links_lost();
  s["speed"] = car.state().vehicle(vehicle::kU);
  s["steps_refused"] = car.state().refused;
  return s;
}

/// Says what the car does, once for each change.
void say_state(const CommonOptions& options, const VirtualCar& car, CarState& said, double time) {
  constexpr std::array<const char*, kCarStates> kStateNames = {"holding", "driving", "braking: the link is lost"};
  if (car.actuation().state == said) return;
  said = car.actuation().state;
  print_line(options, fmt::format("{:8.2f} s  {}", time, kStateNames[static_cast<std::size_t>(said)]));
}

int rig_car(const Arguments& arguments) {
  const CommonOptions& options = arguments.common;
  const std::string path = arguments.text("STUDY");
  const StudyRun run = parse_study("rig", path, read_file(path), arguments);
  const LiveStudy study = read_live_study(run.study);
  const StudyTable& root = run.study.root();
  if (!study.car) root.table("live").fail("telemetry", "is not \"car\": this study's telemetry is not that of a car");
  const CarStudy& settings = *study.car;
  vehicle::Vehicle vehicle = vehicle::read_vehicle(root.table("subject"), vehicle::VehicleNeeds::kFourWheel);
  vehicle.longitudinal.wheel_radius = settings.radius;
  for (const std::string& warning : vehicle.warnings) print_line(options, "warning: " + warning);
  OutputFolder folder(options.out);
  VirtualCar car(vehicle, virtual_car_options(settings, study.cueing.seed),
                 static_cast<std::uint16_t>(std::random_device()() & 0xffffU), study.circuit);
  NoisyLine to_car(settings.flips, study.cueing.seed, settings.baud),
      to_operator(settings.flips, study.cueing.seed + 1, settings.baud);
  TruthSender sender(settings.truth);
  CarTruth truth;
  CarLine line(settings.line, settings.baud);
  print_line(options, fmt::format("car {} waits at {}{}", vehicle.name, settings.line.string(),
                                  line.is_terminal() ? ", a pseudo-terminal" : ""));
  static_cast<void>(make_thread_timely());  // a car does not wait for other work on the machine
  RealClock clock;
  const Nanoseconds start = clock.now();
  const double length = arguments.number("--seconds");
  const Nanoseconds period = nanoseconds(1.0 / settings.report_rate);
  Nanoseconds next_report = start, next_truth = start;
  CarState said = CarState::kHolding;
  std::array<std::uint8_t, 4096> chunk{};
  std::array<std::uint8_t, kLongestFrame> frame{};
  for (Nanoseconds now = start; !options.interruption.requested() && !line.hung_up();) {
    if (length > 0.0 && seconds(now - start) >= length) break;
    constexpr Nanoseconds kLongestWait = 2 * kMillisecond;
    Nanoseconds wake = std::min(next_report, now + kLongestWait);
    for (const NoisyLine* one : {&to_car, &to_operator}) wake = std::min(wake, one->last_arrival().value_or(wake));
    line.wait(std::max<Nanoseconds>(wake - now, 0));
    now = clock.now();
    to_car.send(Bytes(chunk).first(line.read(chunk)), now);
    car.advance(now);
    car.receive(to_car.arrived(now), now);
    if (now >= next_report) {
      to_operator.send(Bytes(frame).first(car.report(now, frame)), now);
      next_report = std::max(next_report + period, now - period);
    }
    if (now >= next_truth) {
      truth.add(now, car);
      sender.send(car, now);
      next_truth = std::max(next_truth + kSecond / 100, now);
    }
    line.write(to_operator.arrived(now));
    say_state(options, car, said, seconds(now - start));
  }
  folder.write("truth.csv", truth.csv());
  Summary summary = summary_of(car);
  summary["folder"] = folder.path().string();
  folder.publish(run.record(study.cueing.seed, vehicle.inputs), options, summary);
  print_line(options, fmt::format("{} commands executed, {} frames damaged, link lost {} times; wrote truth.csv in {}",
                                  car.end().verdicts()[CommandVerdict::kExecuted], car.end().frames().damaged(),
                                  car.end().links_lost(), folder.path().string()));
  return kDone;
}

#else

int rig_car(const Arguments&) {
  throw InputError("rig", "this program was built without sockets (see VERIDYN_SOCKETS)");
}

#endif

}  // namespace

Command rig_car_command() {
  return {.name = "car",
          .summary = "a scaled car at the end of a serial line: drives as it is commanded, reports, keeps the truth",
          .arguments = {{.name = "STUDY", .help = "study file with [live.car] and [subject]", .required = true},
                        {.name = "--seconds", .help = "end after this time; 0: with Ctrl-C", .value = 0.0}},
          .default_out = "out/car",
          .example = "veridyn rig car examples/live/car.toml",
          .run = rig_car};
}

}  // namespace veridyn::app
