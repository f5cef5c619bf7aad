#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"

namespace veridyn::estimation {

/// A line on why grades are not "yes", or on what to do about it.
struct Reason {
  Outcome outcome = Outcome::kPassed;  ///< of the row
  std::string text = {};
  bool is_advice = false;
  std::size_t row = 0;  ///< index of the row that it is from
};

/// The few lines that a reader takes in.
struct Reasons {
  std::vector<Reason> lines = {};
  std::size_t left_out = 0;  ///< rows that did not pass and are not among them

  /// Whether the sentence of the row at this index is one of the lines.
  [[nodiscard]] bool quotes(std::size_t row) const;
};

/// What decided and what to do: rows that did not pass and bear on a grade, the worst first, each with its advice, no
/// sentence twice, `most` lines at most. Of rows that differ only in what they are about the first is quoted, and the
/// others are named after it.
[[nodiscard]] Reasons reasons_of(std::span<const Evidence> rows, std::size_t most = 5);

}  // namespace veridyn::estimation
