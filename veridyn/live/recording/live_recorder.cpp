#include "veridyn/live/recording/live_recorder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>
#include <thread>

#include "veridyn/core/error.hpp"

namespace veridyn::live {
namespace {

constexpr std::size_t kRing = 4U << 20U;    // [bytes]: more than a second of whatever comes in
constexpr std::size_t kBlock = 64U << 10U;  // [bytes]
constexpr std::chrono::milliseconds kBetweenWrites(50), kLongestBlock(250);

}  // namespace

struct LiveRecorder::Shared {
  // Each record goes in whole: its length before it.
  boost::lockfree::spsc_queue<char, boost::lockfree::capacity<kRing>> ring;
  std::atomic<std::uint64_t> lost{0};
  std::atomic<bool> ended{false};
  mutable std::mutex mutex;  // of `trouble`, which the loop never touches
  std::string trouble;
  int file = -1;
  off_t whole = 0;  ///< end of the last whole block
  std::string block;
  std::uint64_t in_block = 0;  ///< records
  std::thread writer;

  void fail(const char* what) {
    const std::lock_guard lock(mutex);
    trouble = fmt::format("{}: {}", what, std::strerror(errno));
  }

  /// A block is written whole or taken back.
  bool write_block(std::string_view content) {
    const std::string bytes = framed(content);
    std::size_t at = 0;
    while (at < bytes.size()) {
      const ssize_t n = ::write(file, bytes.data() + at, bytes.size() - at);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        fail("the recording cannot be written");
        if (::ftruncate(file, whole) == 0) ::lseek(file, whole, SEEK_SET);
        return false;
      }
      at += static_cast<std::size_t>(n);
    }
    whole += static_cast<off_t>(bytes.size());
    return true;
  }

  void end_block() {
    if (block.empty()) return;
    if (!write_block(block)) lost += in_block;
    block.clear();
    in_block = 0;
  }

  /// Takes what is there. @return whether there was anything
  bool take() {
    bool any = false;
    std::array<char, kLargestRecord> bytes{};
    while (ring.read_available() >= 2) {
      std::uint16_t length = 0;
      ring.pop(reinterpret_cast<char*>(&length), sizeof length);
      ring.pop(bytes.data(), length);
      block.append(bytes.data(), length);
      ++in_block;
      any = true;
      if (block.size() >= kBlock) end_block();
    }
    return any;
  }

  void write_all() {
    auto last = std::chrono::steady_clock::now();
    while (true) {
      const bool over = ended.load();
      take();
      const auto now = std::chrono::steady_clock::now();
      if (over || now - last >= kLongestBlock) {
        end_block();
        last = now;
      }
      if (over) return;
      std::this_thread::sleep_for(kBetweenWrites);
    }
  }
};

LiveRecorder::LiveRecorder(const std::filesystem::path& path, const LiveHead& head)
    : shared_(std::make_unique<Shared>()) {
  shared_->file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (shared_->file < 0) throw InputError(path.string(), std::strerror(errno));
  shared_->block.reserve(2 * kBlock);
  if (!shared_->write_block(encode(head))) {
    ::close(shared_->file);
    throw InputError(path.string(), shared_->trouble);
  }
  shared_->writer = std::thread([shared = shared_.get()] { shared->write_all(); });
}

LiveRecorder::~LiveRecorder() {
  shared_->ended = true;
  shared_->writer.join();
  ::close(shared_->file);
}

void LiveRecorder::record(const LiveRecord& record) {
  std::array<char, 2 + kLargestRecord> bytes;  // not set to zero: this is on the loop's path
  const std::size_t length = encode(record, std::span(bytes).subspan(2));
  const auto told = static_cast<std::uint16_t>(length);
  std::memcpy(bytes.data(), &told, sizeof told);
  if (shared_->ring.write_available() < length + 2) {
    ++shared_->lost;
    return;
  }
  shared_->ring.push(bytes.data(), length + 2);
}

std::uint64_t LiveRecorder::lost() const { return shared_->lost; }

std::string LiveRecorder::trouble() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->trouble;
}

}  // namespace veridyn::live
