#pragma once

#include <span>
#include <string>

#include "veridyn/estimation/uncertainty/result_indices.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// View of indices and of what they are of.
struct IndexedResult {
  const estimation::ResultIndices& indices;
  std::span<const std::string> inputs;  ///< names
  std::string quantity;                 ///< "the NRMSE"
  std::string unit = {};                ///< of Morris' effects; empty: none
  double factor = 1.0;                  ///< from the result to that unit
};

/// First and total order of one result with their intervals of `level`.
[[nodiscard]] IntervalPlot index_plot(const IndexedResult& result, double level);

/// Effects of Morris on one result.
[[nodiscard]] Table morris_table(const IndexedResult& result);

/// What first and total order, or Morris' effects, mean.
[[nodiscard]] Paragraph index_explanation(bool variance);

}  // namespace veridyn::report
