#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

namespace veridyn::numerics {

/// Shows other processes by a file that this one lives: a thread of its own counts in it until the end, when the file
/// goes. Content: machine, process and count.
class Heartbeat {
 public:
  explicit Heartbeat(std::filesystem::path file, std::chrono::milliseconds period = std::chrono::seconds(2));
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

 private:
  void beat_until_stopped(std::chrono::milliseconds period);

  std::filesystem::path file_;
  std::mutex mutex_;
  std::condition_variable stopping_;
  bool stop_ = false;
  std::thread thread_;
};

/// Looks after the heartbeat of another process. Only changes of the file count, on this machine's clock: clocks of
/// two machines need not agree.
class HeartbeatWatch {
 public:
  explicit HeartbeatWatch(std::filesystem::path file);

  /// How long nothing changed; looks at the file.
  [[nodiscard]] std::chrono::duration<double> silence();
  /// "node7, process 4711" as last seen; empty: there was never a file.
  [[nodiscard]] std::string who() const;

 private:
  std::filesystem::path file_;
  std::string seen_;
  std::chrono::steady_clock::time_point changed_;
};

}  // namespace veridyn::numerics
