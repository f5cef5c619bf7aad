#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/search/black_box_problem.hpp"

namespace veridyn::estimation {

/// One evaluation of a search.
struct SearchEvaluation {
  Eigen::VectorXd x;
  SearchValues values;
  double seconds = 0.0;  ///< it took
};

/// All evaluations of a search as a file, which is the search's checkpoint too: a search follows from its options and
/// the values that it was given, so that one which is answered from the log as far as it goes continues bit for bit.
///
/// A table with comments:
///
///     # veridyn search log, format 1
///     # problem: elbow
///     # parameter 1: BRA.F0 from 0.95 to 1.05
///     # tasks: 1 5 9
///     evaluation,seconds,end,objective,task 1,BRA.F0
///     1,0.0021,done,0.13,0.03,0.9712
///     # batch of 1, check 8a3c...
///
/// `end` is "done" or "failed" (NaN). A batch counts once its last line, with a checksum, is there: whatever kills the
/// program, the log holds whole batches, and what stands behind the last of them is dropped.
class SearchLog {
 public:
  /// Kept in memory only.
  SearchLog() = default;
  /// Opens or begins the log at `path`. @throws InputError where the file is none, of another format, or of another
  /// problem: with what differs; where it is damaged before its end; where it cannot be written.
  SearchLog(const BlackBoxProblem& problem, std::filesystem::path path);

  [[nodiscard]] std::span<const SearchEvaluation> evaluations() const { return evaluations_; }
  /// Of them were there when the log was opened.
  [[nodiscard]] std::size_t loaded() const { return loaded_; }
  /// Empty: in memory only.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Adds a batch, to the file too. @throws std::runtime_error when that cannot be written.
  void append(std::span<const SearchEvaluation> batch);

 private:
  std::filesystem::path path_;
  std::vector<SearchEvaluation> evaluations_;
  std::size_t loaded_ = 0;
};

}  // namespace veridyn::estimation
