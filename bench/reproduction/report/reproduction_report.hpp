#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/check_outcome.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// A published result alongside ours, whatever the domain.
struct ReproducedRow {
  std::string title = {};
  std::string finding = {};               ///< what was published, in words
  std::string ours = {};                  ///< how it was done here, in a sentence
  std::vector<CheckOutcome> checks = {};  ///< what must be seen
  std::vector<Block> blocks = {};         ///< numbers side by side, pictures

  [[nodiscard]] bool passed() const;
};

/// The report of `veridyn reproduce DOMAIN`: a table of all rows, then each row with its checks and blocks.
[[nodiscard]] Document reproduction_report(const std::string& domain, std::span<const ReproducedRow> rows,
                                           const std::string& program);

}  // namespace veridyn::report
