#include "veridyn/report/document/number_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/deg_per_g.hpp"

namespace veridyn::report {

namespace {

constexpr const char* kMissing = "–";
constexpr const char* kMinus = "−";

std::string with_true_minus(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '-') {
      result += kMinus;
    } else {
      result += c;
    }
  }
  return result;
}

}  // namespace

std::string format_decimals(double value, int decimals) {
  if (!std::isfinite(value)) return kMissing;
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find_first_of("123456789") == std::string::npos && text.front() == '-') text.erase(0, 1);
  return with_true_minus(text);
}

std::string format_number(double value, int digits) {
  if (!std::isfinite(value)) return kMissing;
  if (value == 0.0) return "0";
  const std::string scientific = fmt::format("{:.{}e}", value, std::max(0, digits - 1));
  // Taken from the rounded number: 9.9996 with four digits is 10.00.
  const std::size_t e = scientific.find('e');
  const int exponent = std::stoi(scientific.substr(e + 1));
  if (exponent < -4 || exponent > 6) return with_true_minus(fmt::format("{}e{}", scientific.substr(0, e), exponent));
  return format_decimals(value, std::max(0, digits - 1 - exponent));
}

std::string cell_text(const Cell& cell, const Column& column) {
  if (cell.status != Status::kNone) return cell.text.empty() ? std::string(status_label(cell.status)) : cell.text;
  if (!cell.number || !cell.text.empty()) return cell.text;
  return cell.decimals ? format_decimals(*cell.number, *cell.decimals) : format_number(*cell.number, column.digits);
}

Align resolved_align(const Table& table, std::size_t column) {
  const Align wanted = table.columns[column].align;
  if (wanted != Align::kAuto) return wanted;
  const bool numbers =
      std::any_of(table.rows.begin(), table.rows.end(), [&](const Row& row) { return row.cells[column].number; });
  return numbers ? Align::kRight : Align::kLeft;
}

std::vector<double> round_for_storage(const std::vector<double>& values, double steps) {
  double low = kInfinity;
  double high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  // A constant keeps its own digits.
  const double range = high > low ? high - low : std::abs(high);
  const double decimals = range > 0.0 && std::isfinite(range) ? std::ceil(std::log10(steps / range)) : 0.0;
  std::vector<double> rounded(values);
  const double power = std::pow(10.0, std::abs(decimals));
  for (double& value : rounded) {
    if (!std::isfinite(value)) {
      value = kNaN;
    } else if (decimals > 15.0 || decimals < -15.0) {
      continue;  // no plain decimal number would be shorter
    } else if (decimals >= 0.0) {
      // Past 2^53 the product has no fraction to round.
      if (std::abs(value) * power < 9e15) value = std::round(value * power) / power;
    } else {
      value = std::round(value / power) * power;
    }
    if (value == 0.0) value = 0.0;  // no "-0.0"
  }
  return rounded;
}

ReadableNumber readable(double value, const std::string& unit, std::string_view name) {
  const bool rate_of_turns = name.find("frequency") != name.npos || name.find("bandwidth") != name.npos;
  if (rate_of_turns && unit == "rad/s") return {value / kFullTurn, "Hz"};
  static const std::array<std::tuple<const char*, const char*, double>, 9> kReadable{{
      {"rad", "deg", 1.0 / kDegree},
      {"rad/s", "deg/s", 1.0 / kDegree},
      {"rad/s^2", "deg/s^2", 1.0 / kDegree},
      {"s rad", "s deg", 1.0 / kDegree},
      {"rad/g", "deg/g", 1.0 / kDegree},
      {"rad s^2/m", "deg/g", deg_per_g(1.0)},
      {"rad/(m/s^2)", "deg/g", deg_per_g(1.0)},
      {"m/s^2/rad", "m/s^2/deg", kDegree},
      {"m/(s^2 rad)", "m/s^2/deg", kDegree},
  }};
  for (const auto& [si, shown, factor] : kReadable)
    if (unit == si) return {value * factor, shown};
  return {value, unit == "1" ? "" : unit};
}

}  // namespace veridyn::report
