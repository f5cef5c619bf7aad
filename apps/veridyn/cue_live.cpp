// veridyn cue --live and --replay: a platform that follows telemetry as it comes, and the same run again.
#include "apps/veridyn/cue_live.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <random>
#include <thread>

#include "apps/veridyn/console.hpp"
#include "apps/veridyn/live_drive.hpp"
#include "apps/veridyn/output_folder.hpp"
#include "apps/veridyn/version.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/live/rig/live_replay.hpp"
#include "veridyn/live/telemetry/sign_checker.hpp"
#include "veridyn/live/threads/timely_thread.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/live_report.hpp"
#ifdef VERIDYN_HAS_SOCKETS
#include "veridyn/live/link/udp_links.hpp"
#include "veridyn/live/rig/car_links.hpp"
#endif
#ifdef VERIDYN_HAS_PAGE
#include "veridyn/live/page/live_page.hpp"
#include "veridyn/live/page/page_token.hpp"
#include "veridyn/live/page/status_json.hpp"
#endif

namespace veridyn::app {
namespace {

using namespace veridyn::live;

std::string motion_csv(const LiveReplay& r) {
  const cueing::Platform& platform = r.study.cueing.platform;
  std::vector<cueing::PlatformAxis> axes;
  std::string text = "time[s],state,share,force_x[m/s^2],force_y[m/s^2],force_z[m/s^2]";
  for (std::size_t i = 0; i < cueing::kPlatformAxes; ++i) {
    if (platform.limits.axes[i].moves()) axes.push_back(static_cast<cueing::PlatformAxis>(i));
  }
  for (const cueing::PlatformAxis a : axes) text += fmt::format(",told_{}[{}]", name_of(a), turns(a) ? "rad" : "m");
  text += "\n";
  for (std::size_t k = 0; k < r.run.steps.size(); ++k) {
    const recording::MotionSample& v = r.run.vehicle[k];
    text += fmt::format("{:.4f},{},{:.4f},{:.5g},{:.5g},{:.5g}", v.time, name_of(r.states[k]), r.shares[k], v.force.x(),
                        v.force.y(), v.force.z());
    for (const cueing::PlatformAxis a : axes) text += fmt::format(",{:.6g}", axis(r.run.steps[k].told, a).position);
    text += "\n";
  }
  return text;
}

std::string packets_csv(const LiveReplay& r) {
  std::string text = "sender,packets,count\n";
  for (const PacketIntake::FromSender& s : r.senders) {
    for (std::size_t i = 0; i < kPacketFates; ++i)
      text += fmt::format("{},{},{}\n", to_string(s.sender), name_of(static_cast<PacketFate>(i)), s.counts[i]);
  }
  return text;
}

Summary summary_of(const OutputFolder& folder, const LiveReplay& r, const std::filesystem::path& recording) {
  Summary s;
  s["folder"] = folder.path().string();
  s["recording"] = recording.string();
  s["orders"] = r.times.steps;
  s["duration_s"] = r.duration;
  s["orders_outside_limits"] = r.outside;
  s["orders_different_when_replayed"] = r.different;
  s["fingerprint"] = r.orders_fingerprint;
  s["deadlines_left_out"] = r.times.left_out;
  s["pauses"] = r.gaps;
  for (const auto& [name, h] :
       {std::pair("receive_to_send_s", &r.times.receive_to_send), std::pair("jitter_s", &r.times.jitter)}) {
    s[name]["p50"] = h->quantile(0.5);
    s[name]["p99"] = h->quantile(0.99);
    s[name]["p9999"] = h->quantile(0.9999);
    s[name]["largest"] = h->count() > 0 ? seconds(h->largest()) : std::nan("");
  }
  if (r.car) {
    s["car"]["commands"] = r.car->commands;
    s["car"]["commands_different_when_replayed"] = r.car->commands_different;
    s["car"]["command_loss"] = r.car->quality.command_loss();
    s["car"]["reports"] = r.car->quality.reports_received;
    s["car"]["report_loss"] = r.car->quality.report_loss();
    s["car"]["pedal_to_command_p99_s"] = r.times.pedal_to_command.quantile(0.99);
  }
  for (std::size_t i = 0; i < kPacketFates; ++i)
    s["packets"][std::string(name_of(static_cast<PacketFate>(i)))] = r.packets[i];
  s["states"] = Summary::array();
  for (const LiveReplay::Change& c : r.changes)
    s["states"].push_back(Summary::object({{"time_s", c.time}, {"state", std::string(name_of(c.to))}}));
  return s;
}

/// Score of a run in which the platform moved for long enough.
cueing::CueingResult scored(const LiveReplay& r) {
  constexpr double kShortest = 5.0;  // [s]
  cueing::CueingResult result;
  if (r.run.vehicle.size() < 100 || r.run.vehicle.back().time - r.run.vehicle.front().time < kShortest) return result;
  const auto design = r.study.cueing.algorithms.front().design->clone();
  result.algorithms.push_back(cueing::scored(r.study.cueing, r.run, *design));
  return result;
}

/// How the car was driven, in a line.
std::string car_line(const LiveReplay& r) {
  const LinkQuality& q = r.car->quality;
  return fmt::format(
      "car: {} commands, {:.1f} % lost, {} different when replayed; {} reports, {:.1f} % lost; pedal to command: 99 % "
      "within {:.2f} ms",
      r.car->commands, 100.0 * q.command_loss(), r.car->commands_different, q.reports_received, 100.0 * q.report_loss(),
      1e3 * r.times.pedal_to_command.quantile(0.99));
}

/// Replays a recording and writes all that is said of the run.
int report_run(const CommonOptions& options, const RunRecord& record, OutputFolder& folder,
               const std::filesystem::path& recording, const std::vector<std::string>& notes,
               const Interruption& interruption) {
  TerminalProgress progress(options.quiet, options.threads, interruption);
  LiveReplay r = replay(read_live_file(recording), recording.string(), progress);
  if (progress.interrupted()) throw Interrupted();
  progress.stage("scoring what was felt");
  const cueing::CueingResult score = scored(r);
  folder.write("platform.csv", motion_csv(r));
  folder.write("packets.csv", packets_csv(r));
  if (r.car) {
    folder.write("drive.csv", DriveTable::header() + r.car->drive.take_lines());
    folder.write("delays.toml", delays_toml(r));
  }
  folder.write("report.html", report::to_html(report::live_report(r, score, notes, program_name())));
  const std::string files = fmt::format("{}", fmt::join(folder.files(), ", "));
  folder.publish(record, options, summary_of(folder, r, recording));
  print_line(options, fmt::format("{} orders in {:.1f} s, {} beyond limits, {} different when replayed", r.times.steps,
                                  r.duration, r.outside, r.different));
  if (r.times.receive_to_send.count() > 0)
    print_line(options,
               fmt::format("packet's arrival to order: half within {:.2f} ms, 99 % within {:.2f} ms, longest {:.2f} ms",
                           1e3 * r.times.receive_to_send.quantile(0.5), 1e3 * r.times.receive_to_send.quantile(0.99),
                           1e3 * seconds(r.times.receive_to_send.largest())));
  if (r.car) print_line(options, car_line(r));
  print_line(options, fmt::format("wrote {} in {}", files, folder.path().string()));
  if (r.car && r.car->commands_different > 0) return kFailed;
  if (r.different > 0 || r.outside > 0 || r.answers.outside_limits > 0) return kFailed;
  return kDone;
}

#ifdef VERIDYN_HAS_SOCKETS

// A handler gets nothing but the number of its signal, so that what it stops is static.
std::atomic<LiveControl*> stopped_by_signal{nullptr};
extern "C" void stop_on_signal(int) {
  if (LiveControl* control = stopped_by_signal.load()) control->emergency();
}

/// Keys without Enter while it lives, where stdin is a terminal; letters from a pipe otherwise.
class Keys {
 public:
  Keys() {
    if (::tcgetattr(STDIN_FILENO, &before_) != 0) return;
    terminal_ = true;
    termios now = before_;
    now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    ::tcsetattr(STDIN_FILENO, TCSANOW, &now);
  }
  ~Keys() {
    if (terminal_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  Keys(const Keys&) = delete;
  Keys& operator=(const Keys&) = delete;
  /// The next key; 0 where there is none.
  char next() {
    pollfd one{STDIN_FILENO, POLLIN, 0};
    char key = 0;
    if (ended_ || ::poll(&one, 1, 0) <= 0) return 0;
    if (::read(STDIN_FILENO, &key, 1) <= 0) ended_ = true;
    return key;
  }

 private:
  termios before_{};
  bool terminal_ = false, ended_ = false;
};

/// What the operator is told, once for each change.
class Console {
 public:
  explicit Console(const CommonOptions& options) : options_(options) {}
  void show(const RigStatus& s, double time) {
    const std::string line = s.step.state == RigState::kRunning || s.readiness == Readiness::kReady
                                 ? std::string(name_of(s.step.state))
                                 : fmt::format("{}: {}", name_of(s.step.state), name_of(s.readiness));
    if (line == last_) return;
    last_ = line;
    print_line(options_, fmt::format("{:8.2f} s  {}", time, line));
  }
  void say(double time, const std::string& what) const {
    print_line(options_, fmt::format("{:8.2f} s  {}", time, what));
  }

 private:
  CommonOptions options_;
  std::string last_;
};

#ifdef VERIDYN_HAS_PAGE

/// The page of a run, and what is asked there.
class PageOfRun {
 public:
  PageOfRun(const LiveStudy& study, const CommonOptions& options)
      : design_(study.cueing.algorithms.front().design->clone()) {
    if (!study.page) return;
    const bool drawn = study.page_token.empty() && study.page->address >> 24U == 127;
    const std::string token = drawn                      ? random_token()
                              : study.page_token.empty() ? ""
                                                         : read_token_file(study.page_token);
    page_ = std::make_unique<LivePage>(PageOptions{*study.page, token});
    print_line(options, fmt::format("page: http://{}{}", to_string(*study.page), drawn ? "  token: " + token : ""));
  }

  /// Shows the newest status, 20 times a second, and does what was asked for.
  void update(const RigStatus& status, const LiveStudy& study, LiveControl& control, double time,
              const std::string& message) {
    if (!page_) return;
    if (time - shown_ >= 0.05) {
      shown_ = time;
      page_->show(status_json(status, study, *design_, time, page_->refused(), message));
    }
    for (const PageRequest& r : page_->take_requests()) {
      if (r.kind == PageRequest::Kind::kWish) {
        if (r.wish == OperatorWish::kEmergency)
          control.emergency();
        else
          control.wish(r.wish);
        continue;
      }
      std::vector<double> values = knob_values(*design_);
      if (r.kind == PageRequest::Kind::kUndo) {
        if (before_.empty()) continue;
        values = before_.back();
        before_.pop_back();
      } else {
        if (r.knob >= values.size()) continue;
        before_.push_back(values);
        values[r.knob] = r.value;
      }
      turn(values, study, control);
    }
  }

 private:
  /// Another algorithm with these numbers; those that it refuses are left.
  void turn(const std::vector<double>& values, const LiveStudy& study, LiveControl& control) {
    std::unique_ptr<cueing::WashoutDesign> design = design_->clone();
    set_knob_values(*design, values);
    try {
      auto setting = std::make_unique<KnobSetting>();
      setting->values = values;
      setting->washout = design->make(study.cueing.platform);
      control.turn(std::move(setting));
      design_ = std::move(design);
    } catch (const InputError&) {
      if (!before_.empty()) before_.pop_back();
    }
  }

  std::unique_ptr<cueing::WashoutDesign> design_;
  std::vector<std::vector<double>> before_;  ///< values of the knobs, the last ones last
  std::unique_ptr<LivePage> page_;
  double shown_ = -1.0;
};

#else

class PageOfRun {
 public:
  PageOfRun(const LiveStudy& study, const CommonOptions&) {
    if (study.page) throw InputError("live.page", "this program was built without the page (see VERIDYN_PAGE)");
  }
  void update(const RigStatus&, const LiveStudy&, LiveControl&, double, const std::string&) {}
};

#endif

/// The operator's side of a run: keys, signals, page, the check of the signs, and the end.
void supervise(const StudyRun& run, const LiveStudy& study, LiveControl& control, LiveRecorder& recorder,
               PageOfRun& page, RealClock& clock, Nanoseconds start, std::vector<std::string>& notes) {
  const CommonOptions& options = run.options();
  Keys keys;
  Console console(options);
  LiveDrive drive(study, options.out);
  SignChecker signs;
  std::vector<Telemetry> motions;
  std::vector<recording::MotionSample> samples;
  const double length = run.arguments.number("--seconds");
  bool ending = false, signs_done = study.options.signs == SignCheck::kOff, loss_said = false;
  Nanoseconds give_up = 0, next_check = start + kSecond;
  std::string signs_text;
  if (run.arguments.flag("--start")) control.wish(OperatorWish::kStart);
  while (true) {
    const Nanoseconds now = clock.now();
    const double time = seconds(now - start);
    const RigStatus& status = control.status();
    console.show(status, time);
    page.update(status, study, control, time, signs_text.empty() || signs_done ? "" : "still to drive: " + signs_text);
    control.tidy();
    motions.clear();
    control.take_motions(motions);
    drive.add(motions, time);
    for (const Telemetry& t : motions) {
      if (signs_done) break;
      if (t.restarted) {
        signs.reset();
        samples.clear();
      }
      samples.push_back(t.sample);
    }
    if (!signs_done && now >= next_check) {
      next_check = now + kSecond;
      signs.add(samples);
      samples.clear();
      const SignVerdict verdict = signs.check();
      if (verdict.kind != SignVerdict::Kind::kUnknown) {
        const bool right = verdict.kind == SignVerdict::Kind::kRight;
        control.wish(right ? OperatorWish::kSignsRight : OperatorWish::kSignsWrong);
        signs_done = true;
        console.say(time, right ? "signs, axes and units of the telemetry are right" : "wrong: " + verdict.text);
        if (!right) notes.push_back("the platform was kept parked: " + verdict.text);
      } else if (verdict.text != signs_text && status.packets[PacketFate::kAccepted] > 0) {
        signs_text = verdict.text;
        console.say(time, "signs are not yet checked; still to drive: " + verdict.text);
      }
    }
    if (!loss_said && recorder.lost() > 0) {
      loss_said = true;
      const std::string trouble = recorder.trouble();
      console.say(time, trouble.empty() ? "the recording is too slow for what comes in: it has gaps" : trouble);
      notes.push_back(trouble.empty() ? "the recording has gaps" : trouble);
    }
    switch (keys.next()) {
      case 's':
        control.wish(OperatorWish::kStart);
        break;
      case 'p':
        control.wish(OperatorWish::kPark);
        break;
      case ' ':
      case 'e':
        control.emergency();
        break;
      case 'r':
        control.wish(OperatorWish::kRelease);
        break;
      case 'q':
        ending = true;
        break;
      default:
        break;
    }
    const bool over = options.interruption.requested() || (length > 0.0 && time >= length);
    if ((over || ending) && give_up == 0) {
      control.wish(OperatorWish::kPark);
      give_up = now + nanoseconds(study.options.fade + 10.0);
    }
    if (give_up != 0 &&
        (status.step.state == RigState::kParked || status.step.state == RigState::kStopped || now > give_up))
      break;
    constexpr Nanoseconds kStuck = kSecond;
    if (status.times.steps > 0 && now - status.step.time > kStuck) console.say(time, "the loop stands still");
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  control.end();
}

#endif

}  // namespace

int cue_live(const StudyRun& run) {
#ifndef VERIDYN_HAS_SOCKETS
  throw InputError("--live", "this program was built without sockets (see VERIDYN_SOCKETS)");
#else
  OutputFolder folder(run.options().out);
  const LiveStudy study = read_live_study(run.study);
  run.study.root().finish();
  const auto session = static_cast<std::uint32_t>(std::random_device()());
  LiveLoop loop(study, session);
  std::unique_ptr<LiveLinks> links;
  if (study.car) {
    links = std::make_unique<CarLinks>(study);
  } else {
    links = std::make_unique<UdpLinks>(study.telemetry, study.platform);
  }
  PageOfRun page(study, run.options());
  RealClock clock;
  const Nanoseconds start = clock.now();
  const auto utc = std::chrono::system_clock::now().time_since_epoch();
  make_folder(folder.path());
  const std::filesystem::path recording =
      folder.path() / fmt::format("run_{:%Y%m%dT%H%M%S}.vlr",
                                  fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
  std::vector<std::string> notes = study.cueing.notes;
  {
    LiveRecorder recorder(
        recording, {.program = program_name(),
                    .study = study.driver ? with_calibration(run.study, *study.driver).to_toml() : run.study.to_toml(),
                    .study_name = run.study.name(),
                    .started = start,
                    .started_utc = std::chrono::duration_cast<std::chrono::nanoseconds>(utc).count(),
                    .session = session});
    LiveControl control;
    stopped_by_signal = &control;
    std::signal(SIGUSR1, stop_on_signal);
    print_line(run.options(), fmt::format("listening at {}, orders to {} at {:g} Hz; recording {}",
                                          study.car ? study.car->line.string() : to_string(study.telemetry),
                                          to_string(study.platform), study.options.rate, recording.string()));
    print_line(run.options(), "keys: s start, p park, e or space emergency stop, r release it, q park and end");
    std::string late;
    std::thread thread([&] {
      late = make_thread_timely();
      loop.run(*links, clock, control, &recorder, std::nullopt);
    });
    supervise(run, study, control, recorder, page, clock, start, notes);
    thread.join();
    std::signal(SIGUSR1, SIG_DFL);
    stopped_by_signal = nullptr;
    if (!late.empty()) notes.push_back(late);
  }
  return report_run(run.options(), run.record(study.cueing.seed, {}), folder, recording, notes,
                    Interruption());  // the Ctrl-C that ended the run does not end its report; a second one does
#endif
}

int cue_replay(const Arguments& arguments) {
  const std::filesystem::path file = arguments.text("--replay");
  OutputFolder folder(arguments.common.out);
  const LiveFile recorded = read_live_file(file);
  const StudyRun run = parse_study("cue", recorded.head.study_name, recorded.head.study, arguments);
  RunRecord record = run.record(0, {file});
  return report_run(arguments.common, record, folder, file, {}, arguments.common.interruption);
}

}  // namespace veridyn::app
