#include "veridyn/estimation/search/search_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::estimation {
namespace {

constexpr std::string_view kFormatLine = "# veridyn search log, format ";
constexpr int kSearchLogFormat = 1;
constexpr std::string_view kBatchLine = "# batch of ";

/// In a cell of the table or a line of the head.
std::string plain(std::string text) {
  for (char& c : text) {
    if (c == ',') c = ';';
    if (c == '\n' || c == '\r' || c == '"') c = ' ';
  }
  return text;
}

/// Name and value of each line of the head.
std::vector<std::pair<std::string, std::string>> head_of(const BlackBoxProblem& p) {
  std::vector<std::pair<std::string, std::string>> head = {{"problem", plain(p.name)}};
  for (std::size_t i = 0; i < p.names.size(); ++i) {
    head.emplace_back(fmt::format("parameter {}", i + 1),
                      fmt::format("{} from {} to {}", plain(p.names[i]), p.low(i), p.high(i)));
  }
  for (std::size_t i = 0; i < p.constraint_names.size(); ++i)
    head.emplace_back(fmt::format("constraint {}", i + 1), plain(p.constraint_names[i]));
  for (const auto& [name, value] : p.identity) head.emplace_back(plain(name), plain(value));
  return head;
}

std::string head_text(const BlackBoxProblem& p) {
  std::string text = fmt::format("{}{}\n", kFormatLine, kSearchLogFormat);
  for (const auto& [name, value] : head_of(p)) text += fmt::format("# {}: {}\n", name, value);
  text += "evaluation,seconds,end,objective";
  for (const std::string& name : p.constraint_names) text += "," + plain(name);
  for (const std::string& name : p.names) text += "," + plain(name);
  return text + "\n";
}

/// FNV-1a.
std::uint64_t checksum(std::string_view text) {
  std::uint64_t sum = 0xcbf29ce484222325ULL;
  for (const char c : text) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return sum;
}

/// Shortest text that gives the same bits again; one NaN for all.
std::string exact(double value) { return value != value ? "nan" : fmt::format("{}", value); }

std::string batch_text(std::span<const SearchEvaluation> batch, std::size_t first) {
  std::string text;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const SearchEvaluation& e = batch[i];
    text += fmt::format("{},{:.6g},{},{}", first + i + 1, e.seconds, e.values.finite() ? "done" : "failed",
                        exact(e.values.objective));
    for (const double c : e.values.constraints) text += "," + exact(c);
    for (const double x : e.x) text += "," + exact(x);
    text += "\n";
  }
  return text + fmt::format("{}{}, check {:016x}\n", kBatchLine, batch.size(), checksum(text));
}

/// Numbers of a row after `evaluation,seconds,end`, or nothing where it is no such row.
std::optional<SearchEvaluation> parse_row(std::string_view line, std::size_t constraints, std::size_t parameters) {
  SearchEvaluation e;
  e.x.resize(parameters);
  e.values.constraints.resize(constraints);
  const std::size_t columns = 4 + constraints + parameters;
  for (std::size_t column = 0; column < columns; ++column) {
    const std::size_t comma = line.find(',');
    if ((comma == std::string_view::npos) != (column + 1 == columns)) return std::nullopt;
    const std::string_view cell = line.substr(0, comma);
    line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
    if (column == 0 || column == 2) continue;
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size()) return std::nullopt;
    if (column == 1) {
      e.seconds = value;
    } else if (column == 3) {
      e.values.objective = value;
    } else if (column < 4 + constraints) {
      e.values.constraints[column - 4] = value;
    } else {
      e.x(column - 4 - constraints) = value;
    }
  }
  return e;
}

/// The next line of `text` from `from` on, without its end; nothing where none ends.
std::optional<std::string_view> line_at(std::string_view text, std::size_t from) {
  const std::size_t end = text.find('\n', from);
  if (end == std::string_view::npos) return std::nullopt;
  return text.substr(from, end - from);
}

/// Refuses a head that differs, saying in what. Returns where the table begins.
std::size_t check_head(const BlackBoxProblem& problem, std::string_view text, const std::string& shown) {
  const std::string_view first = line_at(text, 0).value_or("");
  if (!first.starts_with(kFormatLine)) throw InputError(shown, "is no log of a search; choose another file");
  if (first.substr(kFormatLine.size()) != fmt::format("{}", kSearchLogFormat))
    throw InputError(shown, fmt::format("has format {}, this version continues format {} only",
                                        first.substr(kFormatLine.size()), kSearchLogFormat));
  std::size_t position = first.size() + 1;
  const auto differs = [&](const std::string& what) {
    throw InputError(shown, fmt::format("is of another search: {}; remove it, or choose another file", what));
  };
  for (const auto& [name, value] : head_of(problem)) {
    const std::string_view line = line_at(text, position).value_or("");
    const std::string start = fmt::format("# {}: ", name);
    if (!line.starts_with(start)) differs(fmt::format("it does not say '{}', here {}", name, value));
    if (line.substr(start.size()) != value)
      differs(fmt::format("{} is '{}' there and '{}' here", name, line.substr(start.size()), value));
    position += line.size() + 1;
  }
  const std::string_view columns = line_at(text, position).value_or("");
  if (columns.starts_with("# "))
    differs(fmt::format("it says '{}', of which nothing is known here", columns.substr(2)));
  return position + columns.size() + 1;
}

}  // namespace

SearchLog::SearchLog(const BlackBoxProblem& problem, std::filesystem::path path) : path_(std::move(path)) {
  const std::string head = head_text(problem), shown = path_.string();
  if (!std::filesystem::exists(path_)) {
    write_file(path_, head);
    return;
  }
  const std::string text = read_file(path_);
  std::size_t good = check_head(problem, text, shown), begin = good, position = good;
  std::vector<SearchEvaluation> batch;
  while (const std::optional<std::string_view> line = line_at(text, position)) {
    const std::size_t here = position;
    position += line->size() + 1;
    if (!line->starts_with('#')) {
      std::optional<SearchEvaluation> row = parse_row(*line, problem.constraint_names.size(), problem.names.size());
      if (!row) break;
      batch.push_back(std::move(*row));
      continue;
    }
    const std::string_view rows = std::string_view(text).substr(begin, here - begin);
    if (*line != fmt::format("{}{}, check {:016x}", kBatchLine, batch.size(), checksum(rows))) break;
    evaluations_.insert(evaluations_.end(), batch.begin(), batch.end());
    batch.clear();
    good = begin = position;
  }
  // What a killed program leaves is the beginning of a batch: nothing with an end may follow.
  if (text.find(fmt::format("\n{}", kBatchLine), good) != std::string::npos)
    throw InputError(shown, fmt::format("is damaged after evaluation {}; remove it, or its lines from there on",
                                        evaluations_.size()));
  if (good < text.size()) write_file(path_, std::string_view(text).substr(0, good));
  loaded_ = evaluations_.size();
}

void SearchLog::append(std::span<const SearchEvaluation> batch) {
  if (!path_.empty()) {
    const std::string text = batch_text(batch, evaluations_.size());
    std::ofstream file(path_, std::ios::binary | std::ios::app);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    file.close();
    if (!file)
      throw std::runtime_error(fmt::format("{}: cannot be continued: {}", path_.string(), std::strerror(errno)));
  }
  evaluations_.insert(evaluations_.end(), batch.begin(), batch.end());
}

}  // namespace veridyn::estimation
