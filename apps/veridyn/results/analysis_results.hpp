#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "apps/veridyn/run/command.hpp"
#include "apps/veridyn/run/summary.hpp"
#include "veridyn/estimation/result/analysis.hpp"

namespace veridyn::app {

// Tables that every identification writes, whatever its domain.

/// parameters.csv: the parameters with intervals and status.
[[nodiscard]] std::string parameters_csv(const estimation::Estimate& estimate);

/// methods.csv: every method's figures for every parameter, group by group in the order in which methods were tried.
[[nodiscard]] std::string methods_csv(const estimation::Analysis& analysis);

/// The three grades in a sentence, then in five lines at most what decided and what to do.
void print_judgement(const CommonOptions& options, const estimation::Estimate& estimate);

/// A model as XML with a comment that says for which purposes it may be used; TOML: `estimation::graded_toml`.
[[nodiscard]] std::string graded_xml(const std::string& xml, const estimation::Judgement& judgement);

/// What `--json` says of any estimate, whatever command and domain: `folder`, `verdict` (a word), `sentence` (the three
/// grades), `groups` (each with name, verdict, reason and method), `estimate` (all of estimate.json). A command adds
/// what it has besides.
[[nodiscard]] Summary estimate_summary(const std::filesystem::path& folder, const estimation::Estimate& estimate,
                                       std::span<const estimation::ParameterGroup> groups = {});

}  // namespace veridyn::app
