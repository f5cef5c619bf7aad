#pragma once

#include <string>

namespace veridyn::estimation {

/// One check of an estimate: a statistic against its limit, with the sentence that a report prints.
struct Evidence {
  std::string name = {};
  bool passed = true;
  double value = 0.0;
  double limit = 0.0;
  std::string text = {};
};

}  // namespace veridyn::estimation
