#include "veridyn/core/option_check.hpp"

#include <fmt/format.h>

#include "veridyn/core/error.hpp"

namespace veridyn {

void OptionCheck::operator()(bool holds, std::string_view option, double value, std::string_view rule) const {
  if (!holds) throw InputError(fmt::format("{}.{}", group_, option), fmt::format("is {}; must be {}", value, rule));
}

}  // namespace veridyn
