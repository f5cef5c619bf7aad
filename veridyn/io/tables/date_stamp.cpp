#include "veridyn/io/tables/date_stamp.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>

#include "veridyn/core/text.hpp"

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

  /// `word` itself.
  bool take(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }

  /// The number of an English month in three letters, else 0.
  int month() {
    constexpr std::array<std::string_view, 12> kMonths = {"jan", "feb", "mar", "apr", "may", "jun",
                                                          "jul", "aug", "sep", "oct", "nov", "dec"};
    const std::string word = lower(rest_.substr(0, 3));
    for (std::size_t i = 0; i < kMonths.size(); ++i) {
      if (word != kMonths[i]) continue;
      rest_.remove_prefix(3);
      return static_cast<int>(i) + 1;
    }
    return 0;
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

/// Year, month and day, in the order in which they are written.
std::optional<std::int64_t> day_of(Scanner& scan) {
  int year = 0, month = 0, day = 0;
  const auto first = scan.digits(1, 4);
  const char between = first ? scan.one_of("-/._") : '\0';
  if (between == '\0') return std::nullopt;
  const std::string_view same(&between, 1);
  const bool year_first = *first > 31;
  if (const int named = between == '-' && !year_first ? scan.month() : 0; named > 0) {
    month = named;
  } else {
    // Day before month only where dots say that it is so: 12/09 is a day in September or in December.
    if (!year_first && between != '.') return std::nullopt;
    const auto number = scan.digits(1, 2);
    if (!number) return std::nullopt;
    month = *number;
  }
  const auto last = scan.one_of(same) != '\0' ? scan.digits(year_first ? 1 : 4, year_first ? 2 : 4) : std::nullopt;
  if (!last) return std::nullopt;
  year = year_first ? *first : *last;
  day = year_first ? *last : *first;
  const std::chrono::year_month_day date(std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day)));
  if (year < 1000 || !date.ok()) return std::nullopt;
  return std::chrono::sys_days(date).time_since_epoch().count();
}

/// Hours, minutes and seconds between `separators`, in seconds.
std::optional<double> time_of(Scanner& scan, std::string_view separators) {
  const auto hour = scan.digits(1, 2);
  const char between = hour ? scan.one_of(separators) : '\0';
  if (between == '\0') return std::nullopt;
  const auto minute = scan.digits(1, 2);
  if (!minute || scan.one_of(std::string_view(&between, 1)) == '\0') return std::nullopt;
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
  // 60: a leap second.
  if (*hour > 23 || *minute > 59 || *second > 60) return std::nullopt;
  return 3600.0 * *hour + 60.0 * *minute + *second + fraction;
}

/// What the clock is ahead of UTC [s], where the rest of a stamp says it.
std::optional<double> zone_of(Scanner& scan) {
  scan.one_of(" ");
  if (scan.take("Z") || scan.take("UTC") || scan.take("GMT")) return 0.0;
  const char sign = scan.one_of("+-");
  const auto hours = sign != '\0' ? scan.digits(2, 2) : std::nullopt;
  if (!hours) return std::nullopt;
  const bool colon = scan.one_of(":") != '\0';
  const auto minutes = scan.digits(2, 2);
  if ((colon && !minutes) || *hours > 14 || minutes.value_or(0) > 59) return std::nullopt;
  return (sign == '-' ? -60.0 : 60.0) * (60.0 * *hours + minutes.value_or(0));
}

}  // namespace

std::optional<DateStamp> parse_date_stamp(std::string_view text) {
  Scanner scan(text);
  const auto day = day_of(scan);
  if (!day || scan.one_of(" T_") == '\0') return std::nullopt;
  const auto second = time_of(scan, ":_");
  if (!second) return std::nullopt;
  DateStamp stamp{*day, *second, false};
  if (scan.at_end()) return stamp;
  const auto ahead = zone_of(scan);
  if (!ahead || !scan.at_end()) return std::nullopt;
  constexpr double kDay_s = 86400.0;
  const double utc = stamp.second - *ahead;
  const double days = utc < 0.0 ? -1.0 : (utc >= kDay_s && *ahead < 0.0 ? 1.0 : 0.0);
  return DateStamp{stamp.day + static_cast<std::int64_t>(days), utc - kDay_s * days, true};
}

std::optional<double> parse_time_of_day(std::string_view text) {
  Scanner scan(text);
  const auto second = time_of(scan, ":");
  return scan.at_end() ? second : std::nullopt;
}

std::string date_text(std::int64_t day) {
  const std::chrono::year_month_day date{std::chrono::sys_days(std::chrono::days(day))};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()));
}

}  // namespace veridyn::io
