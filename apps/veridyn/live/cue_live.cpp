// veridyn cue --live and --replay: a platform that follows telemetry as it comes, and the same run again.
#include "apps/veridyn/live/cue_live.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cmath>
#include <random>

#include "apps/veridyn/live/camera_run.hpp"
#include "apps/veridyn/live/live_drive.hpp"
#include "apps/veridyn/live/live_operator.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/live/rig/live_replay.hpp"
#include "veridyn/live/rig/running_loop.hpp"
#include "veridyn/live/threads/timely_thread.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/live_report.hpp"
#ifdef VERIDYN_HAS_SOCKETS
#include "veridyn/live/rig/car_links.hpp"
#include "veridyn/live/rig/udp_links.hpp"
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
  for (const cueing::PlatformAxis a : axes) text += fmt::format(",ordered_{}[{}]", name_of(a), turns(a) ? "rad" : "m");
  text += "\n";
  for (std::size_t k = 0; k < r.run.steps.size(); ++k) {
    const recording::MotionSample& v = r.run.vehicle[k];
    text += fmt::format("{:.4f},{},{:.4f},{:.5g},{:.5g},{:.5g}", v.time, name_of(r.states[k]), r.shares[k], v.force.x(),
                        v.force.y(), v.force.z());
    for (const cueing::PlatformAxis a : axes) text += fmt::format(",{:.6g}", axis(r.run.steps[k].ordered, a).position);
    text += "\n";
  }
  return text;
}

std::string packets_csv(const LiveReplay& r) {
  std::string text = "sender,packets,count\n";
  for (const PacketIntake::FromSender& s : r.senders) {
    for (std::size_t i = 0; i < kPacketStatuses; ++i)
      text += fmt::format("{},{},{}\n", to_string(s.sender), name_of(static_cast<PacketStatus>(i)), s.counts[i]);
  }
  if (!r.car) return text;
  // The car's reports, and what became of others on the line.
  const LinkQuality& q = r.car->quality;
  for (std::size_t i = 0; i < kPacketStatuses; ++i) {
    const auto fate = static_cast<PacketStatus>(i);
    const std::uint64_t count = fate == PacketStatus::kRepeated     ? q.reports_duplicate
                                : fate == PacketStatus::kOutOfOrder ? q.reports_late
                                                                    : r.packets[i];
    text += fmt::format("car,{},{}\n", name_of(fate), count);
  }
  text += fmt::format("car,lost,{}\ncar,damaged frames,{}\n", q.reports_lost, q.frames_damaged);
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
  s["orders_extrapolated"] = r.extrapolated.steps;
  for (const auto& [name, h] :
       {std::pair("receive_to_send_s", &r.times.receive_to_send), std::pair("wait_s", &r.times.wait),
        std::pair("work_s", &r.times.work), std::pair("jitter_s", &r.times.jitter)}) {
    if (h->count() == 0 && (h == &r.times.wait || h == &r.times.work)) continue;  // of a replay they are not known
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
    s["car"]["pedal_to_platform_s"]["p50"] = r.car->pedal_to_platform.whole.quantile(0.5);
    s["car"]["pedal_to_platform_s"]["p99"] = r.car->pedal_to_platform.whole.quantile(0.99);
  }
  for (std::size_t i = 0; i < kPacketStatuses; ++i)
    s["packets"][std::string(name_of(static_cast<PacketStatus>(i)))] = r.packets[i];
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
/// @param measured by the run itself; null of one that is only replayed
int report_run(const CommonOptions& options, const RunRecord& record, OutputFolder& folder,
               const std::filesystem::path& recording, const std::vector<std::string>& notes, const LoopTimes* measured,
               const Interruption& interruption) {
  TerminalProgress progress(options.quiet, options.threads, interruption);
  const LiveFile recorded = read_live_file(recording);
  LiveReplay r = replay(recorded, recording.string(), progress);
  if (measured != nullptr) {
    r.times.wait = measured->wait;
    r.times.work = measured->work;
  }
  if (progress.interrupted()) throw Interrupted();
  progress.stage("scoring what was felt");
  const cueing::CueingResult score = scored(r);
  folder.write("platform.csv", motion_csv(r));
  folder.write("packets.csv", packets_csv(r));
  const auto fused = fused_run(Study::parse(recorded.head.study, recorded.head.study_name), r);
  if (r.car) {
    folder.write("drive.csv", DriveTable::header() + r.car->drive.take_lines());
    folder.write("delays.toml", delays_toml(r) + (fused ? camera_delay_toml(*fused) : ""));
  }
  if (fused) folder.write("motion.csv", fused->motion_csv);
  folder.write("report.html", report::to_html(report::live_report(r, score, notes, program_name())));
  const std::string files = fmt::format("{}", fmt::join(folder.files(), ", "));
  Summary summary = summary_of(folder, r, recording);
  if (r.study.camera && r.car) {
    summary["camera"]["poses"] = r.car->camera.poses;
    summary["camera"]["unreadable"] = r.car->camera.unreadable;
    if (fused) {
      summary["camera"]["fused_samples"] = fused->samples;
      summary["camera"]["frames"] = fused->frames;
      summary["camera"]["frames_too_late"] = fused->late;
      summary["camera"]["offset_s"] = fused->offset;
      summary["camera"]["sigma_offset_s"] = fused->sigma_offset;
    }
  }
  folder.publish(record, options, summary);
  print_line(options, fmt::format("{} orders in {:.1f} s, {} beyond limits, {} different when replayed", r.times.steps,
                                  r.duration, r.outside, r.different));
  if (r.times.receive_to_send.count() > 0)
    print_line(options,
               fmt::format("packet's arrival to order: half within {:.2f} ms, 99 % within {:.2f} ms, longest {:.2f} ms",
                           1e3 * r.times.receive_to_send.quantile(0.5), 1e3 * r.times.receive_to_send.quantile(0.99),
                           1e3 * seconds(r.times.receive_to_send.largest())));
  if (r.car) print_line(options, car_line(r));
  if (r.study.camera && r.car && !fused) print_line(options, "camera: no pose of it came in: nothing is fused");
  if (fused)
    print_line(options,
               fmt::format("camera: {} poses, {} of them fused, {} too late; its stamps are {:+.1f} ms (95 %: +- "
                           "{:.1f}) off the shortest way",
                           r.car->camera.poses, fused->frames, fused->late, 1e3 * fused->offset,
                           1960.0 * fused->sigma_offset));
  print_line(options, fmt::format("wrote {} in {}", files, folder.path().string()));
  if (r.car && r.car->commands_different > 0) return kFailed;
  if (r.different > 0 || r.outside > 0 || r.answers.outside_limits > 0) return kFailed;
  return kDone;
}

}  // namespace

int cue_live(const StudyRun& run) {
#ifndef VERIDYN_HAS_SOCKETS
  throw InputError("--live", "this program was built without sockets (see VERIDYN_SOCKETS)");
#else
  OutputFolder folder(run.options().out);
  const LiveStudy study = read_live_study(run.study);
  check_camera(run.study);
  run.study.root().finish();
  constexpr double kLongestToPark = 10.0;  // [s], on top of the fade
  const auto session = static_cast<std::uint32_t>(std::random_device()());
  LiveLoop loop(study, session);
  std::unique_ptr<LiveLinks> links;
  if (study.car) {
    links = std::make_unique<CarLinks>(study);
  } else if (study.platform_line.device.empty()) {
    links = std::make_unique<UdpLinks>(study.telemetry, study.platform);
  } else {
    links = std::make_unique<UdpLinks>(study.telemetry, study.platform_line);
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
    LiveRecorder recorder(recording, {.program = program_name(),
                                      .study = self_contained(run.study, study).to_toml(),
                                      .study_name = run.study.name(),
                                      .started = start,
                                      .started_utc = std::chrono::duration_cast<std::chrono::nanoseconds>(utc).count(),
                                      .session = session});
    LiveControl control;
    const LiveSignals signals(control);
    print_line(run.options(), fmt::format("listening at {}, orders to {} at {:g} Hz; recording {}",
                                          study.car ? study.car->line.string() : to_string(study.telemetry),
                                          platform_name(study), study.options.rate, recording.string()));
    print_line(run.options(), "keys: s start, p park, e or space emergency stop, r release it, q park and end");
    std::string late;
    RunningLoop running(control, study.options.fade + kLongestToPark, [&] {
      late = make_thread_timely();
      loop.run(*links, clock, control, &recorder, std::nullopt);
    });
    const OperatorOptions led{.common = run.options(),
                              .length = run.arguments.number("--seconds"),
                              .start = run.arguments.flag("--start"),
                              .at = start};
    for (std::string& note : lead_run(led, study, control, recorder, page)) notes.push_back(std::move(note));
    running.end();
    if (!late.empty()) notes.push_back(late);
  }
  return report_run(run.options(), run.record(study.cueing.seed, study.cueing.inputs), folder, recording, notes,
                    &loop.times(),
                    Interruption());  // the Ctrl-C that ended the run does not end its report; a second one does
#endif
}

int cue_replay(const Arguments& arguments) {
  const std::filesystem::path file = arguments.text("--replay");
  OutputFolder folder(arguments.common.out);
  const LiveFile recorded = read_live_file(file);
  const StudyRun run = parse_study("cue", recorded.head.study_name, recorded.head.study, arguments);
  RunRecord record = run.record(0, {file});
  return report_run(arguments.common, record, folder, file, {}, nullptr, arguments.common.interruption);
}

}  // namespace veridyn::app
