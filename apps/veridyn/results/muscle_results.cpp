// What the commands on a person's tasks share: writing and printing their analysis.
#include "apps/veridyn/results/muscle_results.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/veridyn/results/analysis_results.hpp"
#include "apps/veridyn/results/posterior_results.hpp"
#include "apps/veridyn/results/profile_results.hpp"
#include "apps/veridyn/run/version.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/io/tables/csv_text.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/muscle_task_report.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::muscle;

std::string tasks_csv(const MuscleAnalysis& analysis) {
  std::string text = "task,use,nrmse_before,nrmse_after,rmse_before,rmse_after,range,reserve_share\n";
  for (const TaskOutcome& t : analysis.tasks) {
    text += fmt::format("{},{},{},{},{},{},{},{}\n", io::csv_text(t.name), t.hold_out ? "unseen" : "trained",
                        io::csv_number(t.before.nrmse), io::csv_number(t.after.nrmse), io::csv_number(t.before.rmse),
                        io::csv_number(t.after.rmse), io::csv_number(t.before.range), io::csv_number(t.reserve_share));
  }
  return text;
}

/// Every evaluation of the search.
std::string evaluations_csv(const MuscleAnalysis& analysis) {
  std::string text = "evaluation,kind,seconds,end";
  for (const TaskOutcome& t : analysis.tasks)
    if (!t.hold_out) text += "," + io::csv_text("NRMSE " + t.name);
  for (const estimation::Parameter& p : analysis.estimate.parameters) text += "," + io::csv_text(p.name);
  text += "\n";
  for (std::size_t i = 0; i < analysis.evaluations.size(); ++i) {
    const estimation::ModelEvaluation& e = analysis.evaluations[i];
    const bool failed = std::ranges::count(e.failed, 0) < signed_index(e.failed.size());
    text += fmt::format("{},{},{:.3g},{}", i + 1, e.derivatives ? "derivatives" : "values", e.seconds,
                        failed ? "failed" : "done");
    for (const double nrmse : e.misfit) text += "," + io::csv_number(nrmse);
    for (const double value : e.theta) text += "," + io::csv_number(value);
    text += "\n";
  }
  return text;
}

MoreResults more_of(const MuscleAnalysis& analysis) {
  MoreResults more{
      .summary = {{"seconds", analysis.result.seconds}, {"null_directions", analysis.result.null_directions}}};
  if (!analysis.profiles.profiles.empty()) more.summary.emplace_back("profiles", profiles_summary(analysis.profiles));
  if (analysis.posterior.usable()) more.summary.emplace_back("posterior", posterior_summary(analysis.posterior));
  for (const std::string& direction : analysis.result.null_directions)
    more.lines.push_back("  left to the priors: " + direction);
  for (const auto& lines : {profile_lines(analysis.profiles), posterior_lines(analysis.posterior)})
    more.lines.insert(more.lines.end(), lines.begin(), lines.end());
  for (const TaskOutcome& t : analysis.tasks)
    more.lines.push_back(fmt::format("  {:<12} {}: NRMSE {:.3g} -> {:.3g}", t.hold_out ? "unseen" : "trained", t.name,
                                     t.before.nrmse, t.after.nrmse));
  return more;
}

}  // namespace

void publish_muscles(const StudyRun& run, OutputFolder& folder, const TaskStudy& study,
                     const MuscleAnalysis& analysis) {
  const bool validation_only = run.command == "validate";
  folder.write("tasks.csv", tasks_csv(analysis));
  if (!validation_only) folder.write("evaluations.csv", evaluations_csv(analysis));
  write_profiles(folder, analysis.profiles, analysis.estimate.parameters);
  write_posterior(folder, analysis.posterior);
  if (!validation_only && estimation::usable(analysis.groups.front().verdict))
    folder.write("model.osim", study.subject.file->text_with(analysis.identified));
  folder.write("report.html",
               report::to_html(report::muscle_task_report(study, analysis, program_name(), validation_only)));
  publish_analysis(folder, run.record(study.seed, study.inputs), run.options(), analysis, more_of(analysis));
}

}  // namespace veridyn::app
