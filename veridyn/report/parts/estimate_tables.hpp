#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/recursive/change_detection.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/report/document/document.hpp"

/// Estimates, checks, fits and changes as tables: the same rows for every domain.
namespace veridyn::report {

/// The badge of a parameter's status.
[[nodiscard]] Status status_of(estimation::ParameterStatus status);

/// Value, sigma and both ends of the 95 % interval, with as many decimals as sigma deserves.
[[nodiscard]] std::vector<Cell> interval_cells(double value, double sigma, double low95, double high95);

/// The columns "parameter, value, sigma, 95 % from, to, unit, status", and "truth" where it is known.
[[nodiscard]] std::vector<Column> parameter_columns(bool with_truth);

/// A row of these columns without the truth. @param factor from the estimate's unit to `unit`
[[nodiscard]] Row parameter_row(const estimation::Parameter& parameter, double factor, std::string unit);

/// The columns of a check: "check, value, limit, unit, what was seen, bears on".
[[nodiscard]] std::vector<Column> evidence_columns();

/// A row of these columns: value with its standard error, and the limit, in the unit that people read ("at most 5
/// deg").
/// @param said  whether its sentence stands on the first screen, which is not repeated
[[nodiscard]] Row evidence_row(const estimation::Evidence& row, bool said);

/// "innovation moved by 3.1 sigma": what was noticed.
[[nodiscard]] std::string change_words(const estimation::Change& change);

/// What changed, when it was detected and when it began, and what was noticed.
[[nodiscard]] Row change_row(std::string what, const estimation::Change& change);

/// The columns of `change_row`.
[[nodiscard]] std::vector<Column> change_columns(std::string what, std::string noticed);

}  // namespace veridyn::report
