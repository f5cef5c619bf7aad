#pragma once

#include <span>
#include <string>

#include "veridyn/estimation/result/analysis.hpp"
#include "veridyn/report/document/document.hpp"

/// What every identification reports in the same way, whatever the domain: parameters, methods, checks, prediction. A
/// section without blocks has nothing to say and is not shown.
namespace veridyn::report {

/// The badge of a group's verdict.
[[nodiscard]] Status status_of(estimation::GroupVerdict verdict);

/// The parameters of the groups that were not rejected, with the truth where it is known, in units for reading.
/// @param caption what a reader should know of this domain's parameters
[[nodiscard]] Section parameters_section(const estimation::Analysis& analysis, std::string caption);

/// What follows from the parameters, a table. @param caption where it is from
[[nodiscard]] Section derived_section(const estimation::Estimate& estimate, std::string title, std::string caption);

/// Estimates of all methods side by side, a plot for each group that was not rejected; methods that gave nothing say
/// why.
[[nodiscard]] Section methods_section(const estimation::Analysis& analysis);

/// Values of rejected groups, folded away under a warning.
[[nodiscard]] Section rejected_section(const estimation::Analysis& analysis);

/// The top of the report: the grades in a sentence, what decided, what to do.
[[nodiscard]] Verdict verdict_of(const estimation::Estimate& estimate);

/// Every row of the evidence, folded.
[[nodiscard]] Section evidence_section(const estimation::Estimate& estimate);

/// How well each quantity was predicted on data that identification did not see.
[[nodiscard]] Table prediction_table(std::span<const estimation::PredictedQuantity> predictions, std::string title);

}  // namespace veridyn::report
