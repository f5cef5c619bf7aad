#include "veridyn/core/study_keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/units.hpp"

namespace veridyn {

namespace {

/// A long number in plain figures: 3600000, not 3.6e+06; 0 with a unit is 0.
std::string plain(double x) {
  return x == std::round(x) && std::abs(x) < 1e16 ? fmt::format("{:.0f}", x) : fmt::format("{:.6g}", x);
}

/// An angle, or a rate of one, in degrees where that is the rounder number.
bool rounder_in_degrees(double si, const Unit& degrees) {
  const double number = degrees.from_si(si);
  const auto round = [](double x) { return std::abs(x * 100.0 - std::round(x * 100.0)) < 1e-6; };
  return si != 0.0 && !round(si) && round(number);
}

/// "60 deg", "3 m/s"; a number without dimension alone.
std::string with_unit(double si, std::string_view unit) {
  if (unit.empty() || unit == "1") return plain(si);
  for (const auto& [radians, degrees] : {std::pair{"rad", "deg"}, std::pair{"rad/s", "deg/s"}})
    if (unit == radians && rounder_in_degrees(si, parse_unit(degrees)))
      return fmt::format("{} {}", plain(parse_unit(degrees).from_si(si)), degrees);
  return fmt::format("{} {}", plain(si), unit);
}

}  // namespace

std::string KeyRange::text(std::string_view unit) const {
  const bool bounded_low = std::isfinite(low), bounded_high = std::isfinite(high);
  double scale = 1.0;
  std::string name(unit == "1" ? "" : unit);
  for (const auto& [radians, degrees] : {std::pair{"rad", "deg"}, std::pair{"rad/s", "deg/s"}}) {
    const Unit other = parse_unit(degrees);
    if (unit != radians ||
        (!(bounded_low && rounder_in_degrees(low, other)) && !(bounded_high && rounder_in_degrees(high, other))))
      continue;
    scale = other.scale;
    name = degrees;
  }
  const bool of_zero = (!bounded_low || low == 0.0) && (!bounded_high || high == 0.0);
  if (!name.empty()) name = of_zero ? "" : " " + name;
  const std::string a = plain(low / scale), b = plain(high / scale);
  if (!bounded_low && !bounded_high) return {};
  if (!bounded_high) return fmt::format("{} {}{}", with_low ? ">=" : ">", a, name);
  if (!bounded_low) return fmt::format("{} {}{}", with_high ? "<=" : "<", b, name);
  if (with_low && with_high) return fmt::format("from {} to {}{}", a, b, name);
  if (!with_low && !with_high) return fmt::format("between {} and {}{}", a, b, name);
  return with_high ? fmt::format("above {} and at most {}{}", a, b, name)
                   : fmt::format("at least {} and below {}{}", a, b, name);
}

std::string heading_of(const StudyKeys& table) {
  return table.repeated ? fmt::format("[[{}]]", table.table) : fmt::format("[{}]", table.table);
}

std::string in_markdown(const StudyKeys& table) {
  std::string text =
      fmt::format("| `{}` | unit | default | values | meaning |\n| --- | --- | --- | --- | --- |\n", heading_of(table));
  for (const StudyKey& key : table.keys)
    text += fmt::format("| `{}` | {} | {} | {} | {} |\n", key.name, key.unit == "1" ? "" : key.unit,
                        key.in_words || key.otherwise.empty() ? key.otherwise : fmt::format("`{}`", key.otherwise),
                        key.range, key.says);
  return table.about.empty() ? text : fmt::format("{}\n\n{}", table.about, text);
}

std::string commented_line(const StudyKey& key) {
  const std::string left =
      fmt::format("# {} = {}", key.name, key.otherwise.empty() || key.in_words ? "..." : key.otherwise);
  // The rest of the sentence is in the docs.
  std::string right = key.says.substr(0, key.says.find(';'));
  if (key.range.find('`') != std::string::npos) right += ": " + key.range;
  if (key.in_words) right += "; by default " + key.otherwise;
  std::erase(right, '`');
  constexpr std::size_t kColumn = 35, kWidth = 120;
  std::string lines = fmt::format("{:<{}}#", left, std::max(kColumn, left.size() + 1));
  std::size_t used = lines.size();
  std::istringstream words(right);
  for (std::string word; words >> word; used += 1 + word.size()) {
    if (used + 1 + word.size() > kWidth) {
      lines += fmt::format("\n{:<{}}#", "", kColumn);
      used = kColumn + 1;
    }
    lines += ' ' + word;
  }
  return lines + '\n';
}

std::string with_keys(std::string_view study, const std::vector<StudyKeys>& tables) {
  std::istringstream lines{std::string(study)};
  std::string filled;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string mark, table, key;
    words >> mark >> table;
    if (mark != "@keys") {
      filled += line + '\n';
      continue;
    }
    const auto found = std::ranges::find(tables, table, &StudyKeys::table);
    if (found == tables.end()) throw std::logic_error("no table " + table);
    while (words >> key) {
      const auto of = std::ranges::find(found->keys, key, &StudyKey::name);
      if (of == found->keys.end()) throw std::logic_error(fmt::format("no key {}.{}", table, key));
      filled += commented_line(*of);
    }
  }
  return filled;
}

std::string quoted_list(const std::vector<std::string>& texts, std::string_view mark) {
  std::string all;
  for (const std::string& text : texts) all += fmt::format("{}{}\"{}\"{}", all.empty() ? "" : ", ", mark, text, mark);
  return all;
}

void refuse_missing(const StudyTable& table, const std::vector<std::string>& keys) {
  if (keys.empty()) return;
  if (keys.size() == 1) table.fail(keys.front(), "is missing");
  throw InputError(table.place(""), fmt::format("{} are missing", fmt::join(keys, ", ")));
}

void require_keys(const StudyTable& table, std::initializer_list<const char*> keys) {
  std::vector<std::string> missing;
  for (const char* key : keys)
    if (!table.has(key)) missing.emplace_back(key);
  refuse_missing(table, missing);
}

void refuse_keys(const StudyTable& table, std::initializer_list<const char*> keys, std::string_view why) {
  for (const char* key : keys)
    if (table.has(key)) table.fail(key, why);
}

namespace internal {
namespace {

void check(const StudyTable& table, const std::string& name, const std::string& unit, const KeyRange& range,
           double value) {
  if (range.contains(value)) return;
  // By its unit where the rule has one.
  const std::string rule = range.text(unit);
  const bool has_unit = !rule.empty() && (std::isalpha(static_cast<unsigned char>(rule.back())) != 0);
  table.fail(name,
             fmt::format("= {} must be {}", has_unit ? with_unit(value, unit) : fmt::format("{:g}", value), rule));
}

}  // namespace

std::string shown(double si, std::string_view unit) {
  if (!std::isfinite(si)) return {};
  const std::string text = with_unit(si, unit);
  return unit.empty() || unit == "1" ? text : '"' + text + '"';
}

std::string shown(const std::vector<double>& si, std::string_view unit) {
  std::vector<std::string> texts;
  for (const double x : si) texts.push_back(x == 0.0 ? "0" : shown(x, unit));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

double number_in(const StudyTable& table, const std::string& name, const std::string& unit, const KeyRange& range) {
  const double value = table.number(name, unit);
  check(table, name, unit, range, value);
  return value;
}

std::vector<double> numbers_in(const StudyTable& table, const std::string& name, const std::string& unit,
                               const KeyRange& range, std::size_t size) {
  std::vector<double> values = table.numbers(name, unit);
  if (size != 0 && values.size() != size)
    table.fail(name, fmt::format("has {} numbers, needs {}", values.size(), size));
  for (const double value : values) check(table, name, unit, range, value);
  return values;
}

long long integer_in(const StudyTable& table, const std::string& name, long long least, long long most) {
  const long long value = table.integer(name);
  const bool bounded = most < std::numeric_limits<long long>::max();
  if (value < least || value > most)
    table.fail(name, fmt::format("= {} must be {}", value,
                                 bounded ? fmt::format("from {} to {}", least, most) : fmt::format(">= {}", least)));
  return value;
}

std::vector<std::size_t> chosen_in(const StudyTable& table, const std::string& name,
                                   const std::vector<std::string>& names) {
  std::vector<std::size_t> chosen;
  for (const std::string& text : table.texts(name)) {
    const auto at = std::ranges::find(names, text);
    if (at == names.end())
      table.fail(name, fmt::format("'{}' is unknown{}", text, suggestion(text, names, names.size())));
    chosen.push_back(static_cast<std::size_t>(at - names.begin()));
  }
  return chosen;
}

}  // namespace internal
}  // namespace veridyn
