#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <tuple>
#include <vector>

#include "veridyn/numerics/ranks/ranks.hpp"

namespace veridyn::test {

/// The mailbox of processes that are threads here.
struct Mailbox {
  using Address = std::tuple<std::size_t, std::size_t, int>;  ///< from, to, channel
  std::mutex mutex;
  std::map<Address, std::deque<std::vector<double>>> messages;
};

/// One of several processes, as a thread of this one: what `Ranks` do without MPI.
class ThreadTransport final : public numerics::RankTransport {
 public:
  ThreadTransport(std::shared_ptr<Mailbox> mailbox, std::size_t rank, std::size_t size)
      : mailbox_(std::move(mailbox)), rank_(rank), size_(size) {}
  [[nodiscard]] std::size_t rank() const override { return rank_; }
  [[nodiscard]] std::size_t size() const override { return size_; }
  void send(std::size_t to, int channel, std::span<const double> message) override {
    const std::lock_guard lock(mailbox_->mutex);
    mailbox_->messages[{rank_, to, channel}].emplace_back(message.begin(), message.end());
  }
  [[nodiscard]] bool receive(std::size_t from, int channel, std::vector<double>& message) override {
    const std::lock_guard lock(mailbox_->mutex);
    std::deque<std::vector<double>>& waiting = mailbox_->messages[{from, rank_, channel}];
    if (waiting.empty()) return false;
    message = std::move(waiting.front());
    waiting.pop_front();
    return true;
  }
  [[nodiscard]] bool delivered() override { return true; }
  void close() override { closed = true; }

  bool closed = false;

 private:
  std::shared_ptr<Mailbox> mailbox_;
  std::size_t rank_, size_;
};

/// Runs `process` as each of `size` processes at once, and returns when all have ended.
inline void run_ranks(std::size_t size, const std::function<void(const numerics::Ranks&)>& process,
                      const Interruption& interruption = {}) {
  const auto mailbox = std::make_shared<Mailbox>();
  std::vector<std::thread> threads;
  for (std::size_t r = 0; r < size; ++r)
    threads.emplace_back(
        [&, r] { process(numerics::Ranks(std::make_shared<ThreadTransport>(mailbox, r, size), interruption)); });
  for (std::thread& t : threads) t.join();
}

}  // namespace veridyn::test
