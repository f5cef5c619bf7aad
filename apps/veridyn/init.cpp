// veridyn init aircraft|vehicle|swing-test|calibration|muscle: a commented study file to start from.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "apps/veridyn/ground_templates.hpp"
#include "apps/veridyn/muscle_template.hpp"
#include "apps/veridyn/options.hpp"
#include "apps/veridyn/output.hpp"
#include "apps/veridyn/vehicle_template.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::app {
namespace {

struct Options {
  std::string log;  ///< or model: the file that the study is about
  bool force = false;
  CommonOptions common;
};

constexpr const char* kAircraftStudy = R"toml(# A study of one flight: who flew, what was recorded, what to find out.
#   veridyn inspect flight.bin          what the log holds and how it would be mapped
#   veridyn identify study.toml         from log to model, with a report
# Numbers are SI and radians; a text may carry any unit of the same kind: "27 lb", "12 deg". Keys with a leading # show
# their defaults. Misspelt keys are refused, with the nearest known one.

seed = 1

[subject]
name = "my aircraft"
# builtin = "thor"               # start from a built-in aircraft instead; every key below then overrides it
mass = "2.0 kg"                  # as flown
wing_area = "0.31 m^2"
span = "1.27 m"
chord = "0.25 m"                 # mean aerodynamic chord
sign_convention = "positive elevator: trailing edge down"
# Without the inertia the moments are identified per unit inertia only.
inertia = { Jx = 0.07, Jy = 0.09, Jz = 0.15, Jxz = 0.01 }    # kg m^2; `veridyn init swing-test` measures it
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

# Full throws, to turn servo positions into deflections.
[subject.actuators.elevator]
upper = "20 deg"                 # symmetric unless `lower` says otherwise
[subject.actuators.aileron]
upper = "20 deg"
[subject.actuators.rudder]
upper = "20 deg"

[data]
file = @LOG@
# files = ["IMU.csv", "GPS.csv"] # the tables of one flight instead
# calibration = "calibration.toml"   # of pitot tube and vanes; `veridyn init calibration` makes one
# from = 120                     # s, only this part of the log
# to = 600

# ArduPilot and PX4 logs are mapped automatically; what is named here wins. `veridyn inspect` lists the channels.
[data.map]
# airspeed = "ARSP.Airspeed"
# alpha    = { channel = "CUR2.Volt", zero = 2.5, scale = 0.61, unit = "rad", delay = "20 ms" }
# aileron  = { channels = ["left", "right"], weights = [0.5, -0.5], unit = "deg" }
# beta     = "none"              # do not use it

[delays]
# automatic = true               # find out how late each sensor is and take it off
# gps = "0.12 s"                 # or say so

[reconstruct]
# turbulence = "auto"            # low_light, low_moderate, medium_light, medium_moderate, or what fits best
# filter = "model-free"          # "model-based" where the derivatives are known, "guarded" to fall back by itself
# estimate_file = "estimate.json"  # where the model-based filter takes them from; else from [subject.model]
# estimate = ["alpha_bias", "beta_bias", "pitot_scale"]   # sensor errors; the report says what the flight determines
# airspeed_is = "true"           # "equivalent" where the log's airspeed is indicated

[signals]
# pass_band = "10 Hz"            # kept; engine vibration is above, the aircraft's motion below
# flow_angles = "auto"           # "vane", "smoothed"
# noise = { alpha = "0.6 deg" }  # standard deviation per sample; measured from the log where it is not given

[segments]
# holdout = 0.33                 # share of the excited time that identification never sees
# longitudinal = [120, 150]      # s, begin and end of each, instead of searching for excitation
# lateral = [160, 200]

[identify]
# method = "auto"                # "OLS", "TLS", "GTLS", "PCA-GTLS"
# refit_significant = false      # once more with the significant parameters only
# structure = "given"            # "stepwise", "orthogonal": choose the terms among [identify.candidates]
# output_error = false           # beside regression: output-error maximum likelihood
# output_error_gusts = true      # its simulation is driven by the reconstructed gust; false: the air is calm
# frequency_band = ["0.1 Hz", "2 Hz"]   # beside regression: equation error in the frequency domain
# bootstrap = 0                  # beside regression: replicates of a block bootstrap, such as 500

[uncertainty]
# draws = 100000                 # of the Monte Carlo on the measured coefficients
# sigma = { thrust = "0.5 N" }   # error of a signal, where the log cannot tell

[validate]
# period = "5 s"                 # the model is started anew this often

# `veridyn track study.toml` follows the parameters on line, replayed or live (docs/tracking.md).
[track]
# memory = "100 s"               # a sample counts 5 % after this time
# forgetting = "variable"        # shorter memory while innovations are large
# false_alarm_interval = "36000 s"
# estimate = "estimate.json"     # start from an earlier identification
)toml";

/// A file's path as TOML text, so that it is found from the study's folder.
std::string quoted_path(const std::string& file, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path path = file;
  // A file that is there is named from the study's folder; a name to be filled in stays as it is.
  if (path.is_relative() && fs::exists(path, error))
    path = fs::proximate(fs::absolute(path), fs::absolute(folder), error);
  std::string quoted = "\"";
  for (const char c : path.string()) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

/// A template with `mark` replaced.
std::string filled(std::string text, const std::string& mark, const std::string& with) {
  return text.replace(text.find(mark), mark.size(), with);
}

std::filesystem::path folder_of(const Options& options) {
  return options.common.out.empty() ? "." : options.common.out;
}

void write_study(const Options& options, const std::string& text, const std::string& to_do,
                 const std::string& verb = "identify") {
  const std::filesystem::path folder = folder_of(options);
  make_folder(folder);
  const std::filesystem::path path = folder / "study.toml";
  if (std::filesystem::exists(path) && !options.force) {
    throw InputError(path.string(), "is there already; --force replaces it");
  }
  write_file(path, text);
  tell(options.common, fmt::format("wrote {}: {}, then `veridyn {} {}`", path.string(), to_do, verb, path.string()));
}

}  // namespace

void add_init(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = program.add_subcommand("init", "write a commented study file to start from");
  const auto add_ground = [&](const std::string& name, const std::string& help, const char* text) {
    auto ground = std::make_shared<Options>();
    CLI::App* kind = verb->add_subcommand(name, help);
    kind->add_flag("--force", ground->force, "replace an existing study.toml");
    add_common(*kind, ground->common, ".", fmt::format("veridyn init {} --out bench", name));
    kind->callback([ground, text, &exit_code] {
      write_study(*ground, text, "fill in what you measured");
      exit_code = kDone;
    });
  };
  add_ground("swing-test", "study of an inertia swing test: study.toml in --out", kSwingTestStudy);
  add_ground("calibration", "study of a wind-tunnel calibration of pitot tube and vanes", kCalibrationStudy);
  auto muscle = std::make_shared<Options>();
  CLI::App* model = verb->add_subcommand("muscle", "study of a musculoskeletal model: study.toml in --out");
  muscle->log = "arm";
  model->add_option("--model", muscle->log, "OpenSim model (.osim), or a built-in one: arm")
      ->capture_default_str()
      ->type_name("FILE");
  model->add_flag("--force", muscle->force, "replace an existing study.toml");
  add_common(*model, muscle->common, ".", "veridyn init muscle --model arm26.osim --out my_arm");
  model->callback([muscle, &exit_code] {
    write_study(*muscle, filled(kMuscleStudy, "@MODEL@", quoted_path(muscle->log, folder_of(*muscle))),
                "choose method and motion", "simulate");
    exit_code = kDone;
  });
  auto car = std::make_shared<Options>();
  CLI::App* vehicle = verb->add_subcommand("vehicle", "study of a road vehicle: study.toml in --out");
  vehicle->add_option("--log", car->log, "a drive log that the study is about; none: the drive is simulated")
      ->type_name("FILE");
  vehicle->add_flag("--force", car->force, "replace an existing study.toml");
  add_common(*vehicle, car->common, ".", "veridyn init vehicle --log drive.csv --out my_car");
  vehicle->callback([car, &exit_code] {
    const std::string data =
        car->log.empty() ? kNoDriveLog : filled(kDriveLog, "@LOG@", quoted_path(car->log, folder_of(*car)));
    write_study(*car, filled(kVehicleStudy, "@DATA@", data), "fill in the vehicle",
                car->log.empty() ? "simulate" : "identify");
    exit_code = kDone;
  });
  CLI::App* aircraft = verb->add_subcommand("aircraft", "study of an aircraft: study.toml in --out");
  verb->require_subcommand(1);
  aircraft->add_option("--log", options->log, "the log that the study is about")
      ->default_str("flight.bin")
      ->type_name("FILE");
  options->log = "flight.bin";
  aircraft->add_flag("--force", options->force, "replace an existing study.toml");
  add_common(*aircraft, options->common, ".", "veridyn init aircraft --log flight.bin --out my_aircraft");
  aircraft->callback([options, &exit_code] {
    write_study(*options, filled(kAircraftStudy, "@LOG@", quoted_path(options->log, folder_of(*options))),
                "fill in the subject");
    exit_code = kDone;
  });
}

}  // namespace veridyn::app
