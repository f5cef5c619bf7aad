#pragma once

#include <string>

#include "veridyn/estimation/regression/regression_judgement.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// The report of `veridyn regress`: grades, parameters, all methods, measured against modelled, residuals, evidence.
/// @param source the table
[[nodiscard]] Document regression_report(const estimation::JudgedRegression& result, const std::string& source,
                                         const std::string& program);

}  // namespace veridyn::report
