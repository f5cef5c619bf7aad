#pragma once

#include <span>
#include <string>

#include "veridyn/estimation/uncertainty/result_indices.hpp"

namespace veridyn::io {

/// indices.csv: a row for each result and input: first and total order with their intervals and whether these are wide,
/// or mu, mu* and sigma of Morris.
[[nodiscard]] std::string indices_csv(std::span<const estimation::ResultIndices> results,
                                      std::span<const std::string> inputs, estimation::IndexMethod method);

}  // namespace veridyn::io
