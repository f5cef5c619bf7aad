#pragma once

#include <string>

#include "veridyn/estimation/analysis.hpp"

namespace veridyn::app {

// Tables that every identification writes, whatever its domain.

/// parameters.csv: the parameters with intervals and status.
[[nodiscard]] std::string parameters_csv(const estimation::Estimate& estimate);

/// methods.csv: every method's figures for every parameter, group by group in the order in which methods were tried.
[[nodiscard]] std::string methods_csv(const estimation::Analysis& analysis);

}  // namespace veridyn::app
