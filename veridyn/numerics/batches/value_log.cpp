#include "veridyn/numerics/batches/value_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ranges>
#include <stdexcept>
#include <thread>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/numerics/batches/fingerprint.hpp"

namespace veridyn::numerics {
namespace {

constexpr std::string_view kLogFormat = "veridyn values 1\n";
constexpr std::size_t kWord = sizeof(std::uint64_t);
/// Key, number of values and checksum.
constexpr std::size_t kFrameWords = 3;
/// A process that lives and for so many times the patience has not computed what it should never will.
constexpr double kNeverComes = 10.0;

constexpr std::string_view kLogName = "evaluations";

/// Of the process with that index.
std::filesystem::path file_in(const std::filesystem::path& folder, std::size_t index) {
  return folder / (index == 0 ? fmt::format("{}.log", kLogName) : fmt::format("{}-{}.log", kLogName, index + 1));
}

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

const std::filesystem::path& made(const std::filesystem::path& folder) {
  make_folder(folder);
  return folder;
}

}  // namespace

ValueLog::ValueLog(std::filesystem::path folder, const ProcessShare& share, std::function<bool()> interrupted)
    : folder_(std::move(folder)),
      share_(share),
      interrupted_(std::move(interrupted)),
      companions_(made(folder_), share_) {
  open_own();
  open_others();
  loaded_ = places_.size();
}

void ValueLog::open_own() {
  files_.resize(std::max<std::size_t>(1, share_.count));
  for (std::size_t i = 0; i < files_.size(); ++i) files_[i].path = file_in(folder_, i);
  File& own = files_[share_.index];
  lock_ = std::make_unique<FileLock>(own.path);
  const std::string content = read_file(own.path);
  if (content.size() < kLogFormat.size() && kLogFormat.starts_with(content)) {
    std::ofstream file(own.path, std::ios::binary | std::ios::trunc);
    file << kLogFormat << std::flush;
    if (!file)
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", own.path.string(), std::strerror(errno)));
    own.size = kLogFormat.size();
    return;
  }
  take_records(share_.index, content, true);
  // In place: others may be reading it.
  if (own.size < content.size()) std::filesystem::resize_file(own.path, own.size);
}

void ValueLog::open_others() const {
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kLogName) || entry.path().extension() != ".log") continue;
    if (std::ranges::find(files_, entry.path(), &File::path) == files_.end()) files_.push_back({.path = entry.path()});
  }
  for (std::size_t i = 0; i < files_.size(); ++i)
    if (i != share_.index) static_cast<void>(look_at(i, true));
}

void ValueLog::take_records(std::size_t file, std::string_view content, bool strict) const {
  File& f = files_[file];
  const std::size_t from = f.size;
  if (from == 0) {
    if (!content.starts_with(kLogFormat)) {
      // Another process may be about to begin it.
      if (!strict && kLogFormat.starts_with(content)) return;
      throw InputError(f.path.string(), "is no log of values of this version; remove it");
    }
    f.size = kLogFormat.size();
  }
  while (from + content.size() - f.size >= kFrameWords * kWord) {
    const std::size_t at = f.size - from, rest = content.size() - at;
    const std::uint64_t key = word_at(content, at), count = word_at(content, at + kWord);
    if (count > rest / kWord - kFrameWords) return;
    const std::string_view values = content.substr(at + 2 * kWord, count * kWord);
    if (word_at(content, at + 2 * kWord + count * kWord) != check_of(key, values)) {
      // Of another process: half of it may still be on its way.
      if (!strict) return;
      throw InputError(f.path.string(), fmt::format("record {} is damaged; remove the file", places_.size() + 1));
    }
    places_.emplace(key, Place{.file = file, .offset = f.size + 2 * kWord, .count = count});
    f.size += (kFrameWords + count) * kWord;
  }
}

bool ValueLog::look_at(std::size_t file, bool reopen) const {
  File& f = files_[file];
  std::uintmax_t size = 0;
  if (reopen) {
    f.reader.close();
    f.reader.clear();
    f.reader.open(f.path, std::ios::binary | std::ios::ate);
    if (!f.reader.is_open()) return false;
    size = static_cast<std::uintmax_t>(std::max<std::streamoff>(0, f.reader.tellg()));
  } else {
    std::error_code absent;
    size = std::filesystem::file_size(f.path, absent);
    if (absent) return false;
  }
  if (size <= f.size) return false;
  const std::size_t before = f.size;
  // Nobody writes those of an earlier run.
  take_records(file, text_of(f, f.size, size - f.size), file >= share_.count);
  return f.size > std::max(before, kLogFormat.size());
}

std::string ValueLog::text_of(File& file, std::size_t offset, std::size_t size) {
  if (!file.reader.is_open()) file.reader.open(file.path, std::ios::binary);
  file.reader.clear();
  file.reader.seekg(static_cast<std::streamoff>(offset));
  std::string text(size, '\0');
  if (!file.reader.read(text.data(), static_cast<std::streamsize>(size)))
    throw std::runtime_error(fmt::format("{}: cannot be read any more", file.path.string()));
  return text;
}

bool ValueLog::found(std::uint64_t key, std::vector<double>& values) const {
  const auto place = places_.find(key);
  if (place == places_.end()) return false;
  const auto& [file, offset, count] = place->second;
  const std::string record = text_of(files_[file], offset - 2 * kWord, (count + kFrameWords) * kWord);
  const std::string_view text = std::string_view(record).substr(2 * kWord, count * kWord);
  if (word_at(record, 0) != key || word_at(record, record.size() - kWord) != check_of(key, text))
    throw std::runtime_error(
        fmt::format("{}: was changed by something else while this runs", files_[file].path.string()));
  values.resize(count);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::bit_cast<double>(word_at(text, i * kWord));
  return true;
}

bool ValueLog::find(std::uint64_t key, std::vector<double>& values, std::size_t item) const {
  {
    const std::lock_guard lock(mutex_);
    if (found(key, values)) return true;
  }
  if (!share_.wait || share_.computes(item)) return false;
  try {
    return wait_for(key, values, share_.owner(item));
  } catch (...) {
    failed_ = true;
    throw;
  }
}

bool ValueLog::wait_for(std::uint64_t key, std::vector<double>& values, std::size_t owner) const {
  using namespace std::chrono_literals;
  constexpr auto kPatient = 5ms;
  for (std::chrono::microseconds pause = 50us; !failed_ && (interrupted_ == nullptr || !interrupted_());
       pause = std::min<std::chrono::microseconds>(2 * pause, 20ms)) {
    {
      const std::lock_guard lock(mutex_);
      if (has_come(key, values, owner, pause > kPatient)) return true;
    }
    std::this_thread::sleep_for(pause);
  }
  return false;
}

bool ValueLog::has_come(std::uint64_t key, std::vector<double>& values, std::size_t owner, bool patient) const {
  bool alive = look_at(owner, patient);
  // It may stand in another file: of a process of an earlier run that had not ended.
  if (patient) open_others();
  const bool there = found(key, values);
  alive = alive || there;
  if (alive) companions_.arrived(owner);
  if (there || !patient || alive) return there;
  const double waited = companions_.wait_for(owner, "what it computes is missing");
  if (waited > kNeverComes * share_.patience_s)
    throw std::runtime_error(fmt::format(
        "{}: process {} of {} lives, but has computed nothing for {:.0f} s that is waited for here: it is busy with "
        "something else, or on another path, as on a machine whose processor or mathematical library rounds "
        "differently; use machines of one kind",
        folder_.string(), owner + 1, share_.count, waited));
  return false;
}

void ValueLog::append(std::uint64_t key, std::span<const double> values) {
  try {
    write_record(key, values);
  } catch (...) {
    failed_ = true;
    throw;
  }
}

void ValueLog::write_record(std::uint64_t key, std::span<const double> values) {
  std::string text;
  text.reserve(values.size() * kWord);
  for (const double v : values) put(text, std::bit_cast<std::uint64_t>(v));
  std::string record;
  put(record, key);
  put(record, static_cast<std::uint64_t>(values.size()));
  record += text;
  put(record, check_of(key, text));
  const std::lock_guard lock(mutex_);
  File& own = files_[share_.index];
  const Place place{.file = share_.index, .offset = own.size + 2 * kWord, .count = values.size()};
  if (!places_.emplace(key, place).second) return;
  std::ofstream file(own.path, std::ios::binary | std::ios::app);
  file.write(record.data(), static_cast<std::streamsize>(record.size()));
  file.close();
  if (!file)
    throw std::runtime_error(fmt::format("{}: cannot be continued: {}", own.path.string(), std::strerror(errno)));
  own.size += record.size();
}

}  // namespace veridyn::numerics
