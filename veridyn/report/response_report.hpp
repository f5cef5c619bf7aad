#pragma once

#include <string>
#include <vector>

#include "veridyn/estimation/uncertainty/response_indices.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// What a report of `response_indices` says of its study, whatever the domain.
struct ResponseReportContext {
  std::string program;
  std::string title;
  std::string subject;           ///< "A simulated drive: sensitivity"
  std::string what;              ///< that was simulated: "step steer of the reference car at 72 km/h"
  std::vector<Fact> facts = {};  ///< of the domain
  std::vector<std::string> notes = {};
};

/// The report of `veridyn sensitivity` of a simulated motion: which input moves which result as a heat map, how far
/// results go, first and total order with their intervals (or Morris' effects) of each.
[[nodiscard]] Document response_report(const estimation::ResponseIndices& indices,
                                       const estimation::IndexOptions& options, const ResponseReportContext& context);

}  // namespace veridyn::report
