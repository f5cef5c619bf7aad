#pragma once

#include <string>
#include <vector>

#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/estimation/result/analysis.hpp"

namespace veridyn::app {

/// What a command has besides the analysis that all domains share.
struct MoreResults {
  std::vector<Summary::Member> summary = {};  ///< for `--json`
  std::vector<std::string> lines = {};        ///< for people, after parameters and predictions
};

/// Writes, publishes and prints what an estimate says, whatever command and domain. Files: estimate.json,
/// parameters.csv, methods.csv (every method's figures for every parameter, where several were tried), run.json, beside
/// report.html and what the domain wrote. `--json`: `folder`, `verdict` (a word), `sentence` (the three grades),
/// `groups` (each with name, verdict, reason and method), `estimate` (all of estimate.json), then `more`. For people:
/// the three grades in a sentence, five lines at most on what decided and what to do, groups, parameters, predictions,
/// `more`, warnings.
void publish_analysis(OutputFolder& folder, const RunRecord& record, const CommonOptions& options,
                      const estimation::Analysis& analysis, const MoreResults& more = {});

/// A model as XML with a comment that says for which purposes it may be used; TOML: `estimation::graded_toml`.
[[nodiscard]] std::string graded_xml(const std::string& xml, const estimation::Judgement& judgement);

}  // namespace veridyn::app
