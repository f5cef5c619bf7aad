// veridyn inspect FILE: what a log holds, or a model.
#include <fmt/format.h>

#include <cmath>

#include "apps/veridyn/inspect_model.hpp"
#include "apps/veridyn/run/console.hpp"
#include "veridyn/aircraft/sensors/channel_map.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/log_formats.hpp"
#include "veridyn/io/read.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/recording/consistency.hpp"
#include "veridyn/recording/ros_topics.hpp"
#include "veridyn/recording/study_data.hpp"
#include "veridyn/vehicle/identification/signals/drive_log.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::app {
namespace {

struct Range {
  double low = NAN;
  double high = NAN;
  std::size_t missing = 0;
};

Range range_of(const Channel& channel) {
  Range range;
  for (const double v : channel.value) {
    if (!std::isfinite(v)) {
      ++range.missing;
      continue;
    }
    range.low = std::fmin(range.low, v);
    range.high = std::fmax(range.high, v);
  }
  return range;
}

double gap_time(const Channel& channel) {
  double total = 0.0;
  for (const TimeSpan& gap : channel.gaps()) total += gap.duration();
  return total;
}

/// Which channels a study would take.
std::string mapping_section(const recording::MappedRecording& mapped, bool vehicle, Summary& summary) {
  std::string text;
  summary["mapping"] = Summary::object();
  if (!mapped.origins.empty()) {
    text += fmt::format("\nfor {} study ({} log):\n", vehicle ? "a vehicle" : "an aircraft", mapped.log_kind);
    for (const recording::ChannelOrigin& origin : mapped.origins) {
      summary["mapping"][origin.channel] = origin.source;
      text += fmt::format("  {:<18} <- {} ({:.1f} Hz){}\n", origin.channel, origin.source, origin.rate_Hz,
                          origin.note.empty() ? "" : ", " + origin.note);
    }
    for (const recording::ChannelOrigin& other : mapped.left)
      text += fmt::format("  left: {} ({:.1f} Hz), which is {} too\n", other.source, other.rate_Hz, other.channel);
  }
  for (const std::string& note : mapped.notes) text += fmt::format("  note: {}\n", note);
  return text;
}

/// Signs, axes and units of a drive by what its channels say of each other.
std::string axis_section(const recording::MappedRecording& mapped, Summary& summary, double wheelbase = 0.0) {
  const recording::DriveMotion motion = recording::drive_motion(mapped.recording);
  const recording::Consistency found =
      recording::check_consistency(motion, {.wheelbase = motion.hand_wheel ? 0.0 : wheelbase});
  if (found.relations.empty()) return {};
  std::string text = fmt::format("\nsigns and units:\n  {:<52} {:>18} {:>12} {:>6}\n", "reading over what others imply",
                                 "ratio", "correlation", "[s]");
  Summary json = Summary::object();
  json["relations"] = Summary::array();
  for (const recording::ChannelRelation& r : found.relations) {
    const std::string pair = fmt::format("{}: {}", motion.names[r.channel], r.against);
    text += r.moved() ? fmt::format("  {:<52} {:>18} {:>12.2f} {:>6.0f}{}\n", pair,
                                    fmt::format("{:.3g} to {:.3g}", r.low, r.high), r.correlation, r.seconds,
                                    r.fits()                                      ? "  fits"
                                    : r.outcome() == estimation::Outcome::kPassed ? "  cannot tell"
                                                                                  : "  is off")
                      : fmt::format("  {:<52} too little of it to compare\n", pair);
    json["relations"].push_back(Summary::object({{"channel", motion.names[r.channel]},
                                                 {"against", r.against},
                                                 {"low", r.low},
                                                 {"high", r.high},
                                                 {"correlation", r.correlation},
                                                 {"lag", r.lag_s},
                                                 {"seconds", r.seconds},
                                                 {"moved", r.moved()},
                                                 {"fits", r.fits()}}));
  }
  json["faults"] = Summary::array();
  for (std::size_t i = 0; i < found.explanations.size(); ++i) {
    const char* begin = found.is_sure() ? "wrong:" : i == 0 ? "either:" : "or:";
    for (const recording::ChannelFault& f : found.explanations[i]) {
      const std::vector<std::string> lines = correction_of(f, motion.names, mapped.origins);
      // What may be motion is no fault for sure.
      text +=
          fmt::format("  {} {}\n", f.cause == estimation::Cause::kMissingTerm ? "note:" : begin, f.says(motion.names));
      const char* table = f.cause == estimation::Cause::kFrame ? "data" : "data.map";
      for (const std::string& line : lines) text += fmt::format("      correct it in [{}]: {}\n", table, line);
      Summary one = Summary::object({{"fault", f.says(motion.names)},
                                     {"cause", estimation::to_string(f.cause)},
                                     {"factor", f.factor},
                                     {"sure", found.is_sure()}});
      one["correction"] = lines;
      json["faults"].push_back(std::move(one));
    }
  }
  if (found.is_off() && found.explanations.empty())
    text += "  no unit, sign, axis or scale of up to three channels explains what does not fit\n";
  const bool fits = std::ranges::any_of(found.relations, [](const auto& r) { return r.fits(); });
  if (!found.is_off() && fits) text += "  nothing contradicts the channels' names and units\n";
  summary["signs_and_units"] = std::move(json);
  return text;
}

/// What the log itself says, else the frame, which distinguishes vehicles from aircraft but in recordings of ROS, where
/// an airspeed does; of a table that does not say it, its speed.
bool is_of_vehicle(const Recording& recording) {
  if (const auto said = recording.information.find("vehicle"); said != recording.information.end())
    return said->second == "ground rover";
  if (recording::is_ros(recording))
    return !aircraft::map_channels(recording, StudyTable("data.map"), {}).recording.has("airspeed");
  return recording.frame == Frame::kFlu ||
         (recording.find("speed") != nullptr && recording.find("airspeed") == nullptr);
}

/// Of the study's vehicle; 0 where it is not filled in yet.
double wheelbase_of(const Study& study) {
  try {
    return vehicle::read_vehicle(study.root().table("subject"), vehicle::VehicleNeeds::kGeometry)
        .parameters.wheelbase();
  } catch (const InputError&) {
    return 0.0;
  }
}

/// The drive of a study, with its `[data.map]`.
int inspect_drive(const Arguments& arguments, const std::string& file) {
  const Study study = Study::load(file, arguments.common.overrides);
  const StudyTable data = study.root().table("data");
  const vehicle::DriveLog log = vehicle::read_drive_log(data);
  data.finish();
  Summary summary;
  summary["file"] = file;
  std::string text = fmt::format("{}: drive of a study, {} channels\n", file, log.mapped.recording.channels().size());
  text += mapping_section(log.mapped, true, summary);
  text += axis_section(log.mapped, summary, wheelbase_of(study));
  if (arguments.common.json) {
    print_summary(summary, arguments.common);
  } else {
    print_text(text);
  }
  return kDone;
}

int inspect(const Arguments& arguments) {
  const std::string& file = arguments.text("FILE");
  const std::string& pose = arguments.text("--pose");
  if (std::filesystem::path(file).extension() == ".toml") return inspect_drive(arguments, file);
  if (is_model(file)) return inspect_model(file, pose, arguments.flag("--as-opensim"), arguments.common);
  const Study study = Study::parse("", "--set", {}, arguments.common.overrides);
  const StudyTable data = study.root().table_or_empty("data");
  const io::ReadOptions options = recording::read_study_options(data, file);
  study.root().finish();
  io::Log log = io::read_log(file, options);
  const std::string format = log.format;
  const io::LogDamage damage = log.damage;
  const std::size_t topics = log.topics.size();
  const Recording recording = io::to_recording(std::move(log));
  if (arguments.flag("--values")) {
    print_text(io::to_csv(recording));
    return kDone;
  }
  const bool vehicle = is_of_vehicle(recording);
  const recording::MappedRecording mapped = vehicle ? vehicle::map_drive_channels(recording, StudyTable("data.map"))
                                                    : aircraft::map_channels(recording, StudyTable("data.map"), {});
  const TimeSpan span = recording.span();

  Summary summary;
  summary["file"] = file;
  summary["format"] = format;
  summary["span"] = Summary::array({span.begin, span.end});
  summary["bytes_lost"] = damage.bytes_lost;
  summary["records_lost"] = damage.records_lost;
  summary["channels"] = Summary::array();
  std::string text =
      fmt::format("{}: {}, {} kind{} of message, {} channels, {:.3f} s to {:.3f} s ({:.1f} s)\n", file, format, topics,
                  topics == 1 ? "" : "s", recording.channels().size(), span.begin, span.end, span.duration());
  if (damage.any()) {
    text += fmt::format("lost: {} bytes, {} records, {} dropouts of {:.3f} s in all\n", damage.bytes_lost,
                        damage.records_lost, damage.dropouts, damage.dropout_s);
  } else {
    text += "lost: nothing\n";
  }
  for (const std::string& warning : recording.warnings) text += fmt::format("note: {}\n", warning);
  for (const auto& [key, value] : recording.information) text += fmt::format("{}: {}\n", key, value);

  text += mapping_section(mapped, vehicle, summary);
  text += fmt::format("\n{:<44} {:<8} {:>8} {:>9} {:>5} {:>7} {:>8}  range\n", "channel", "unit", "samples",
                      "rate [Hz]", "gaps", "gap [s]", "missing");
  for (const Channel& channel : recording.channels()) {
    const Range range = range_of(channel);
    const auto gaps = channel.gaps();
    summary["channels"].push_back(Summary::object({{"name", channel.name},
                                                   {"unit", channel.unit.name},
                                                   {"recorded_unit", channel.recorded_unit},
                                                   {"samples", channel.size()},
                                                   {"rate_Hz", channel.rate_Hz()},
                                                   {"gaps", gaps.size()},
                                                   {"missing", range.missing}}));
    text += fmt::format(
        "{:<44} {:<8} {:>8} {:>9.2f} {:>5} {:>7.2f} {:>8}  {}\n", channel.name, channel.unit.name, channel.size(),
        channel.rate_Hz(), gaps.size(), gap_time(channel), range.missing,
        std::isfinite(range.low) ? fmt::format("{:.6g} .. {:.6g}", range.low, range.high) : "no numeric values");
  }
  if (vehicle) text += axis_section(mapped, summary);
  if (arguments.flag("--events")) {
    text += "\nevents:\n";
    for (const Event& event : recording.events)
      text += fmt::format("  {:12.3f} s  {:<10} {}\n", event.time, event.kind, event.text);
  }
  if (arguments.flag("--parameters")) {
    text += "\nparameters:\n";
    for (const auto& [name, value] : recording.parameters) text += fmt::format("  {:<24} {}\n", name, value);
  }
  if (arguments.common.json) {
    print_summary(summary, arguments.common);
  } else {
    print_text(text);
  }
  return kDone;
}

}  // namespace

Command inspect_command() {
  return {
      .name = "inspect",
      .summary = "what a log or a model file holds: channels, rates, gaps, damage; bodies, joints, muscles",
      .arguments =
          {{.name = "FILE",
            .help =
                fmt::format("a study whose [data] names a drive; a log: {}, or a folder of CSV; OpenSim model .osim, "
                            "or the built-in model 'arm'; a folder of .osim models gives a table: loads, "
                            "simulates, what is missing",
                            io::list_of_log_formats()),
            .required = true},
           {.name = "--events", .help = "list flight modes and messages", .value = false},
           {.name = "--parameters", .help = "list the autopilot's parameters", .value = false},
           {.name = "--values",
            .help =
                "of a log: print every channel as CSV instead, in SI; a row a stamp, empty where a channel has none",
            .value = false},
           {.name = "--pose",
            .help = "of a model: print muscle lengths, moment arms and generalised forces as CSV, for the poses of "
                    "a .csv, .mot or .sto file or for one pose 'elbow_flexion=90 deg,...'"},
           {.name = "--as-opensim", .help = "with --pose: wrap paths as OpenSim does, jumps included", .value = false}},
      .example =
          "veridyn inspect flight.bin\n  veridyn inspect flight.bin --values > flight.csv\n  veridyn inspect "
          "drive.csv\n  veridyn inspect drive.txt --set "
          "data.time.column=clock\n  veridyn inspect arm26.osim\n  veridyn inspect "
          "arm --pose "
          "\"elbow_flexion=90 deg\"",
      .run = inspect};
}

}  // namespace veridyn::app
