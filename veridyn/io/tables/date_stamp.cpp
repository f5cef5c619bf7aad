#include "veridyn/io/tables/date_stamp.hpp"

#include <fmt/format.h>

#include <chrono>

namespace veridyn::io {
namespace {

/// View of a text: takes what a date stamp is made of from its front.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  [[nodiscard]] bool at_end() const { return rest_.empty(); }

  std::optional<int> digits(std::size_t fewest, std::size_t most) {
    std::size_t count = 0;
    int value = 0;
    while (count < most && count < rest_.size() && rest_[count] >= '0' && rest_[count] <= '9') {
      value = 10 * value + (rest_[count] - '0');
      ++count;
    }
    if (count < fewest) return std::nullopt;
    rest_.remove_prefix(count);
    return value;
  }

  /// The next character when it is one of `choices`, else 0.
  char one_of(std::string_view choices) {
    if (rest_.empty() || choices.find(rest_.front()) == std::string_view::npos) return '\0';
    const char found = rest_.front();
    rest_.remove_prefix(1);
    return found;
  }

  /// Decimals after the point.
  std::optional<double> fraction() {
    double value = 0.0;
    double weight = 0.1;
    std::size_t count = 0;
    while (!rest_.empty() && rest_.front() >= '0' && rest_.front() <= '9') {
      value += weight * (rest_.front() - '0');
      weight *= 0.1;
      rest_.remove_prefix(1);
      ++count;
    }
    return count > 0 ? std::optional(value) : std::nullopt;
  }

 private:
  std::string_view rest_;
};

}  // namespace

std::optional<DateStamp> parse_date_stamp(std::string_view text) {
  Scanner scan(text);
  const auto year = scan.digits(4, 4);
  const char in_date = year ? scan.one_of("-/._") : '\0';
  if (in_date == '\0') return std::nullopt;
  const auto month = scan.digits(1, 2);
  if (!month || scan.one_of(std::string_view(&in_date, 1)) == '\0') return std::nullopt;
  const auto day = scan.digits(1, 2);
  if (!day || scan.one_of(" T_") == '\0') return std::nullopt;
  const auto hour = scan.digits(1, 2);
  const char in_time = hour ? scan.one_of(":_") : '\0';
  if (in_time == '\0') return std::nullopt;
  const auto minute = scan.digits(1, 2);
  if (!minute || scan.one_of(std::string_view(&in_time, 1)) == '\0') return std::nullopt;
  const auto second = scan.digits(1, 2);
  if (!second) return std::nullopt;
  double fraction = 0.0;
  if (const char point = scan.one_of(".,_"); point == '_') {
    const auto milliseconds = scan.digits(1, 3);
    if (!milliseconds) return std::nullopt;
    fraction = 1e-3 * *milliseconds;
  } else if (point != '\0') {
    const auto decimals = scan.fraction();
    if (!decimals) return std::nullopt;
    fraction = *decimals;
  }
  scan.one_of("Z");
  if (!scan.at_end()) return std::nullopt;
  const std::chrono::year_month_day date(std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day)));
  // 60: a leap second.
  if (!date.ok() || *hour > 23 || *minute > 59 || *second > 60) return std::nullopt;
  return DateStamp{std::chrono::sys_days(date).time_since_epoch().count(),
                   3600.0 * *hour + 60.0 * *minute + *second + fraction};
}

std::string date_text(std::int64_t day) {
  const std::chrono::year_month_day date{std::chrono::sys_days(std::chrono::days(day))};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()));
}

}  // namespace veridyn::io
