#include "veridyn/live/recording/growing_live_file.hpp"

#include <algorithm>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::live {

namespace fs = std::filesystem;

GrowingLiveFile::GrowingLiveFile(fs::path path) : path_(std::move(path)), file_(path_, std::ios::binary) {
  if (!file_ || !fs::is_regular_file(path_)) throw InputError(path_.string(), "cannot be read");
}

double GrowingLiveFile::share() const {
  return size_ > 0 ? static_cast<double>(read_) / static_cast<double>(size_) : 0.0;
}

/// Reads on. @return whether there was anything
bool GrowingLiveFile::fetch() {
  constexpr std::uintmax_t kAtOnce = 1U << 20U;
  std::error_code error;
  size_ = fs::file_size(path_, error);
  if (error || size_ < read_) throw InputError(path_.string(), "became shorter while it was read");
  const std::size_t more = static_cast<std::size_t>(std::min(size_ - read_, kAtOnce));
  if (more == 0) return false;
  const std::size_t before = bytes_.size();
  bytes_.resize(before + more);
  file_.clear();  // of the end that it came to last time
  file_.read(bytes_.data() + before, static_cast<std::streamsize>(more));
  const std::size_t got = at(file_.gcount());
  bytes_.resize(before + got);
  read_ += got;
  return got > 0;
}

bool GrowingLiveFile::read(const std::function<void(const LiveRecord&)>& use) {
  if (!fetch()) return false;
  std::size_t from = 0;
  while (const std::optional<std::string_view> content = next_block(bytes_, from, true, damaged_)) {
    if (!head_) {
      head_ = decode_head(*content);
      if (!head_) throw InputError(path_.string(), "is no recording of a live run: it has no head");
    } else if (!for_each_record(*content, use)) {
      ++damaged_;
    }
  }
  bytes_.erase(0, from);
  constexpr std::size_t kLongestWithoutHead = 64;
  if (!head_ && bytes_.size() > kLongestWithoutHead && !bytes_.starts_with("BLK1"))
    throw InputError(path_.string(), "is no recording of a live run: it has no head");
  return true;
}

}  // namespace veridyn::live
