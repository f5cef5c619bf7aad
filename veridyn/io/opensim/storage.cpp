#include "veridyn/io/opensim/storage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <set>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/text.hpp"

namespace veridyn::io {
namespace {

constexpr std::string_view kBlank = " \t\r";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) - begin + 1);
}

/// View of a text: its lines one after the other, with their numbers.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
  }
  [[nodiscard]] bool done() const { return rest_.empty(); }
  [[nodiscard]] std::size_t number() const { return number_; }
  std::string_view next() {
    const std::size_t end = rest_.find('\n');
    const std::string_view line = trimmed(rest_.substr(0, end));
    rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
    ++number_;
    return line;
  }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

void split_words(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  // With tabulators a label may hold blanks.
  const std::string_view separators = line.find('\t') != std::string_view::npos ? "\t" : kBlank;
  for (std::size_t begin = line.find_first_not_of(separators); begin != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    words.push_back(trimmed(line.substr(begin, end - begin)));
    begin = line.find_first_not_of(separators, end);
  }
}

double number_of(std::string_view word, const std::string& place, std::string_view label) {
  double value = 0.0;
  const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) {
    throw InputError(place, fmt::format("column '{}': '{}' is not a number", label, word.substr(0, 40)));
  }
  if (!std::isfinite(value))
    throw InputError(place, fmt::format("column '{}': {} is not finite", label, word.substr(0, 40)));
  return value;
}

}  // namespace

std::vector<double> Storage::column(std::size_t index) const {
  std::vector<double> result(rows());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = value(i, index);
  return result;
}

bool is_storage(std::string_view bytes) {
  constexpr std::size_t kLongestHeader = 65536;
  Lines lines(bytes.substr(0, kLongestHeader));
  while (!lines.done()) {
    if (lower(lines.next()) == "endheader") return true;
  }
  return false;
}

Storage parse_storage(std::string_view text, std::string source) {
  Storage storage;
  storage.source = std::move(source);
  Lines lines(text);
  std::size_t claimed_rows = 0;
  bool ended = false;
  while (!lines.done() && !ended) {
    const std::string_view line = lines.next();
    const std::string key = lower(trimmed(line.substr(0, line.find('='))));
    const std::string value =
        line.find('=') == std::string_view::npos ? "" : lower(trimmed(line.substr(line.find('=') + 1)));
    if (key == "endheader") {
      ended = true;
    } else if (key == "indegrees") {
      storage.in_degrees = value == "yes" || value == "true" || value == "1";
    } else if (key == "nrows" || key == "datarows") {
      std::from_chars(value.data(), value.data() + value.size(), claimed_rows);
    } else if (lines.number() == 1 && line.find('=') == std::string_view::npos) {
      storage.name = std::string(line);
    }
  }
  if (!ended) throw InputError(storage.source, "has no line 'endheader', so it is not an OpenSim storage file");
  std::vector<std::string_view> words;
  while (!lines.done() && words.empty()) split_words(lines.next(), words);
  const auto place = [&] { return fmt::format("{}:{}", storage.source, lines.number()); };
  if (words.empty() || lower(words.front()) != "time") throw InputError(place(), "the first column must be 'time'");
  std::set<std::string_view> known;
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (!known.insert(words[i]).second) throw InputError(place(), fmt::format("two columns '{}'", words[i]));
    storage.labels.emplace_back(words[i]);
  }
  if (storage.labels.empty()) throw InputError(place(), "has no column but the time");
  while (!lines.done()) {
    split_words(lines.next(), words);
    if (words.empty()) continue;
    if (words.size() != storage.labels.size() + 1) {
      throw InputError(place(), fmt::format("{} numbers under {} labels", words.size(), storage.labels.size() + 1));
    }
    const double t = number_of(words.front(), place(), "time");
    if (!storage.time.empty() && !(t > storage.time.back())) {
      throw InputError(place(), fmt::format("time {} after {} does not increase", t, storage.time.back()));
    }
    storage.time.push_back(t);
    for (std::size_t i = 0; i < storage.labels.size(); ++i) {
      storage.values.push_back(number_of(words[i + 1], place(), storage.labels[i]));
    }
  }
  if (storage.time.empty()) throw InputError(storage.source, "has no rows");
  if (claimed_rows > storage.rows()) {
    throw InputError(place(), fmt::format("ends after {} of {} rows", storage.rows(), claimed_rows));
  }
  return storage;
}

std::string to_storage_text(const Storage& storage) {
  std::string text = fmt::format("{}\nversion=1\nnRows={}\nnColumns={}\ninDegrees={}\nendheader\ntime",
                                 storage.name.empty() ? "veridyn" : storage.name, storage.rows(), storage.columns() + 1,
                                 storage.in_degrees ? "yes" : "no");
  for (const std::string& label : storage.labels) text += "\t" + label;
  text += '\n';
  for (std::size_t i = 0; i < storage.rows(); ++i) {
    fmt::format_to(std::back_inserter(text), "{}", storage.time[i]);
    for (std::size_t j = 0; j < storage.columns(); ++j)
      fmt::format_to(std::back_inserter(text), "\t{}", storage.value(i, j));
    text += '\n';
  }
  return text;
}

void write_storage(const Storage& storage, const std::filesystem::path& path) {
  write_file(path, to_storage_text(storage));
}

Log read_storage_log(std::string_view bytes, std::string source) {
  const Storage storage = parse_storage(bytes, std::move(source));
  Log log;
  log.source = storage.source;
  log.format = "OpenSim storage";
  LogTopic topic;
  topic.time = std::make_shared<const std::vector<double>>(storage.time);
  for (std::size_t i = 0; i < storage.columns(); ++i) {
    LogField field;
    field.name = internal::printable(storage.labels[i]);
    field.values = Column(storage.column(i));
    topic.fields.push_back(std::move(field));
  }
  log.topics.push_back(std::move(topic));
  log.information["name"] = internal::printable(storage.name);
  log.information["rotations in"] = storage.in_degrees ? "degrees" : "radians";
  internal::finish(log);
  return log;
}

}  // namespace veridyn::io
