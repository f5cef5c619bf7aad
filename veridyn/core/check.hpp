#pragma once

#include <string>

namespace veridyn {

/// A check whose outcome is reported, such as the reproduction of a published figure: passed or not, and what was
/// found.
struct Check {
  bool passed = false;
  std::string text;
};

}  // namespace veridyn
