#include "veridyn/numerics/batches/heartbeat.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <iterator>
#include <utility>

namespace veridyn::numerics {

Heartbeat::Heartbeat(std::filesystem::path file, std::chrono::milliseconds period)
    : file_(std::move(file)), thread_([this, period] { beat_until_stopped(period); }) {}

Heartbeat::~Heartbeat() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  stopping_.notify_all();
  thread_.join();
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

void Heartbeat::beat_until_stopped(std::chrono::milliseconds period) {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host.front() = '\0';
  std::unique_lock lock(mutex_);
  for (unsigned long count = 1; !stop_; ++count) {
    // In place: on a network file system an opened file is up to date, while a renamed one may be seen a minute later.
    // Always of one length and never emptied first, so that who looks between sees the last beat.
    std::ofstream file(file_, std::ios::in | std::ios::out);
    if (!file) file.open(file_, std::ios::trunc);
    file << fmt::format("{}, process {}\n{:020}\n", host.data(), ::getpid(), count);
    file.close();
    stopping_.wait_for(lock, period, [this] { return stop_; });
  }
}

HeartbeatWatch::HeartbeatWatch(std::filesystem::path file)
    : file_(std::move(file)), changed_(std::chrono::steady_clock::now()) {}

std::chrono::duration<double> HeartbeatWatch::silence() {
  std::ifstream file(file_);
  std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto now = std::chrono::steady_clock::now();
  // No or an empty file is before the first beat, or after the end of the process.
  if (!content.empty() && content != seen_) {
    seen_ = std::move(content);
    changed_ = now;
  }
  return now - changed_;
}

std::string HeartbeatWatch::who() const { return seen_.substr(0, seen_.find('\n')); }

}  // namespace veridyn::numerics
