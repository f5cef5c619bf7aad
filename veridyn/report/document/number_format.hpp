#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// A number for people: `digits` significant digits, no trailing exponent unless below 1e-4 or from 1e7 on
/// ("1.234e-6"), with the typographic minus sign; "–" for what is not finite.
[[nodiscard]] std::string format_number(double value, int digits);

/// The same with fixed decimals ("0.420"); never "−0.00".
[[nodiscard]] std::string format_decimals(double value, int decimals);

/// What a cell shows: its number, its text, or its badge's words.
[[nodiscard]] std::string cell_text(const Cell& cell, const Column& column);

/// How a column is set, `kAuto` resolved.
[[nodiscard]] Align resolved_align(const Table& table, std::size_t column);

/// Rounds samples for storage as decimal text: to a 1/`steps` of their range or finer (a plot is some hundred pixels
/// high), so that each takes few characters. What is not finite becomes NaN.
[[nodiscard]] std::vector<double> round_for_storage(const std::vector<double>& values, double steps);

/// A number in the unit that people read.
struct ReadableNumber {
  double value = 0.0;
  std::string unit;
};
/// Angles in deg, understeer gradients in deg/g, and what its name calls a frequency or bandwidth in Hz.
[[nodiscard]] ReadableNumber readable(double value, const std::string& unit, std::string_view name = {});

}  // namespace veridyn::report
