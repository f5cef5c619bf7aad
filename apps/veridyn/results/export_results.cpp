#include "apps/veridyn/results/export_results.hpp"

#include <fmt/format.h>

#include "apps/veridyn/run/console.hpp"
#include "veridyn/estimation/judgement/judgement.hpp"
#include "veridyn/io/results/estimate_json.hpp"

namespace veridyn::app {

std::optional<estimation::Estimate> given_estimate(const StudyRun& run) {
  const std::string& file = run.arguments.text("--estimate-file");
  if (file.empty()) return std::nullopt;
  return io::read_estimate(file);
}

bool is_graded(const std::optional<estimation::Estimate>& estimate) { return estimate && !estimate->evidence.empty(); }

void publish_export(const StudyRun& run, OutputFolder& folder, std::vector<std::filesystem::path> inputs,
                    const std::optional<estimation::Estimate>& estimate, const MoreResults& more) {
  const std::vector<std::string> files = folder.files();
  std::vector<Summary::Member> summary = {{"folder", folder.path().string()}, {"files", files}};
  summary.insert(summary.end(), more.summary.begin(), more.summary.end());
  folder.publish(run.record(0, std::move(inputs)), run.options(), Summary::object(std::move(summary)));
  for (const std::string& name : files)
    print_line(run.options(), fmt::format("wrote {}", (folder.path() / name).string()));
  for (const std::string& line : more.lines) print_line(run.options(), line);
  if (is_graded(estimate)) print_line(run.options(), estimation::sentence_of(*estimate));
}

}  // namespace veridyn::app
