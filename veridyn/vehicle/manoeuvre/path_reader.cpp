#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/tables/table.hpp"
#include "veridyn/vehicle/manoeuvre/path.hpp"

namespace veridyn::vehicle {
namespace {

struct Row {
  int line = 0;
  std::vector<double> number;
};

/// Lines of numbers between blanks; empty ones are skipped.
std::vector<Row> rows_of(std::string_view text, const std::string& source) {
  std::vector<Row> rows;
  int line = 0;
  while (!text.empty()) {
    ++line;
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view rest = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    Row row{line, {}};
    for (;;) {
      const std::size_t begin = rest.find_first_not_of(" \t\r");
      if (begin == std::string_view::npos) break;
      rest.remove_prefix(begin);
      const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r"));
      double number = 0.0;
      const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), number);
      if (error != std::errc{} || stop != word.data() + word.size() || !std::isfinite(number)) {
        throw InputError(fmt::format("{}:{}", source, line), fmt::format("'{}' is not a finite number", word));
      }
      row.number.push_back(number);
      rest.remove_prefix(word.size());
    }
    if (!row.number.empty()) rows.push_back(std::move(row));
  }
  return rows;
}

struct Point {
  double x, y;
};

/// How far a point is from the line through p and q, over their distance.
double off_line(const Point& p, const Point& q, const Point& point) {
  const double dx = q.x - p.x, dy = q.y - p.y;
  return std::abs(dx * (point.y - p.y) - dy * (point.x - p.x)) / (dx * dx + dy * dy);
}

}  // namespace

Path parse_bezier_path(std::string_view text, const std::string& source) {
  const std::vector<Row> rows = rows_of(text, source);
  const auto place = [&](std::size_t row) { return fmt::format("{}:{}", source, rows[row].line); };
  if (rows.empty()) throw InputError(source, "is empty; expected the number of knots and of columns");
  if (rows[0].number.size() != 2) throw InputError(place(0), "expected the number of knots and of columns");
  const double columns = rows[0].number[1];
  if (columns != 3.0 && columns != 9.0) {
    throw InputError(place(0), fmt::format("knots have {:g} columns; must be 3 or 9", columns));
  }
  const std::size_t knots = rows.size() - 1;
  if (rows[0].number[0] != static_cast<double>(knots)) {
    throw InputError(place(0), fmt::format("promises {:g} knots, but there are {}", rows[0].number[0], knots));
  }
  if (knots < 2) throw InputError(source, "needs at least two knots");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].number.size() != static_cast<std::size_t>(columns)) {
      throw InputError(place(i), fmt::format("has {} numbers, expected {:g}", rows[i].number.size(), columns));
    }
  }
  const auto point = [&](std::size_t knot, std::size_t column) {
    return Point{rows[knot + 1].number[column], rows[knot + 1].number[column + 1]};
  };
  if (columns == 3.0) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < knots; ++i) {
      x.push_back(point(i, 0).x);
      y.push_back(point(i, 0).y);
    }
    try {
      return Path::through(x, y);
    } catch (const InputError& wrong) {
      throw InputError(source, wrong.what());
    }
  }
  Path path;
  for (std::size_t i = 0; i + 1 < knots; ++i) {
    const Point k0 = point(i, 0), out = point(i, 6), in = point(i + 1, 3), k1 = point(i + 1, 0);
    if (k0.x == k1.x && k0.y == k1.y) throw InputError(place(i + 2), "the knot coincides with the one before");
    Path::Polynomial piece;
    if (off_line(k0, k1, out) < 1e-9 && off_line(k0, k1, in) < 1e-9) {
      // A straight line, whatever its control points do along it: some files overshoot there, and turn back.
      piece.x = {k0.x, k1.x - k0.x, 0.0, 0.0, 0.0, 0.0};
      piece.y = {k0.y, k1.y - k0.y, 0.0, 0.0, 0.0, 0.0};
    } else {
      const auto cubic = [](double a, double b, double c, double d) {
        return std::array<double, 6>{a, 3.0 * (b - a), 3.0 * (a - 2.0 * b + c), d - a + 3.0 * (b - c), 0.0, 0.0};
      };
      piece.x = cubic(k0.x, out.x, in.x, k1.x);
      piece.y = cubic(k0.y, out.y, in.y, k1.y);
    }
    try {
      path.append(piece);
    } catch (const InputError& wrong) {
      throw InputError(place(i + 2), wrong.what());
    }
  }
  return path;
}

Path read_path(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  // A table has names in its first row, knots have numbers only.
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const bool is_knots = begin != std::string::npos && (text[begin] >= '0' && text[begin] <= '9') &&
                        text.substr(begin, text.find('\n', begin) - begin).find(',') == std::string::npos;
  if (is_knots) return parse_bezier_path(text, file.string());
  const io::Table table = io::parse_table(text, file.string());
  const Unit metre = parse_unit("m");
  for (const char* name : {"x", "y"}) {
    if (!table.at(name).unit.same_dimension(metre)) {
      throw InputError(file.string(),
                       fmt::format("column {} is in {}, expected a length [m]", name, table.at(name).unit.name));
    }
  }
  try {
    return Path::through(table.at("x").value, table.at("y").value);
  } catch (const InputError& wrong) {
    throw InputError(file.string(), wrong.what());
  }
}

}  // namespace veridyn::vehicle
