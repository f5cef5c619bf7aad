#include "veridyn/io/tables/table_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/text.hpp"
#include "veridyn/io/tables/csv_header.hpp"
#include "veridyn/io/tables/time_column.hpp"

namespace veridyn::io::internal {
namespace {

using Line = TableLayout::Line;

/// Lines that are looked at to find the header: Betaflight's explorer writes some 200 of metadata.
constexpr std::size_t kLinesLookedAt = 1000;
constexpr std::size_t kBytesLookedAt = std::size_t{4} << 20U;
/// Comments that may belong to the header.
constexpr std::size_t kCommentsLookedAt = 20;
/// Rows in succession that make a table of what follows a line of names.
constexpr std::size_t kRowsThatFollow = 3;

bool is_comment(std::string_view line) { return line.starts_with('#') || line.starts_with('%'); }

/// The next line of a text with its end, of which it is taken off; empty of an empty one.
Line take_line(std::string_view& rest, std::size_t& number) {
  if (rest.empty()) return {rest, ++number};
  const std::size_t stop = std::min(rest.find('\n'), rest.size() - 1) + 1;
  const Line line{rest.substr(0, stop), ++number};
  rest.remove_prefix(line.text.size());
  return line;
}

/// Cells of a row as they are read, and what they are together.
struct Row {
  enum class Kind { kEmpty, kWords, kData };
  Line line;
  std::vector<std::string> cells;
  Kind kind = Kind::kEmpty;
};

/// Words that say of what type the numbers of a column are.
bool holds_only_types(const std::vector<std::string>& cells) {
  constexpr std::string_view kTypes[] = {"double",  "float", "int",    "integer", "uint",   "short",  "long",
                                         "ulong",   "char",  "uchar",  "ushort",  "bool",   "string", "float32",
                                         "float64", "int32", "uint32", "int16",   "uint16", "int8",   "uint8"};
  return std::ranges::all_of(cells, [&](const std::string& cell) {
    return std::ranges::find(kTypes, lower(trimmed(cell))) != std::end(kTypes);
  });
}

/// A number in a form that is not read, "0,5".
bool is_of_digits(std::string_view cell) {
  constexpr std::string_view kDigits = "0123456789", kSigns = "0123456789.,:+-/ ";
  return cell.find_first_of(kDigits) != std::string_view::npos &&
         cell.find_first_not_of(kSigns) == std::string_view::npos;
}

Row::Kind kind_of(const std::vector<std::string>& cells, bool decimal_comma) {
  bool words = false;
  for (const std::string& cell : cells) {
    if (cell.empty()) continue;
    bool infinite = false;
    const auto number = unusual_number(cell, infinite, decimal_comma);
    if ((number && std::isfinite(*number)) || infinite || parse_text_stamp(cell) || is_of_digits(cell))
      return Row::Kind::kData;
    words = true;
  }
  return words ? Row::Kind::kWords : Row::Kind::kEmpty;
}

/// The cells of a line with an empty one after a delimiter at its end.
std::vector<std::string> all_cells_of(std::string_view line, char delimiter) {
  if (delimiter == ' ') return blank_separated(line);
  CellReader reader(line, delimiter);
  std::vector<std::string> cells;
  do {
    cells.push_back(reader.text());
  } while (!reader.last_cell_of_row());
  return cells;
}

/// Rows of words that are followed by rows of data of the same length.
struct HeaderBlock {
  std::vector<Row> rows;
  char delimiter = ',';
};

/// The last rows of `lines` that have as many cells as each other.
std::vector<Row> rows_alike(const std::vector<Line>& lines, char delimiter, bool decimal_comma) {
  std::vector<Row> rows;
  for (std::size_t i = lines.size(); i-- > 0;) {
    std::vector<std::string> cells = all_cells_of(lines[i].text, delimiter);
    if (cells.size() < 2 || (!rows.empty() && cells.size() != rows.back().cells.size())) break;
    const Row::Kind kind = kind_of(cells, decimal_comma);
    rows.push_back({lines[i], std::move(cells), kind});
  }
  std::reverse(rows.begin(), rows.end());
  return rows;
}

/// Of rows of one length the words ahead of the first rows of data.
std::vector<Row> words_ahead_of_data(const std::vector<Row>& rows) {
  std::vector<Row> words;
  std::size_t data = 0;
  for (const Row& row : rows) {
    if (row.kind == Row::Kind::kEmpty) continue;
    if (row.kind == Row::Kind::kData) {
      if (!words.empty() && ++data == kRowsThatFollow) return words;
      continue;
    }
    if (data > 0) words.clear();
    data = 0;
    words.push_back(row);
  }
  return data > 0 ? words : std::vector<Row>{};
}

/// View of a text of which the layout is being found.
class LayoutFinder {
 public:
  LayoutFinder(std::string_view bytes, const TableOptions& options, const std::string& source)
      : rest_(bytes), options_(options), source_(source) {}

  TableLayout find() {
    skip_lines();
    const Line first = take_comments();
    require_text(first);
    choose_style(first);
    if (!options_.columns.empty()) {
      start_rows_at(first);
      layout_.columns = options_.columns.size();
      return std::move(layout_);
    }
    const std::vector<std::string> cells = cells_at(first);
    if (holds_only_data(cells, layout_.style.decimal_comma)) {
      start_rows_at(first);
      layout_.columns = cells.size();
      take_names_in_comments();
      return std::move(layout_);
    }
    if (std::optional<HeaderBlock> block = header_block(first)) {
      take_block(first, *block);
    } else {
      take_header(first);
    }
    if (layout_.units.empty()) take_units_in_comments();
    return std::move(layout_);
  }

 private:
  void skip_lines() {
    for (std::size_t i = 0; i < options_.skip_lines; ++i) {
      if (rest_.empty())
        throw InputError(source_, fmt::format("has only {} lines, skip_lines leaves nothing of it", number_));
      static_cast<void>(take_line(rest_, number_));
    }
  }

  /// The first line that is neither blank nor a comment.
  Line take_comments() {
    while (!rest_.empty()) {
      Line line = take_line(rest_, number_);
      const std::string_view text = trimmed(line.text);
      if (text.empty()) continue;
      if (!is_comment(text)) return line;
      layout_.comments.push_back({text, line.number});
    }
    throw InputError(source_, "no header: the file has only blank lines and comments");
  }

  void require_text(const Line& line) const {
    for (const char c : trimmed(line.text)) {
      const auto byte = static_cast<unsigned char>(c);
      if (byte < 0x20 && c != '\t')
        throw InputError(fmt::format("{}:{}", source_, line.number), "not a CSV file: the first row is not text");
    }
  }

  [[nodiscard]] std::string_view from(const Line& line) const {
    return {line.text.data(), at(rest_.data() + rest_.size() - line.text.data())};
  }

  void choose_style(const Line& line) {
    layout_.style.delimiter = options_.delimiter != '\0' ? options_.delimiter : guess_delimiter(trimmed(line.text));
    choose_decimal(line);
  }

  void choose_decimal(const Line& line) {
    layout_.decimal_comma_found = options_.decimal == '\0' && has_decimal_comma(from(line), layout_.style.delimiter);
    layout_.style.decimal_comma = layout_.decimal_comma_found || options_.decimal == ',';
  }

  void start_rows_at(const Line& line) {
    layout_.rows = from(line);
    layout_.header_line = line.number;
    layout_.lines = line.number - 1;
  }

  /// The cells of a row, which may go on over lines in quotes.
  [[nodiscard]] std::vector<std::string> cells_at(const Line& line) const {
    CellReader reader(from(line), layout_.style);
    return row_of(reader);
  }

  [[nodiscard]] std::vector<std::string> row_of(CellReader& reader) const {
    if (layout_.style.delimiter == ' ') {
      std::vector<std::string> names = blank_separated(reader.line());
      if (names.empty()) names.emplace_back();  // a row of quotes
      return names;
    }
    std::vector<std::string> cells;
    do {
      cells.push_back(reader.text());
    } while (!reader.last_cell_of_row() && !reader.at_end());
    if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
    return cells;
  }

  /// Names in the first line, units maybe in the next.
  void take_header(const Line& line) {
    CellReader reader(from(line), layout_.style);
    layout_.names = row_of(reader);
    layout_.columns = layout_.names.size();
    layout_.header_line = line.number;
    layout_.lines = line.number - 1 + reader.lines();
    layout_.rows = std::string_view(reader.position(), at(rest_.data() + rest_.size() - reader.position()));
    CellReader below(layout_.rows, layout_.style);
    std::vector<std::string> cells = row_of(below);
    cells.resize(std::max(cells.size(), layout_.columns));
    layout_.units = row_of_units(cells);
    if (layout_.units.size() != layout_.columns) layout_.units.clear();
    if (layout_.units.empty()) return;
    layout_.lines += below.lines();
    layout_.rows.remove_prefix(at(below.position() - layout_.rows.data()));
  }

  /// A header that is not the first line alone; nothing where the first line may be one.
  [[nodiscard]] std::optional<HeaderBlock> header_block(const Line& first) const {
    std::vector<Line> lines{first};
    std::string_view rest = rest_;
    std::size_t number = first.number;
    while (!rest.empty() && lines.size() < kLinesLookedAt && at(rest.data() - first.text.data()) < kBytesLookedAt) {
      const Line line = take_line(rest, number);
      if (!trimmed(line.text).empty() && !is_comment(trimmed(line.text))) lines.push_back(line);
    }
    // The last one may be cut.
    if (!rest.empty() || !lines.back().text.ends_with('\n')) lines.pop_back();
    for (const char delimiter : {layout_.style.delimiter, '|', ';', '\t', ',', ' '}) {
      if (options_.delimiter != '\0' && delimiter != options_.delimiter) continue;
      if (lines.size() < kRowsThatFollow) break;
      const bool comma = options_.decimal == ',' || (options_.decimal == '\0' && delimiter != ',');
      HeaderBlock block{words_ahead_of_data(rows_alike(lines, delimiter, comma)), delimiter};
      if (block.rows.empty()) continue;
      const bool at_top = block.rows.front().line.number == first.number;
      if (at_top && block.rows.size() == 1 && delimiter == layout_.style.delimiter) return std::nullopt;
      if (at_top && delimiter != layout_.style.delimiter) continue;  // a row that is wrong is to be named as such
      return block;
    }
    return std::nullopt;
  }

  void take_block(const Line& first, const HeaderBlock& block) {
    const Line top = block.rows.front().line;
    const Line bottom = block.rows.back().line;
    describe_lines_above(first, top);
    layout_.style.delimiter = block.delimiter;
    choose_decimal(top);
    std::vector<Row> rows = block.rows;
    for (Row& row : rows)
      if (row.cells.back().empty()) row.cells.pop_back();  // a delimiter at the end
    const Row first_row = rows.front();
    choose_names_and_units(rows);
    if (layout_.names.empty()) {  // only words that name types elsewhere
      layout_.names = first_row.cells;
      layout_.columns = first_row.cells.size();
      layout_.header_line = first_row.line.number;
    }
    layout_.rows = from(bottom);
    layout_.rows.remove_prefix(bottom.text.size());
    layout_.lines = bottom.number;
  }

  /// What stands above the header, from the first line on that is no comment.
  void describe_lines_above(Line line, const Line& header) {
    for (std::string_view rest = rest_; line.number < header.number;) {
      const std::string_view text = trimmed(line.text);
      if (!text.empty()) (is_comment(text) ? layout_.comments : layout_.descriptions).push_back({text, line.number});
      std::size_t number = line.number;
      line = take_line(rest, number);
    }
  }

  /// Of several rows ahead of the data: those of types say nothing, one may hold the units, and of several of names the
  /// last that is complete counts.
  void choose_names_and_units(std::vector<Row>& rows) {
    std::erase_if(rows, [](const Row& row) { return holds_only_types(row.cells); });
    for (std::size_t i = rows.size(); i-- > 0 && rows.size() > 1 && layout_.units.empty();) {
      layout_.units = row_of_units_and_words(rows[i].cells);
      if (layout_.units.empty()) layout_.units = row_of_units(rows[i].cells);
      if (!layout_.units.empty()) rows.erase(rows.begin() + signed_index(i));
    }
    if (rows.empty()) return;
    const auto length = [](const Row& row) { return row.cells.size(); };
    const std::size_t longest = std::ranges::max(rows, {}, length).cells.size();
    const auto complete = [&](const Row& row) {
      return row.cells.size() == longest && std::ranges::find(row.cells, "") == row.cells.end();
    };
    const auto last = std::find_if(rows.rbegin(), rows.rend(), complete);
    const Row& names = last == rows.rend() ? rows.front() : *last;
    layout_.names = names.cells;
    layout_.columns = names.cells.size();
    layout_.header_line = names.line.number;
    if (!layout_.units.empty()) layout_.units.resize(layout_.columns);
  }

  /// Rows of cells among the last comments that have one for each column, in their order.
  [[nodiscard]] std::vector<Row> rows_in_comments() const {
    std::vector<Row> rows;
    const std::size_t count = layout_.comments.size();
    for (std::size_t i = count - std::min(count, kCommentsLookedAt); i < count; ++i) {
      const std::string_view text = layout_.comments[i].text;
      const std::size_t begin = std::min(text.find_first_not_of("#% \t"), text.size());
      for (const char delimiter : {layout_.style.delimiter, '|', ',', ';', '\t', ' '}) {
        std::vector<std::string> cells = cells_of(text.substr(begin), delimiter);
        if (cells.size() != layout_.columns || holds_only_data(cells, layout_.style.decimal_comma)) continue;
        rows.push_back({layout_.comments[i], std::move(cells), Row::Kind::kWords});
        break;
      }
    }
    return rows;
  }

  void take_names_in_comments() {
    std::vector<Row> rows = rows_in_comments();
    const std::size_t header_line = layout_.header_line;
    choose_names_and_units(rows);
    layout_.header_line = header_line;
    layout_.columns = std::max(layout_.columns, layout_.names.size());
  }

  void take_units_in_comments() {
    std::string_view rest = layout_.rows;
    std::size_t number = layout_.lines;
    for (Line line = take_line(rest, number); is_comment(trimmed(line.text)); line = take_line(rest, number))
      layout_.comments.push_back({trimmed(line.text), line.number});
    const std::vector<Row> rows = rows_in_comments();
    for (auto row = rows.rbegin(); row != rows.rend() && layout_.units.empty(); ++row)
      layout_.units = row_of_units_and_words(row->cells);
  }

  std::string_view rest_;
  const TableOptions& options_;
  const std::string& source_;
  TableLayout layout_;
  std::size_t number_ = 0;
};

}  // namespace

TableLayout find_layout(std::string_view bytes, const TableOptions& options, const std::string& source) {
  return LayoutFinder(bytes, options, source).find();
}

}  // namespace veridyn::io::internal
