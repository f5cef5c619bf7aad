// What `veridyn sensitivity` of vehicles and aircraft shares: running, writing and printing which input moves which
// result of a simulated motion.
#include "apps/veridyn/results/response_results.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "apps/veridyn/results/checkpoint.hpp"
#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/io/results/indices_csv.hpp"
#include "veridyn/report/document/html.hpp"

namespace veridyn::app {
namespace {

using estimation::ResponseIndices;

Summary summary_of(const ResponseIndices& r, const std::filesystem::path& folder,
                   const report::ResponseReportContext& context) {
  Summary s;
  s["folder"] = folder.string();
  s["what"] = context.what;
  s["runs"] = r.runs;
  s["failed"] = r.failed;
  s["inputs"] = Summary::array();
  for (const estimation::IndexInput& i : r.inputs)
    s["inputs"].push_back(Summary::object(
        {{"name", i.name}, {"unit", i.unit}, {"nominal", i.nominal}, {"low", i.low}, {"high", i.high}}));
  s["indices"] = Summary::array();
  for (std::size_t k = 0; k < r.results.size(); ++k) {
    Summary one = indices_summary(r.results[k], r.input_names());
    one["unit"] = r.responses[k].unit;
    one["nominal"] = r.responses[k].nominal;
    if (!r.results[k].variance.inputs.empty()) {
      one["mean"] = r.results[k].variance.mean;
      one["sd"] = std::sqrt(r.results[k].variance.variance);
    }
    s["indices"].push_back(std::move(one));
  }
  s["constant"] = r.constant;
  s["warnings"] = r.warnings;
  s["notes"] = context.notes;
  return s;
}

/// "C_f 61 %, mass 20 %": the total orders of the strongest, or their mu*.
std::string strongest(const ResponseIndices& r, std::size_t result) {
  constexpr std::size_t kInputsShown = 3;
  constexpr double kLeastIndexShown = 0.01;
  const bool variance = !r.results[result].variance.inputs.empty();
  std::vector<std::pair<double, std::string>> inputs;
  for (std::size_t i = 0; i < r.inputs.size(); ++i)
    inputs.emplace_back(variance ? r.results[result].variance.inputs[i].total : r.results[result].morris[i].absolute,
                        r.inputs[i].name);
  std::ranges::stable_sort(inputs, std::greater<>(), &std::pair<double, std::string>::first);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < std::min(kInputsShown, inputs.size()); ++i) {
    const auto& [value, name] = inputs[i];
    if (!variance)
      texts.push_back(fmt::format("{} {:.3g}", name, value));
    else if (value >= kLeastIndexShown)
      texts.push_back(fmt::format("{} {:.0f} %", name, 100.0 * value));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

bool usable(const ResponseIndices& r) {
  return std::ranges::any_of(r.results, [](const auto& one) {
    return !one.variance.inputs.empty() ||
           std::ranges::any_of(one.morris, [](const auto& e) { return e.absolute > 0.0; });
  });
}

void print_indices(const CommonOptions& options, const ResponseIndices& r) {
  for (std::size_t k = 0; k < r.results.size(); ++k) {
    if (r.results[k].variance.inputs.empty() && r.results[k].morris.empty()) continue;
    print_line(options, fmt::format("  {:<34} {}", r.responses[k].name, strongest(r, k)));
  }
}

}  // namespace

Summary indices_summary(const estimation::ResultIndices& r, const std::vector<std::string>& inputs) {
  Summary s;
  s["result"] = r.result;
  s["failed"] = r.failed;
  s["inputs"] = Summary::object();
  for (std::size_t i = 0; i < r.variance.inputs.size(); ++i) {
    const numerics::SensitivityIndex& x = r.variance.inputs[i];
    s["inputs"][inputs[i]] = Summary::object({{"first", x.first},
                                              {"first_low", x.first_low},
                                              {"first_high", x.first_high},
                                              {"total", x.total},
                                              {"total_low", x.total_low},
                                              {"total_high", x.total_high}});
  }
  for (std::size_t i = 0; i < r.morris.size(); ++i)
    s["inputs"][inputs[i]] =
        Summary::object({{"mu", r.morris[i].mean}, {"mu_star", r.morris[i].absolute}, {"sigma", r.morris[i].sd}});
  return s;
}

int run_responses(const StudyRun& run, const std::function<PreparedResponses(Progress&)>& prepare) {
  const Checkpoint checkpoint = checkpoint_of(run.arguments);
  const CommonOptions& options = checkpoint.options;
  std::optional<OutputFolder> folder;
  if (checkpoint.first()) folder.emplace(options.out);
  TerminalProgress progress = progress_of(options);
  const PreparedResponses study = prepare(progress);
  numerics::BlockStore store = open_store(checkpoint, run, study.inputs);
  progress.stage(study.stage);
  const ResponseIndices result = study.analyse(store, progress);
  if (!result.completed) return checkpoint.stopped(store);
  if (!checkpoint.first()) return kDone;
  progress.stage("writing the results");
  folder->write("indices.csv", io::indices_csv(result.results, result.input_names(), study.options.method));
  folder->write("report.html", report::to_html(report::response_report(result, study.options, study.context)));
  const std::string files = fmt::format("{}", fmt::join(folder->files(), ", "));
  folder->publish(run.record(study.options.variance.seed, study.inputs), options,
                  summary_of(result, folder->path(), study.context));
  for (const std::string& warning : store.warnings()) print_line(options, "warning: " + warning);
  for (const std::string& warning : result.warnings) print_line(options, "warning: " + warning);
  if (!usable(result))
    throw std::runtime_error(fmt::format("no result has indices; why is in {}: {}", folder->path().string(), files));
  print_line(options, fmt::format("{}: {} inputs, {} runs", study.context.what, result.inputs.size(), result.runs));
  print_indices(options, result);
  if (!checkpoint.folder.empty())
    print_line(options,
               fmt::format("{} of {} blocks were in {}", store.found(), store.blocks(), checkpoint.folder.string()));
  print_line(options, fmt::format("wrote {} in {}", files, folder->path().string()));
  return kDone;
}

void refuse_recording(const StudyTable& root, const char* simulated) {
  if (!names_recording(root)) return;
  root.fail("data", fmt::format("names a recording, whose parameters cannot be varied: sensitivity is of what {} "
                                "simulates; `veridyn identify` says what a recording determines",
                                simulated));
}

}  // namespace veridyn::app
