#include "veridyn/vehicle/tyre/tir_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/text.hpp"

namespace veridyn::vehicle::internal {
namespace {

constexpr std::size_t kLargestFile = std::size_t{4} << 20;  // real ones have some 15 kB

bool is_key(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

}  // namespace

TirLines::TirLines(std::string_view text, std::string source) : source_(std::move(source)) {
  if (text.size() > kLargestFile)
    throw InputError(source_, fmt::format("has {} bytes; a tyre file has at most {}", text.size(), kLargestFile));
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    ++number;
    read_line(text.substr(0, end), number);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  }
  if (entries_.empty()) throw InputError(source_, "is no tyre file: it holds no line KEY = value");
}

const TirLines::Entry* TirLines::find(std::string_view key) const {
  const auto found = entries_.find(key);
  return found == entries_.end() ? nullptr : &found->second;
}

std::string TirLines::place(std::string_view key) const {
  const Entry* entry = find(key);
  return entry == nullptr ? source_ : fmt::format("{}:{}", source_, entry->line);
}

void TirLines::fail(std::string_view key, std::string_view what) const {
  throw InputError(place(key), fmt::format("{} {}", key, what));
}

std::optional<double> TirLines::number(std::string_view key) const {
  const Entry* entry = find(key);
  if (entry == nullptr) return std::nullopt;
  double value = 0.0;
  std::string_view text = entry->value;
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (entry->quoted || stop != text.data() + text.size() || text.empty() ||
      (error != std::errc() && error != std::errc::result_out_of_range))
    fail(key, fmt::format("= {} is not a number", shown(entry->value)));
  // Below the smallest double is 0; above the largest is refused with infinity itself.
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(text).c_str(), nullptr);
  if (!std::isfinite(value)) fail(key, fmt::format("= {} must be finite", shown(entry->value)));
  return value;
}

double TirLines::number_or(std::string_view key, double otherwise) const { return number(key).value_or(otherwise); }

std::string TirLines::text_or(std::string_view key, std::string_view otherwise) const {
  const Entry* entry = find(key);
  return entry == nullptr ? std::string(otherwise) : entry->value;
}

void TirLines::read_line(std::string_view raw, std::size_t number) {
  const auto refuse = [&](std::string_view what) { throw InputError(fmt::format("{}:{}", source_, number), what); };
  for (const char c : raw) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 0x20 && c != '\t' && c != '\r') || byte == 0x7f) refuse("is no tyre file: this line is not text");
  }
  std::string_view line = trimmed(raw);
  // A comment sign inside a quoted text belongs to the text.
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\'') quoted = !quoted;
    if (!quoted && (line[i] == '$' || line[i] == '!')) {
      line = trimmed(line.substr(0, i));
      break;
    }
  }
  if (line.empty()) return;
  if (line.front() == '[') {
    if (line.back() != ']') refuse(fmt::format("'{}': a section is written [NAME]", shown(line)));
    in_table_ = false;
    return;
  }
  if (line.front() == '{') {
    in_table_ = true;
    return;
  }
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos) {
    if (in_table_) return;
    refuse(fmt::format("'{}' is neither KEY = value, [SECTION] nor a comment", shown(line)));
  }
  in_table_ = false;
  const std::string key = upper(trimmed(line.substr(0, equals)));
  std::string_view value = trimmed(line.substr(equals + 1));
  if (!is_key(key)) refuse(fmt::format("'{}' is not the name of a key", shown(key)));
  Entry entry;
  entry.line = number;
  if (!value.empty() && value.front() == '\'') {
    if (value.size() < 2 || value.back() != '\'') refuse(fmt::format("{}: the closing quote is missing", key));
    entry.quoted = true;
    value = trimmed(value.substr(1, value.size() - 2));
  }
  if (value.empty() && !entry.quoted) refuse(fmt::format("{} has no value", key));
  entry.value = std::string(value);
  const auto [at, inserted] = entries_.try_emplace(key, std::move(entry));
  if (!inserted) refuse(fmt::format("{} is given twice, first in line {}", key, at->second.line));
}

}  // namespace veridyn::vehicle::internal
