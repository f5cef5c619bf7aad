#pragma once

#include <string>

namespace veridyn {

/// Something that must be seen, such as a published figure, with what was seen.
struct Check {
  bool passed = false;
  std::string text;
};

}  // namespace veridyn
