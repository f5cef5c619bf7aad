#include "veridyn/io/tables/plain_rows.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::io::internal {
namespace {

/// Less than this is read sooner than it is divided.
constexpr std::size_t kLeastPart_bytes = std::size_t{1} << 21U;

/// Whole lines of a table, and where in the columns they belong.
struct LinesOfTable {
  std::string_view text;
  std::size_t first = 0, count = 0;
};

std::vector<LinesOfTable> lines_in_parts(std::string_view rows, std::size_t parts) {
  std::vector<LinesOfTable> all;
  const std::size_t size = rows.size() / parts + 1;
  while (!rows.empty()) {
    const std::size_t newline = rows.size() > size ? rows.find('\n', size) : std::string_view::npos;
    const std::size_t length = newline == std::string_view::npos ? rows.size() : newline + 1;
    all.push_back({.text = rows.substr(0, length)});
    rows.remove_prefix(length);
  }
  return all;
}

/// A number, NaN where it is missing; nothing for what row by row is to be looked at.
std::optional<double> plain_cell(CellReader& reader) {
  double value = 0.0;
  if (reader.number(value)) return std::isinf(value) ? std::nullopt : std::optional(value);
  if (*reader.position() == '"') return std::nullopt;
  bool infinite = false;
  const std::optional<double> unusual = reader.unusual(infinite);
  return infinite ? std::nullopt : unusual;
}

/// Fills the part's rows; false where one is not plain.
bool fill_rows(const LinesOfTable& part, CellStyle style, const PlainColumns& columns,
               std::vector<std::vector<double>>& values) {
  CellReader reader(part.text, style);
  double last = -kInfinity;
  for (std::size_t row = part.first; row < part.first + part.count; ++row) {
    if (reader.at_end() || std::string_view("\n\r \t#%").find(*reader.position()) != std::string_view::npos)
      return false;
    for (std::size_t i = 0; i < columns.count; ++i) {
      if (reader.at_end()) return false;
      const std::optional<double> cell = plain_cell(reader);
      if (!cell || reader.last_cell_of_row() != (i + 1 == columns.count)) return false;
      values[i][row] = *cell;
    }
    if (!columns.time) continue;
    double& stamp = values[*columns.time][row];
    stamp *= columns.time_scale;
    if (!(stamp >= last)) return false;
    last = stamp;
  }
  return reader.at_end();
}

}  // namespace

std::optional<std::vector<std::vector<double>>> read_plain_rows(std::string_view rows, CellStyle style,
                                                                const PlainColumns& columns, int threads) {
  const std::size_t side_by_side =
      threads > 0 ? static_cast<std::size_t>(threads) : std::max(1U, std::thread::hardware_concurrency());
  // A part that waits for its processor is not to hold up all others.
  constexpr std::size_t kPartsEach = 4;
  const std::size_t parts = std::min(side_by_side * kPartsEach, rows.size() / kLeastPart_bytes);
  if (side_by_side < 2 || parts < 2 || style.delimiter == ' ') return std::nullopt;
  std::vector<LinesOfTable> lines = lines_in_parts(rows, parts);
  numerics::parallel_for(lines.size(), threads, [&](std::size_t k) {
    const std::string_view text = lines[k].text;
    lines[k].count = static_cast<std::size_t>(std::ranges::count(text, '\n')) + (text.back() == '\n' ? 0U : 1U);
  });
  std::size_t count = 0;
  for (LinesOfTable& part : lines) {
    part.first = count;
    count += part.count;
  }
  std::vector<std::vector<double>> values(columns.count);
  numerics::parallel_for(values.size(), threads, [&](std::size_t i) { values[i].resize(count); });
  std::atomic<bool> plain = true;
  numerics::parallel_for(lines.size(), threads, [&](std::size_t k) {
    if (plain && !fill_rows(lines[k], style, columns, values)) plain = false;
  });
  if (!plain) return std::nullopt;
  if (columns.time) {
    const std::vector<double>& stamps = values[*columns.time];
    for (const LinesOfTable& part : lines)
      if (part.first > 0 && part.first < count && !(stamps[part.first] >= stamps[part.first - 1])) return std::nullopt;
  }
  return values;
}

}  // namespace veridyn::io::internal
