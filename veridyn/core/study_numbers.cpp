#include "veridyn/core/study_numbers.hpp"

#include <fmt/format.h>

namespace veridyn {

std::size_t count_or(const StudyTable& table, const char* key, std::size_t otherwise, long long least) {
  const long long value = table.integer_or(key, static_cast<long long>(otherwise));
  constexpr long long kMost = 10000000;
  if (value < least || value > kMost) table.fail(key, fmt::format("= {} must be from {} to {}", value, least, kMost));
  return static_cast<std::size_t>(value);
}

double share_or(const StudyTable& table, const char* key, double otherwise, double most) {
  const double value = table.number_or(key, "1", otherwise);
  if (!(value > 0.0 && value <= most))
    table.fail(key, fmt::format("= {:g} must be above 0 and at most {:g}; \"5 %\" is 0.05", value, most));
  return value;
}

}  // namespace veridyn
