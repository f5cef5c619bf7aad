#pragma once

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

/// The three grades in a line, then every row of the evidence that is less than passed, with what to do.
void print_judgement(const CommonOptions& options, const estimation::Estimate& estimate);

/// A model as XML with a comment that says for which purposes it may be used; TOML: `estimation::graded_toml`.
[[nodiscard]] std::string graded_xml(const std::string& xml, const estimation::Judgement& judgement);

/// The three grades and their reasons, for `--json`.
[[nodiscard]] Summary grades_summary(const estimation::Judgement& judgement);

}  // namespace veridyn::app
