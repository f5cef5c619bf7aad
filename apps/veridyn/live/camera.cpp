// veridyn camera calibrate|track|fuse: where a car is, from above.
#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/veridyn/live/camera_report.hpp"
#include "apps/veridyn/live/camera_track.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/camera/calibration/calibration_checks.hpp"
#include "veridyn/camera/calibration/calibration_file.hpp"
#include "veridyn/camera/fusion/fused_drive.hpp"
#include "veridyn/camera/tracking/pose_tables.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/report/document/html.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::camera;

constexpr std::uint64_t kSeed = 1;

/// The options of `--set`, as a study of their own.
Study options_of(const Arguments& arguments) { return Study::parse("", "--set", {}, arguments.common.overrides); }

RunRecord record_of(const std::string& command, const Study& options, std::uint64_t seed,
                    std::vector<std::filesystem::path> inputs) {
  return {
      .command = command, .study_name = "", .study_toml = options.to_toml(), .seed = seed, .inputs = std::move(inputs)};
}

void stop_if_interrupted(const Arguments& arguments) {
  if (arguments.common.interruption.requested()) throw Interrupted();
}

std::string residuals_csv(const CalibrationPoints& points, const Calibration& c) {
  std::string text = "line,world_x[m],world_y[m],image_x,image_y,off_x[m],off_y[m],off_image_x,off_image_y\n";
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    const CalibrationPoint& p = points.points[i];
    const CalibrationResidual& r = c.residuals[i];
    text += fmt::format("{},{},{},{},{},{},{},{},{}\n", p.line, p.track(0), p.track(1), p.image(0), p.image(1),
                        r.track(0), r.track(1), r.image(0), r.image(1));
  }
  return text;
}

int calibrate(const Arguments& arguments) {
  const CommonOptions& common = arguments.common;
  OutputFolder folder(common.out);
  const Study options = options_of(arguments);
  options.root().finish();
  const std::filesystem::path file = arguments.text("POINTS");
  const std::string& wanted = arguments.text("--distortion");
  const Distortion distortion = wanted == "none"     ? Distortion::kNone
                                : wanted == "radial" ? Distortion::kRadial
                                                     : Distortion::kAuto;
  const CalibrationPoints points = read_calibration_points(file);
  const Calibration c = fit_camera(points, distortion);
  const std::vector<CheckOutcome> checks = calibration_checks(points, c);
  const std::uint64_t seed = common.seed.value_or(kSeed);
  std::optional<HeldOut> held_out;
  if (points.points.size() >= 16) held_out = hold_out_half(points, distortion, seed);
  stop_if_interrupted(arguments);
  folder.write("calibration.toml", to_toml(c));
  folder.write("residuals.csv", residuals_csv(points, c));
  folder.write("report.html", report::to_html(calibration_report(points, c, held_out, checks, program_name())));
  Summary summary = Summary::object({{"folder", folder.path().string()},
                                     {"points", c.points},
                                     {"distorted", c.distorted},
                                     {"rms_track_m", c.rms_track},
                                     {"rms_image_px", c.rms_image},
                                     {"systematic_image_px", c.systematic_image},
                                     {"rms_held_out_m", held_out ? held_out->rms_held_out : kNaN}});
  for (const CheckOutcome& check : checks)
    summary["checks"].push_back(Summary::object({{"passed", check.passed}, {"text", check.text}}));
  folder.publish(record_of("camera calibrate", options, seed, {file}), common, summary);
  print_line(common,
             fmt::format("{} points: residuals of {:.2f} mm RMS on the track, {:.2f} px in the image{}", c.points,
                         1e3 * c.rms_track, c.rms_image, c.distorted ? "" : ", by a homography without distortion"));
  if (held_out)
    print_line(common,
               fmt::format("fitted on {} of them, the other {} are {:.2f} mm RMS off, {:.1f} mm at most",
                           held_out->fitted, held_out->held_out, 1e3 * held_out->rms_held_out, 1e3 * held_out->worst));
  for (const CheckOutcome& check : checks)
    if (!check.passed) print_line(common, "warning: " + check.text);
  print_line(common, fmt::format("wrote calibration.toml, residuals.csv, report.html in {}", folder.path().string()));
  return kDone;
}

int fuse_drive(const Arguments& arguments) {
  const CommonOptions& common = arguments.common;
  OutputFolder folder(common.out);
  const Study options = options_of(arguments);
  const FusionOptions fusion = FusionOptions::keys().read(options.root().table_or_empty("fusion"));
  options.root().finish();
  const std::filesystem::path inertial = arguments.text("INERTIAL"), poses = arguments.text("--poses");
  const FusedDrive drive = fuse(read_inertial(inertial), read_poses(poses), fusion);
  stop_if_interrupted(arguments);
  folder.write("motion.csv", to_csv(drive.motion));
  const FusedMotion& last = drive.motion.back();
  const double sigma = last.sigma(InertialModel::kOffset);
  Summary summary = Summary::object({{"folder", folder.path().string()},
                                     {"samples", drive.motion.size()},
                                     {"frames", drive.frames},
                                     {"left_out", drive.left_out},
                                     {"gaps", drive.gaps},
                                     {"offset_s", last.offset},
                                     {"sigma_offset_s", sigma}});
  for (const auto& innovation : drive.innovations) summary["nis"].push_back(innovation.nis);
  folder.publish(record_of("camera fuse", options, 0, {inertial, poses}), common, summary);
  print_line(common, fmt::format("{} samples, {} frames ({} left out); the stamps of the camera are {:+.1f} ms (95 %: "
                                 "+- {:.1f}) off",
                                 drive.motion.size(), drive.frames, drive.left_out, 1e3 * last.offset, 1960.0 * sigma));
  if (drive.gaps > 0) print_line(common, fmt::format("warning: the fusion began again after {} gaps", drive.gaps));
  constexpr double kShareRejected = 0.2;
  for (std::size_t i = 0; i < drive.innovations.size(); ++i) {
    const auto& s = drive.innovations[i];
    if (s.count > 0 && static_cast<double>(s.rejected) > kShareRejected * static_cast<double>(s.count))
      print_line(common,
                 fmt::format("warning: {} of {} measurements of {} contradict the inertial sensors: are the axes "
                             "x forward, y left, z up, and is the accelerometer a - g (+9.8 upwards at rest)?",
                             s.rejected, s.count,
                             i == 0   ? "x"
                             : i == 1 ? "y"
                                      : "the heading"));
  }
  print_line(common, fmt::format("wrote motion.csv in {}", folder.path().string()));
  return kDone;
}

}  // namespace

Command camera_command() {
  return {.name = "camera",
          .summary = "where a car is on its track, by a camera above it",
          .commands = {
              {.name = "calibrate",
               .summary = "the map from track to image: calibration.toml, residuals and a report",
               .arguments = {{.name = "POINTS",
                              .help = "table of points: world_x, world_y (of the track), image_x, image_y (pixels)",
                              .type = "FILE",
                              .required = true},
                             {.name = "--distortion",
                              .help = "what of the lens is fitted",
                              .value = "auto",
                              .choices = {"auto", "none", "radial"}}},
               .default_out = "out/camera",
               .example = "veridyn camera calibrate points.csv --out camera",
               .run = calibrate},
              camera_track_command(),
              {.name = "fuse",
               .summary = "inclination and acceleration separately, from inertial sensors and the camera's poses",
               .arguments = {{.name = "INERTIAL",
                              .help = "table: time, rate_x, rate_y, rate_z, force_x, force_y, force_z",
                              .type = "FILE",
                              .required = true},
                             {.name = "--poses",
                              .help = "measured_poses.csv of `veridyn camera track`",
                              .type = "FILE",
                              .required = true}},
               .default_out = "out/camera_fuse",
               .example = "veridyn camera fuse imu.csv --poses out/camera_track/measured_poses.csv",
               .run = fuse_drive}}};
}

}  // namespace veridyn::app
