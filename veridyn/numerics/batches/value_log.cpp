#include "veridyn/numerics/batches/value_log.hpp"

#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"

namespace veridyn::numerics {
namespace {

constexpr std::string_view kLogFormat = "veridyn values 1\n";
constexpr std::size_t kWord = sizeof(std::uint64_t);
/// Key, number of values and checksum.
constexpr std::size_t kFrameWords = 3;

void put(std::string& text, std::uint64_t word) {
  for (std::size_t byte = 0; byte < kWord; ++byte) text += static_cast<char>(word >> (8 * byte));
}

std::uint64_t word_at(std::string_view text, std::size_t place) {
  std::uint64_t word = 0;
  for (std::size_t byte = kWord; byte-- > 0;) word = word << 8 | static_cast<unsigned char>(text[place + byte]);
  return word;
}

/// Of a key and the text of its values.
std::uint64_t check_of(std::uint64_t key, std::string_view values) {
  Fingerprint sum;
  sum.add(key);
  sum.add(values);
  return sum.value();
}

}  // namespace

ValueLog::ValueLog(std::filesystem::path file) : path_(std::move(file)) {
  if (std::filesystem::exists(path_)) {
    load();
  } else {
    write_file(path_, kLogFormat);
    size_ = kLogFormat.size();
  }
  loaded_ = places_.size();
  reader_.open(path_, std::ios::binary);
}

void ValueLog::load() {
  const std::string content = read_file(path_);
  if (!std::string_view(content).starts_with(kLogFormat))
    throw InputError(path_.string(), "is no log of values of this version; remove it");
  size_ = kLogFormat.size();
  while (content.size() - size_ >= kFrameWords * kWord) {
    const std::uint64_t key = word_at(content, size_), count = word_at(content, size_ + kWord);
    if (count > (content.size() - size_) / kWord - kFrameWords) break;
    const Place place{.offset = size_ + 2 * kWord, .count = count};
    const std::size_t end = place.offset + count * kWord;
    const std::string_view values = std::string_view(content).substr(place.offset, count * kWord);
    if (word_at(content, end) != check_of(key, values))
      throw InputError(path_.string(), fmt::format("record {} is damaged; remove the file", places_.size() + 1));
    places_.emplace(key, place);
    size_ = end + kWord;
  }
  if (size_ < content.size()) write_file(path_, std::string_view(content).substr(0, size_));
}

bool ValueLog::find(std::uint64_t key, std::vector<double>& values) const {
  const std::lock_guard lock(mutex_);
  const auto found = places_.find(key);
  if (found == places_.end()) return false;
  std::string text(found->second.count * kWord, '\0');
  reader_.clear();
  reader_.seekg(static_cast<std::streamoff>(found->second.offset));
  if (!reader_.read(text.data(), static_cast<std::streamsize>(text.size())))
    throw std::runtime_error(fmt::format("{}: cannot be read any more", path_.string()));
  values.resize(found->second.count);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::bit_cast<double>(word_at(text, i * kWord));
  return true;
}

void ValueLog::append(std::uint64_t key, std::span<const double> values) {
  std::string text;
  text.reserve(values.size() * kWord);
  for (const double v : values) put(text, std::bit_cast<std::uint64_t>(v));
  std::string record;
  put(record, key);
  put(record, static_cast<std::uint64_t>(values.size()));
  record += text;
  put(record, check_of(key, text));
  const std::lock_guard lock(mutex_);
  const Place place{.offset = size_ + 2 * kWord, .count = values.size()};
  if (!places_.emplace(key, place).second) return;
  std::ofstream file(path_, std::ios::binary | std::ios::app);
  file.write(record.data(), static_cast<std::streamsize>(record.size()));
  file.close();
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be continued: {}", path_.string(), std::strerror(errno)));
  size_ += record.size();
}

}  // namespace veridyn::numerics
