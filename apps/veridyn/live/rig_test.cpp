// veridyn rig test STUDY: a platform commanded by hand (home, zero, pose, force, min, max, wave, steps, sweep), and how
// it follows.
#include "apps/veridyn/live/rig_test.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <random>

#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/cueing/platform/platform_file.hpp"
#include "veridyn/cueing/platform/platform_guard.hpp"
#include "veridyn/live/platform/platform_packet.hpp"
#include "veridyn/live/platform/platform_response.hpp"
#include "veridyn/live/platform/test_signal.hpp"
#include "veridyn/live/rig/live_study.hpp"
#include "veridyn/live/time/fixed_rate.hpp"
#ifdef VERIDYN_HAS_SOCKETS
#include "veridyn/live/link/udp_socket.hpp"
#include "veridyn/live/threads/timely_thread.hpp"
#endif

namespace veridyn::app {
namespace {

using namespace veridyn::live;
using cueing::PlatformAxis;

std::vector<std::string> signal_names() {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < kTestSignals; ++i) names.emplace_back(name_of(static_cast<TestSignal>(i)));
  return names;
}

#ifdef VERIDYN_HAS_SOCKETS

/// Tells a platform where to be, through the guard, and keeps what it answers.
class PlatformByHand {
 public:
  explicit PlatformByHand(const LiveStudy& study)
      : limits_(study.cueing.platform.limits),
        guard_(study.cueing.platform.limits),
        format_(study.format, study.cueing.platform),
        session_(static_cast<std::uint32_t>(std::random_device()())),
        rate_(clock_.now(), nanoseconds(1.0 / study.options.rate)) {
    if (study.platform_line.device.empty())
      socket_ = UdpSocket::connected(study.platform, "live.platform");
    else
      line_.emplace(study.platform_line);
  }

  /// One order at its time. @return where the axis was commanded to be
  double command(PlatformAxis axis, double desired) {
    clock_.sleep_until(rate_.next());
    cueing::PlatformState to;
    set_axis(to, axis, {.position = desired, .rate = 0.0, .acceleration = 0.0});
    PlatformOrder order;
    order.session = session_;
    order.sequence = ++sequence_;
    order.time = rate_.next();
    order.state = RigState::kRunning;
    order.motion = guard_.step(to, begun_ ? seconds(rate_.next() - last_) : 0.0);
    begun_ = true;
    last_ = rate_.next();
    const std::string_view bytes = format_.encode(order);
    if (line_) {
      line_->write({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    } else {
      socket_->send(bytes);
      take_answers();
    }
    rate_.advance(clock_.now());
    return cueing::axis(order.motion, axis).position;
  }

  [[nodiscard]] std::uint32_t sequence() const { return sequence_; }
  [[nodiscard]] std::size_t answers() const { return answers_.size(); }
  /// The axis's position when an order came in; nothing where it was not answered.
  [[nodiscard]] std::optional<double> reached(std::uint32_t sequence, PlatformAxis axis) const {
    const auto at = answers_.find(sequence);
    if (at == answers_.end()) return std::nullopt;
    return static_cast<double>(at->second[axis]);
  }

 private:
  void take_answers() {
    while (const auto datagram = socket_->receive()) {
      const auto answer = decode_answer(datagram->bytes);
      if (!answer || answer->session != session_) continue;
      if (answer->verdict == PlatformVerdict::kCommandedByAnother)
        throw InputError("live.platform",
                         answer->commander.port == 0
                             ? "another program commands the platform"
                             : "the program at " + to_string(answer->commander) + " commands the platform");
      answers_[answer->sequence] = answer->reached;
    }
  }

  cueing::PlatformLimits limits_;
  cueing::PlatformGuard guard_;
  OrderFormat format_;
  std::optional<UdpSocket> socket_;
  std::optional<SerialLine> line_;
  RealClock clock_;
  std::uint32_t session_, sequence_ = 0;
  FixedRate rate_;
  Nanoseconds last_ = 0;
  bool begun_ = false;
  std::map<std::uint32_t, cueing::PerPlatformAxis<float>> answers_;
};

/// One axis under one signal, then home. Answers that are missing are the last ones.
ToldAndReached play(PlatformByHand& platform, PlatformAxis axis, const TestSignalOptions& signal,
                    const LiveStudy& study, double duration, const Interruption& interruption) {
  static_cast<void>(make_thread_timely());  // what is late of an order would be taken for the platform's
  ToldAndReached motion;
  motion.step = 1.0 / study.options.rate;
  const std::uint32_t first = platform.sequence() + 1;
  const auto steps = static_cast<long>(duration * study.options.rate);
  const cueing::AxisLimits& limits = study.cueing.platform.limits[axis];
  for (long k = 0; k < steps && !interruption.requested(); ++k)
    motion.ordered.push_back(
        platform.command(axis, wanted_position(signal, limits, static_cast<double>(k) * motion.step)));
  constexpr double kHomeWithin = 3.0;  // [s]
  for (long k = 0; k < static_cast<long>(kHomeWithin * study.options.rate); ++k) platform.command(axis, 0.0);
  double last = 0.0;
  for (std::size_t k = 0; k < motion.ordered.size(); ++k) {
    last = platform.reached(first + static_cast<std::uint32_t>(k), axis).value_or(last);
    motion.reached.push_back(last);
  }
  return motion;
}

/// Where pose or force take an axis, from "5 deg", "20 mm", "1.5 m/s^2"; 0 of other signals.
double position_asked_for(const std::string& text, TestSignal signal, PlatformAxis axis,
                          const cueing::AxisLimits& limits) {
  const bool force = signal == TestSignal::kForce;
  if (signal != TestSignal::kPose && !force) {
    if (!text.empty()) throw InputError("--value", "is of `--signal pose` and `force` only");
    return 0.0;
  }
  const char* const si = force ? "m/s^2" : turns(axis) ? "rad" : "m";
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || !std::isfinite(number))
    throw InputError("--value", fmt::format("= '{}' is no number with a unit (5deg, 20mm, 1.5m/s^2)", text));
  std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  double value = number;
  try {
    if (!unit.empty()) value = parse_unit_like(unit, parse_unit(si)).to_si(number);
  } catch (const InputError& wrong) {
    throw InputError("--value", fmt::format("= '{}' for {}: {}", text, name_of(axis), wrong.what()));
  }
  const double position = force ? tilt_of(axis, value) : value;
  if (force && !std::isfinite(position))
    throw InputError("--value", fmt::format("= '{}' of {}: a lasting force is a tilt: pitch or roll, below gravity",
                                            text, name_of(axis)));
  if (!(position >= limits.lowest && position <= limits.highest))
    throw InputError("--value",
                     fmt::format("= '{}' takes {} to {:.4g} {}; its range is {:.4g} to {:.4g}", text, name_of(axis),
                                 position, turns(axis) ? "rad" : "m", limits.lowest, limits.highest));
  return position;
}

/// The platform that was measured: each axis as it follows, and where it reaches less or more than commanded.
cueing::Platform measured_platform(const LiveStudy& study, const std::map<PlatformAxis, PlatformResponse>& responses) {
  cueing::Platform p = study.cueing.platform;
  for (const auto& [axis, r] : responses) {
    p.axis_actuators[axis] =
        cueing::ActuatorOptions{.omega = r.omega.value, .zeta = r.zeta.value, .delay = std::max(r.delay.value, 0.0)};
    const cueing::AxisLimits& l = p.limits[axis];
    if (std::abs(r.gain.value - 1.0) > 0.01 + 2.0 * r.gain.sigma)
      p.reach[axis] = {{l.lowest, l.highest}, {r.gain.value * l.lowest, r.gain.value * l.highest}};
  }
  return p;
}

int rig_test(const Arguments& arguments) {
  const CommonOptions& options = arguments.common;
  const std::string path = arguments.text("STUDY");
  const StudyRun run = parse_study("rig", path, read_file(path), arguments);
  const LiveStudy study = read_live_study(run.study);
  run.study.root().finish();
  TestSignalOptions signal;
  const std::vector<std::string> signals = signal_names();
  signal.signal =
      static_cast<TestSignal>(std::find(signals.begin(), signals.end(), arguments.text("--signal")) - signals.begin());
  signal.size = arguments.number("--size");
  if (!(signal.size <= 1.0))
    throw InputError("--size", fmt::format("is {:g}; takes up to 1, the whole range", signal.size));
  signal.frequency = arguments.number("--frequency");
  signal.duration = arguments.number("--seconds");
  std::vector<PlatformAxis> axes;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < cueing::kPlatformAxes; ++i) {
    const auto axis = static_cast<PlatformAxis>(i);
    if (!study.cueing.platform.limits[axis].moves()) continue;
    names.emplace_back(name_of(axis));
    if (arguments.text("--axis") == "all" || arguments.text("--axis") == name_of(axis)) axes.push_back(axis);
  }
  if (axes.empty())
    throw InputError("--axis", fmt::format("'{}' is no axis of this platform (all, {})", arguments.text("--axis"),
                                           fmt::join(names, ", ")));
  for (const PlatformAxis axis : axes)
    signal.position =
        position_asked_for(arguments.text("--value"), signal.signal, axis, study.cueing.platform.limits[axis]);
  ignore_broken_pipes();
  OutputFolder folder(options.out);
  PlatformByHand platform(study);
  std::string csv = "axis,time[s],ordered[m or rad],reached[m or rad]\n";
  std::map<PlatformAxis, PlatformResponse> responses;
  for (const PlatformAxis axis : axes) {
    print_line(options, fmt::format("{}: {}, {:g} s", name_of(axis), name_of(signal.signal), signal.duration));
    const ToldAndReached motion = play(platform, axis, signal, study, signal.duration, options.interruption);
    if (options.interruption.requested()) throw Interrupted();
    if (platform.answers() == 0 && study.options.answers)
      throw InputError("live.platform", fmt::format("{} does not answer", platform_name(study)));
    for (std::size_t k = 0; k < motion.ordered.size(); ++k)
      csv += fmt::format("{},{:.5g},{:.7g},{:.7g}\n", name_of(axis), static_cast<double>(k) * motion.step,
                         motion.ordered[k], motion.reached[k]);
    if (signal.signal != TestSignal::kSweep || !study.options.answers) continue;
    const PlatformResponse& r = responses[axis] = fit_response(motion);
    print_line(
        options,
        fmt::format("{}: gain {:.3f} +- {:.3f}, omega {:.1f} +- {:.1f} rad/s, zeta {:.2f} +- {:.2f}, delay {:.1f} "
                    "+- {:.1f} ms, {:.1f} % not explained",
                    name_of(axis), r.gain.value, r.gain.sigma, r.omega.value, r.omega.sigma, r.zeta.value, r.zeta.sigma,
                    1e3 * r.delay.value, 1e3 * r.delay.sigma, 100.0 * r.rms));
    for (const std::string& note : r.notes) print_line(options, fmt::format("{}: {}", name_of(axis), note));
  }
  folder.write("ordered_and_reached.csv", csv);
  Summary summary;
  summary["folder"] = folder.path().string();
  for (const auto& [axis, r] : responses) {
    Summary& s = summary["axes"][std::string(name_of(axis))];
    for (const auto& [name, value] : {std::pair("gain", r.gain), std::pair("omega_rad_s", r.omega),
                                      std::pair("zeta", r.zeta), std::pair("delay_s", r.delay)})
      s[name] = Summary::object({{"value", value.value}, {"sigma", value.sigma}});
    s["not_explained"] = r.rms;
    s["notes"] = r.notes;
  }
  if (!responses.empty())
    folder.write("platform.toml", cueing::platform_file(measured_platform(study, responses),
                                                        "Measured by `veridyn rig test`; delays hold the way there and "
                                                        "back. In a study: [platform] file = \"platform.toml\""));
  const std::string files = fmt::format("{}", fmt::join(folder.files(), ", "));
  folder.publish(run.record(0, study.cueing.inputs), options, summary);
  print_line(options, fmt::format("wrote {} in {}", files, folder.path().string()));
  return kDone;
}

#else

int rig_test(const Arguments&) {
  throw InputError("rig", "this program was built without sockets (see VERIDYN_SOCKETS)");
}

#endif

}  // namespace

Command rig_test_command() {
  return {
      .name = "test",
      .summary = "tells the platform where to be, axis by axis; a sweep measures how it follows, for `[platform]`",
      .arguments =
          {{.name = "STUDY", .help = "study file with [live]", .required = true},
           {.name = "--axis", .help = "of the platform; all: one after the other", .value = std::string("all")},
           {.name = "--signal", .help = "what is commanded", .value = std::string("sweep"), .choices = signal_names()},
           {.name = "--value", .help = "of pose (5deg, 20mm) or force (1.5m/s^2)", .value = std::string("")},
           {.name = "--size", .help = "share of what the limits allow", .value = 0.5, .positive = true},
           {.name = "--frequency", .help = "of wave and steps [Hz]", .value = 0.5, .positive = true},
           {.name = "--seconds", .help = "for each axis", .value = 30.0, .positive = true}},
      .default_out = "out/rig",
      .example = "veridyn rig test examples/studies/cueing/live.toml --axis pitch",
      .run = rig_test};
}

}  // namespace veridyn::app
