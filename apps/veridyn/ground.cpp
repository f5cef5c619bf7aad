// veridyn identify STUDY with [swing_test] or [calibration]: what is measured on the ground.
#include "apps/veridyn/ground.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "apps/veridyn/results.hpp"
#include "veridyn/aircraft/sensors/air_data_calibration.hpp"
#include "veridyn/aircraft/sensors/swing_test.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/ground_report.hpp"

namespace veridyn::app {
namespace {

constexpr const char* kProgram = "veridyn " VERIDYN_VERSION;

/// What every one of these writes, whatever it identified.
struct GroundResult {
  estimation::Estimate estimate;
  report::Document document;
  std::vector<std::pair<std::string, std::string>> files;  ///< name and content
  std::vector<std::string> lines;                          ///< for people
  std::vector<std::filesystem::path> inputs;
  std::uint64_t seed = 0;
};

void write(const GroundResult& result, const Study& study, const std::string& path, const CommonOptions& options) {
  const std::filesystem::path folder = options.out;
  make_folder(folder);
  report::write_html(result.document, folder / "report.html");
  for (const auto& [name, content] : result.files) write_file(folder / name, content);
  write_file(folder / "parameters.csv", parameters_csv(result.estimate));
  write_file(folder / "estimate.json", io::to_json(result.estimate));
  RunRecord run{"identify", study.name(), study.to_toml(), result.seed, result.inputs};
  run.inputs.emplace_back(path);
  write_run_record(folder, run, options);
  for (const std::string& line : result.lines) tell(options, line);
  for (const std::string& warning : result.estimate.warnings) tell(options, "warning: " + warning);
  tell(options, fmt::format("report: {}", (folder / "report.html").string()));
  nlohmann::ordered_json summary;
  summary["verdict"] = result.estimate.verdict;
  summary["folder"] = folder.string();
  for (const auto& p : result.estimate.parameters) {
    summary["parameters"][p.name] = {{"value", p.value},
                                     {"sigma", p.sigma},
                                     {"unit", p.unit},
                                     {"status", std::string(estimation::to_string(p.status))}};
  }
  summary["warnings"] = result.estimate.warnings;
  print_summary(summary, options);
}

std::uint64_t seed_of(const Study& study) {
  static_cast<void>(study.root().text_or("title", ""));
  return static_cast<std::uint64_t>(study.root().integer_or("seed", 1));
}

GroundResult swing_test(const Study& study, Progress& progress) {
  aircraft::SwingTest test = aircraft::SwingTest::read(study.root().table("swing_test"));
  test.seed = seed_of(study);
  study.root().finish();
  const aircraft::SwingTestResult analysis = aircraft::analyse_swing_test(test, progress);
  GroundResult result;
  result.seed = test.seed;
  result.estimate = analysis.estimate;
  result.document = report::swing_test_report(test, analysis, kProgram);
  result.files.emplace_back("subject.toml", aircraft::inertia_toml(test, analysis));
  for (const aircraft::AxisInertia& i : analysis.axes) {
    result.lines.push_back(fmt::format(
        "  {:<15} {}", i.verdict == aircraft::InertiaVerdict::kDetermined ? "determined" : "not determined", i.reason));
    result.inputs.insert(result.inputs.end(), i.test.files.begin(), i.test.files.end());
    result.inputs.insert(result.inputs.end(), i.test.cradle_files.begin(), i.test.cradle_files.end());
  }
  return result;
}

GroundResult calibration(const Study& study, Progress& progress) {
  const aircraft::CalibrationStudy points = aircraft::CalibrationStudy::read(study.root().table("calibration"));
  GroundResult result;
  result.seed = seed_of(study);
  study.root().finish();
  progress.stage("fitting the calibration");
  const aircraft::CalibrationResult analysis = aircraft::calibrate(points);
  result.estimate = analysis.estimate;
  result.document = report::calibration_report(points, analysis, kProgram);
  std::vector<aircraft::SensorCalibration> sensors;
  for (const aircraft::SensorFit& fit : analysis.sensors) {
    if (fit.usable) sensors.push_back(fit.calibration);
    const auto& c = fit.calibration;
    result.lines.push_back(fmt::format("  {:<17} raw = {:.4g} + {:.5g} true, residual rms {:.3g} {}, worst {:.3g}",
                                       c.channel, c.bias, c.scale, fit.rms, fit.unit, fit.worst));
  }
  if (!sensors.empty())
    result.files.emplace_back("calibration.toml", aircraft::calibration_toml(sensors, points.file.filename().string()));
  result.files.emplace_back("residuals.csv", aircraft::residuals_csv(analysis));
  result.inputs = {points.file};
  return result;
}

}  // namespace

bool is_ground_study(const Study& study) { return study.root().has("swing_test") || study.root().has("calibration"); }

int identify_ground(const Study& study, const std::string& path, const CommonOptions& options) {
  TerminalProgress progress(options.quiet);
  write(study.root().has("swing_test") ? swing_test(study, progress) : calibration(study, progress), study, path,
        options);
  return kDone;
}

}  // namespace veridyn::app
