// veridyn identify STUDY with [swing_test] or [calibration]: what is measured on the ground.
#include <fmt/format.h>

#include <utility>
#include <vector>

#include "apps/veridyn/results/analysis_results.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/aircraft/sensors/air_data_calibration.hpp"
#include "veridyn/aircraft/sensors/swing_test.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/ground_report.hpp"

namespace veridyn::app {
namespace {

/// What every one of these writes, whatever it identified.
struct GroundResult {
  estimation::Analysis analysis;
  report::Document document;
  std::vector<std::pair<std::string, std::string>> files;  ///< name and content
  std::vector<std::string> lines;                          ///< for people
  std::vector<std::filesystem::path> inputs;
  std::uint64_t seed = 0;
};

void publish(const StudyRun& run, OutputFolder& folder, const GroundResult& result) {
  folder.write("report.html", report::to_html(result.document));
  for (const auto& [name, content] : result.files) folder.write(name, content);
  publish_analysis(folder, run.record(result.seed, result.inputs), run.options(), result.analysis,
                   {.lines = result.lines});
}

std::uint64_t seed_of(const Study& study) {
  static_cast<void>(study.root().text_or("title", ""));
  return static_cast<std::uint64_t>(study.root().integer_or("seed", 1));
}

GroundResult swing_test(const Study& study, Progress& progress) {
  aircraft::SwingTest test = aircraft::SwingTest::keys().read(study.root().table("swing_test"));
  test.seed = seed_of(study);
  study.root().finish();
  const aircraft::SwingTestResult analysis = aircraft::analyse_swing_test(test, progress);
  GroundResult result;
  result.seed = test.seed;
  result.analysis.estimate = analysis.estimate;
  result.document = report::swing_test_report(test, analysis, program_name());
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
  const aircraft::CalibrationStudy points = aircraft::CalibrationStudy::keys().read(study.root().table("calibration"));
  GroundResult result;
  result.seed = seed_of(study);
  study.root().finish();
  progress.stage("fitting the calibration");
  const aircraft::CalibrationResult analysis = aircraft::calibrate(points);
  result.analysis.estimate = analysis.estimate;
  result.document = report::calibration_report(points, analysis, program_name());
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

template <typename Analyse>
int identify_ground(const StudyRun& run, const Analyse& analyse) {
  OutputFolder folder(run.options().out);
  TerminalProgress progress = progress_of(run.options());
  const GroundResult result = analyse(run.study, progress);
  if (progress.interrupted()) throw Interrupted();
  publish(run, folder, result);
  return kDone;
}

}  // namespace

int identify_swing_test(const StudyRun& run) { return identify_ground(run, swing_test); }
int identify_calibration(const StudyRun& run) { return identify_ground(run, calibration); }

}  // namespace veridyn::app
