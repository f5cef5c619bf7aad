#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/judgement.hpp"

namespace veridyn::test {

/// In how many recordings a check was with care, and in how many it failed.
struct Alarms {
  std::size_t care = 0, failed = 0;
};

/// What is said of recordings without a fault: every alarm is a false one.
struct CleanRecordings {
  std::size_t count = 0, data_yes = 0, refused = 0;
  std::map<estimation::Check, Alarms> alarms = {};  ///< of every check that bears on a grade
  std::vector<std::string> sentences = {};          ///< of rows of a recording whose data are not graded yes

  /// Several rows of a check in one recording count once, by the worst; what is missing is no alarm.
  void add(std::span<const estimation::Evidence> rows, const estimation::Judgement& judgement);
  /// Checks that raised an alarm, "| row | with care | failed |", and the share of data graded yes.
  [[nodiscard]] std::string table() const;
};

}  // namespace veridyn::test
