#include "veridyn/numerics/batches/value_log.hpp"

#include <fmt/format.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

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

std::runtime_error not_written(const std::filesystem::path& path) {
  return std::runtime_error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
}

FileLock locked(const std::filesystem::path& folder, const std::filesystem::path& path) {
  make_folder(folder);
  return FileLock(path);
}

}  // namespace

ValueLog::ValueLog(std::filesystem::path folder)
    : folder_(std::move(folder)), path_(folder_ / "evaluations.log"), lock_(locked(folder_, path_)) {
  const std::string content = read_file(path_);
  if (content.size() < kLogFormat.size() && kLogFormat.starts_with(content)) {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    file << kLogFormat << std::flush;
    if (!file) throw not_written(path_);
    size_ = kLogFormat.size();
    return;
  }
  take_records(content);
  if (size_ < content.size()) std::filesystem::resize_file(path_, size_);
  loaded_ = places_.size();
}

void ValueLog::take_records(std::string_view content) {
  if (!content.starts_with(kLogFormat))
    throw InputError(path_.string(), "is no log of values of this version; remove it");
  size_ = kLogFormat.size();
  while (content.size() - size_ >= kFrameWords * kWord) {
    const std::uint64_t key = word_at(content, size_), count = word_at(content, size_ + kWord);
    if (count > (content.size() - size_) / kWord - kFrameWords) return;
    const std::string_view values = content.substr(size_ + 2 * kWord, count * kWord);
    if (word_at(content, size_ + 2 * kWord + count * kWord) != check_of(key, values))
      throw InputError(path_.string(), fmt::format("record {} is damaged; remove the file", places_.size() + 1));
    places_.emplace(key, Place{.offset = size_ + 2 * kWord, .count = count});
    size_ += (kFrameWords + count) * kWord;
  }
}

std::string ValueLog::text_of(std::size_t offset, std::size_t size) const {
  if (!reader_.is_open()) reader_.open(path_, std::ios::binary);
  reader_.clear();
  reader_.seekg(static_cast<std::streamoff>(offset));
  std::string text(size, '\0');
  if (!reader_.read(text.data(), static_cast<std::streamsize>(size)))
    throw std::runtime_error(fmt::format("{}: cannot be read any more", path_.string()));
  return text;
}

bool ValueLog::find(std::uint64_t key, std::vector<double>& values) const {
  const std::lock_guard lock(mutex_);
  const auto found = places_.find(key);
  if (found == places_.end()) return false;
  const auto& [offset, count] = found->second;
  const std::string record = text_of(offset - 2 * kWord, (count + kFrameWords) * kWord);
  const std::string_view text = std::string_view(record).substr(2 * kWord, count * kWord);
  if (word_at(record, 0) != key || word_at(record, record.size() - kWord) != check_of(key, text))
    throw std::runtime_error(fmt::format("{}: was changed by something else while this runs", path_.string()));
  values.resize(count);
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
  if (!places_.emplace(key, Place{.offset = size_ + 2 * kWord, .count = values.size()}).second) return;
  std::ofstream file(path_, std::ios::binary | std::ios::app);
  file.write(record.data(), static_cast<std::streamsize>(record.size()));
  file.close();
  if (!file) throw std::runtime_error(fmt::format("{}: cannot be continued: {}", path_.string(), std::strerror(errno)));
  size_ += record.size();
}

}  // namespace veridyn::numerics
