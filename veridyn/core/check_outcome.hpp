#pragma once

#include <string>

namespace veridyn {

/// What came of a check that is reported, such as the reproduction of a published figure: passed or not, and what was
/// found.
struct CheckOutcome {
  bool passed = false;
  std::string text;
};

}  // namespace veridyn
