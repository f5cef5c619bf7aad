// veridyn init aircraft|vehicle|swing-test|calibration|muscle|cueing: a commented study file to start from.
#include <fmt/format.h>

#include <filesystem>

#include "apps/veridyn/cueing_template.hpp"
#include "apps/veridyn/ground_templates.hpp"
#include "apps/veridyn/muscle_template.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/vehicle_template.hpp"
#include "veridyn/aircraft/aircraft_keys.hpp"
#include "veridyn/aircraft/sensors/channel_map.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/cueing/cueing_keys.hpp"
#include "veridyn/muscle/muscle_keys.hpp"
#include "veridyn/recording/channel_recognition.hpp"
#include "veridyn/recording/consistency.hpp"
#include "veridyn/recording/study_data.hpp"
#include "veridyn/vehicle/identification/signals/drive_log.hpp"
#include "veridyn/vehicle/vehicle_keys.hpp"

namespace veridyn::app {
namespace {

constexpr const char* kAircraftStudy =
    R"toml(# A study of one flight: the aircraft, what was recorded, what to find out.
#   veridyn inspect flight.bin          what the log holds and how it would be mapped
#   veridyn identify study.toml         from log to model, with a report
# Numbers are SI and radians; a text may carry any unit of the same kind: "27 lb", "12 deg". Keys with a leading # show
# their defaults. Misspelt keys are refused, with the nearest known one. What is "?" is yours to fill in.

seed = 1

[subject]
name = "my aircraft"
# builtin = "thor"               # start from a built-in aircraft instead; every key below then overrides it
mass = "? kg"                    # as flown
wing_area = "? m^2"
span = "? m"
chord = "? m"                    # mean aerodynamic chord
sign_convention = "positive elevator: trailing edge down"
# Without the inertia the moments are identified per unit inertia only.
# inertia = { Jx = 0.07, Jy = 0.09, Jz = 0.15, Jxz = 0.01 }  # kg m^2; `veridyn init swing-test` measures it
# sigma = { mass = 0.01, Jy = 0.005 }   # how well these are known: goes into every derivative's error bar
# imu_position = [0, 0, 0]       # m from the centre of gravity: forward, right, down

# What each coefficient depends on: alpha beta p_n q_n r_n de da dr CT Va, products ("alpha*q_n"), powers ("alpha^2"),
# "abs(de)" and splines ("spline(alpha, 8 deg, 2)").
[subject.model]
CL = ["1", "alpha", "q_n", "de"]
CD = ["1", "alpha", "alpha^2"]
CY = ["1", "beta", "p_n", "r_n", "da", "dr"]
Cl = ["1", "beta", "p_n", "r_n", "da", "dr"]
Cm = ["1", "alpha", "q_n", "de"]
Cn = ["1", "beta", "p_n", "r_n", "da", "dr"]

# Drag needs thrust: a channel `thrust`, or a model of throttle (0..1) and airspeed (see docs/aircraft.md).
[subject.propulsion]
kind = "none"

# Full throws, to turn servo positions into deflections. Take away the table of a rudder or aileron that the aircraft
# does not have.
[subject.actuators.elevator]
upper = "? deg"                  # symmetric unless `lower` says otherwise
[subject.actuators.aileron]
upper = "? deg"
[subject.actuators.rudder]
upper = "? deg"

[data]
file = @LOG@
@READ@# files = ["IMU.csv", "GPS.csv"] # the tables of one flight instead
# calibration = "calibration.toml"   # of pitot tube and vanes; `veridyn init calibration` makes one
# from = 120                     # s, only this part of the log
# to = 600

# ArduPilot and PX4 logs are mapped automatically; what is named here wins. `veridyn inspect` lists the channels.
[data.map]
@MAP@# airspeed = "ARSP.Airspeed"
# alpha    = { channel = "CUR2.Volt", zero = 2.5, scale = 0.61, unit = "rad", delay = "20 ms" }
# aileron  = { channels = ["left", "right"], weights = [0.5, -0.5], unit = "deg" }
# beta     = "none"              # do not use it

[delays]
@keys delays automatic gps

[reconstruct]
@keys reconstruct turbulence filter estimate_file estimate airspeed_is

[signals]
@keys signals pass_band flow_angles
# noise = { alpha = "0.6 deg" }    # standard deviation per sample; measured from the log where it is not given

[segments]
@keys segments holdout longitudinal lateral

[identify]
@keys identify method refit_significant structure output_error output_error_gusts frequency_band bootstrap

[uncertainty]
@keys uncertainty draws
# sigma = { thrust = "0.5 N" }     # error of a signal, where the log does not show it

[validate]
@keys validate period open_loop

[flying_qualities]
@keys flying_qualities class category airspeed

# `veridyn track study.toml` follows the parameters on line, replayed or live (docs/tracking.md).
[track]
@keys track memory forgetting false_alarm_interval estimate_file
)toml";

/// A file's path as TOML text, so that it is found from the study's folder.
std::string quoted_path(const std::string& file, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path path = file;
  // A file that is there is named from the study's folder; a name to be filled in stays as it is.
  if (path.is_relative() && fs::exists(path, error))
    path = fs::proximate(fs::absolute(path), fs::absolute(folder), error);
  return toml_text(path.string());
}

/// A template with `mark` replaced.
std::string filled(std::string text, const std::string& mark, const std::string& with) {
  return text.replace(text.find(mark), mark.size(), with);
}

int write_study(const Arguments& arguments, const std::string& text, const std::string& to_do,
                const std::string& command = "identify") {
  OutputFolder folder(arguments.common.out);
  const std::string name = "study.toml";
  const std::filesystem::path path = folder.path() / name;
  if (std::filesystem::exists(path) && !arguments.flag("--force")) {
    throw InputError(path.string(), "is there already; --force replaces it");
  }
  folder.write(name, text);
  print_summary(Summary::object({{"folder", folder.path().string()}, {"files", std::vector<std::string>{name}}}),
                arguments.common);
  folder.publish();
  print_line(arguments.common,
             fmt::format("wrote {}: {}, then `veridyn {} {}`", path.string(), to_do, command, path.string()));
  return kDone;
}

/// The file that a study is about, named from the study's folder.
std::string quoted_argument(const Arguments& arguments, const char* name) {
  return quoted_path(arguments.text(name), arguments.common.out);
}

/// What a study says of the log that it is about.
struct LogSections {
  std::string read;  ///< keys of [data] by which it was read
  std::string map;   ///< lines of [data.map]
};

/// The keys of `[data]` that the command line gave (`--set data.decimal=","`), as lines of it.
std::string reading_keys(const Arguments& arguments) {
  std::string lines;
  for (const std::string& text : arguments.common.overrides) {
    constexpr std::string_view kTable = "data.";
    const std::size_t equals = text.find('=');
    if (!text.starts_with(kTable) || equals == std::string::npos) continue;
    std::string value = text.substr(equals + 1);
    try {
      static_cast<void>(Study::parse("value = " + value, "--set"));
    } catch (const InputError&) {
      value = fmt::format("\"{}\"", value);
    }
    lines += fmt::format("{} = {}\n", text.substr(kTable.size(), equals - kTable.size()), value);
  }
  return lines;
}

/// What is known of the log; nothing where the file is not there yet.
template <typename Map>
LogSections log_sections(const Arguments& arguments, std::span<const recording::StandardChannel> standard,
                         std::span<const recording::ChannelAlias> aliases, Map map_log) {
  const std::string& file = arguments.text("--log");
  const Study study = Study::parse("", "--set", {}, arguments.common.overrides);
  const StudyTable data = study.root().table_or_empty("data");
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    if (!arguments.common.overrides.empty()) throw InputError(file, "no such file, which --set data... is about");
    return {};
  }
  Recording log = recording::read_study_file(data, file);
  static_cast<void>(data.has("frame") ? data.text("frame") : std::string());
  study.root().finish();
  log = recording::without_missing(log);
  const recording::MappedRecording mapped = map_log(log);
  LogSections sections{reading_keys(arguments), {}};
  for (const std::string& warning : log.warnings) sections.read += fmt::format("# note: {}\n", warning);
  if (mapped.recording.channels().empty())
    print_line(
        arguments.common,
        fmt::format("{}: no channel is known by its name; `veridyn inspect {}` lists what it holds", file, file));
  sections.map = recording::map_section(log, mapped, standard, aliases);
  return sections;
}

int init_aircraft(const Arguments& arguments) {
  const LogSections log =
      log_sections(arguments, aircraft::standard_channels(), aircraft::channel_aliases(),
                   [](const Recording& r) { return aircraft::map_channels(r, StudyTable("data.map"), {}); });
  std::string study =
      filled(with_keys(kAircraftStudy, aircraft::study_keys()), "@LOG@", quoted_argument(arguments, "--log"));
  study = filled(filled(study, "@READ@", log.read), "@MAP@", log.map);
  return write_study(arguments, study, "fill in the subject, confirm [data.map]");
}

/// Units, signs and axes of a drive that contradict each other, with the lines of `[data.map]` that would correct them:
/// for the user to decide.
std::string corrections(const recording::MappedRecording& drive) {
  const recording::DriveMotion motion = recording::drive_motion(drive.recording);
  const recording::Consistency found = recording::check_consistency(motion);
  std::string lines;
  for (const std::vector<recording::ChannelFault>& explanation : found.explanations) {
    for (const recording::ChannelFault& fault : explanation) {
      lines += fmt::format("# {}: {}\n", found.is_sure() ? "wrong" : "may be", fault.says(motion.names));
      for (const std::string& line : recording::correction_of(fault, motion.names, drive.origins))
        lines += fmt::format("#   {}\n", line);
    }
  }
  return lines.empty() ? lines : "# `veridyn inspect` has the figures of what follows.\n" + lines;
}

/// The part of a study about a recorded drive.
std::string drive_section(const Arguments& arguments, const char* text) {
  std::string contradictions;
  const LogSections log = log_sections(arguments, vehicle::standard_drive_channels(), vehicle::drive_channel_aliases(),
                                       [&contradictions](const Recording& r) {
                                         recording::MappedRecording drive =
                                             vehicle::map_drive_channels(r, StudyTable("data.map"));
                                         contradictions = corrections(drive);
                                         return drive;
                                       });
  const std::string data = filled(text, "@LOG@", quoted_argument(arguments, "--log"));
  return filled(filled(data, "@READ@", log.read), "@MAP@", log.map + contradictions);
}

int init_vehicle(const Arguments& arguments) {
  const bool log = !arguments.text("--log").empty();
  const std::string data = log ? drive_section(arguments, kDriveLog) : kNoDriveLog;
  // A car to drive is given; that of a log is the user's to weigh and measure.
  std::string study = with_keys(filled(kVehicleStudy, "@DATA@", data), vehicle::study_keys());
  study = filled(study, "@MASS@", log ? "\"? kg\"   " : "\"1480 kg\"");
  study = filled(study, "@A@", log ? "\"? m\"   " : "\"1.14 m\"");
  study = filled(study, "@B@", log ? "\"? m\"   " : "\"1.50 m\"");
  return write_study(arguments, study, "fill in the vehicle", log ? "identify" : "simulate");
}

int init_muscle(const Arguments& arguments) {
  return write_study(
      arguments,
      filled(with_keys(kMuscleStudy, muscle::study_keys()), "@MODEL@", quoted_argument(arguments, "--model")),
      "choose method and motion", "simulate");
}

int init_cueing(const Arguments& arguments) {
  const bool log = !arguments.text("--log").empty();
  const std::string data = log ? drive_section(arguments, kCueingRecorded) : kCueingSimulated;
  return write_study(arguments, filled(with_keys(kCueingStudy, cueing::study_keys()), "@DATA@", data),
                     "choose platform and algorithms", "cue");
}

const Argument kForce = {.name = "--force", .help = "replace an existing study.toml", .value = false};

Command init_ground(const std::string& name, const std::string& summary, const char* text) {
  return {
      .name = name,
      .summary = summary,
      .arguments = {kForce},
      .default_out = ".",
      .example = fmt::format("veridyn init {} --out bench", name),
      .run = [text](const Arguments& arguments) { return write_study(arguments, text, "fill in what you measured"); }};
}

}  // namespace

Command init_command() {
  return {
      .name = "init",
      .summary = "write a commented study file to start from",
      .commands = {
          init_ground("swing-test", "study of an inertia swing test: study.toml in --out", kSwingTestStudy),
          init_ground("calibration", "study of a wind-tunnel calibration of pitot tube and vanes", kCalibrationStudy),
          {.name = "cueing",
           .summary = "study of a drive on a motion platform: study.toml in --out",
           .arguments = {{.name = "--log", .help = "a recorded drive; none: it is simulated", .type = "FILE"}, kForce},
           .default_out = ".",
           .example = "veridyn init cueing --log drive.csv --out my_rig",
           .run = init_cueing},
          {.name = "muscle",
           .summary = "study of a musculoskeletal model: study.toml in --out",
           .arguments = {{.name = "--model",
                          .help = "OpenSim model (.osim), or a built-in one: arm",
                          .value = "arm",
                          .type = "FILE"},
                         kForce},
           .default_out = ".",
           .example = "veridyn init muscle --model arm26.osim --out my_arm",
           .run = init_muscle},
          {.name = "vehicle",
           .summary = "study of a road vehicle: study.toml in --out",
           .arguments = {{.name = "--log",
                          .help = "a drive log that the study is about; none: the drive is simulated",
                          .type = "FILE"},
                         kForce},
           .default_out = ".",
           .example = "veridyn init vehicle --log drive.csv --out my_car\n  veridyn init vehicle --log drive.txt --set "
                      "data.time.column=clock --out my_car",
           .run = init_vehicle},
          {.name = "aircraft",
           .summary = "study of an aircraft: study.toml in --out",
           .arguments =
               {{.name = "--log", .help = "the log that the study is about", .value = "flight.bin", .type = "FILE"},
                kForce},
           .default_out = ".",
           .example = "veridyn init aircraft --log flight.bin --out my_aircraft",
           .run = init_aircraft}}};
}

}  // namespace veridyn::app
