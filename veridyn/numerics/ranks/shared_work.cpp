#include "veridyn/numerics/ranks/shared_work.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::numerics {
namespace {

constexpr int kFirstChannel = 1;
/// The last number of a reply: what came before it is the reply, or what went wrong.
constexpr double kComputed = 0.0, kFailed = 1.0;

int threads_or_all(int threads) {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Two whole numbers: a double does not hold 64 bits.
std::array<double, 2> halves(std::uint64_t key) {
  return {static_cast<double>(key >> 32), static_cast<double>(key & 0xffffffffU)};
}

}  // namespace

SharedWork::SharedWork(const Ranks& ranks, std::uint64_t key, int threads, Compute compute)
    : ranks_(ranks), compute_(std::move(compute)), threads_(threads), all_threads_(threads) {
  if (ranks_.alone()) return;
  threads_ = all_threads_ = threads_or_all(threads);
  if (ranks_.first()) {
    wait_for_others(key);
    return;
  }
  const auto [high, low] = halves(key);
  ranks_.say(0, Ranks::Word::kHere, std::array{high, low, static_cast<double>(threads_)});
}

SharedWork::~SharedWork() {
  if (finished_ || ranks_.alone() || !ranks_.first()) return;
  try {
    ranks_.end_others();
  } catch (const std::exception&) {
    return;  // the connection is lost, which is why this ends
  }
}

void SharedWork::wait_for_others(std::uint64_t key) {
  const auto [high, low] = halves(key);
  std::vector<double> said;
  for (std::size_t r = 1; r < ranks_.size(); ++r) {
    if (ranks_.wait_for_word(r, said) != Ranks::Word::kHere) ranks_.rethrow(r, said);
    if (said[0] != high || said[1] != low)
      throw InputError(ranks_.name(r),
                       "has another study, other files or another version than the first process, or its machine "
                       "rounds otherwise; all processes need the same");
    const int threads = static_cast<int>(said[2]);
    for (int t = 0; t < threads; ++t) free_.push_back({.rank = r, .channel = kFirstChannel + t});
    all_threads_ += threads;
  }
  for (int t = 0; t < threads_; ++t) free_.push_back({});
}

SharedWork::Slot SharedWork::take_slot() {
  using namespace std::chrono_literals;
  std::unique_lock lock(mutex_);
  for (ranks_.check_interruption(); free_.empty(); ranks_.check_interruption()) freed_.wait_for(lock, 20ms);
  const Slot slot = free_.back();
  free_.pop_back();
  return slot;
}

void SharedWork::give_back(Slot slot) {
  {
    const std::lock_guard lock(mutex_);
    if (slot.rank == 0)
      free_.push_back(slot);
    else
      free_.insert(free_.begin(), slot);
  }
  freed_.notify_one();
}

void SharedWork::ask(std::span<const double> request, std::vector<double>& reply) {
  if (ranks_.alone()) return compute_(request, reply);
  VERIDYN_ASSERT(ranks_.first() && !finished_);
  // One that failed is not used again: the work ends.
  const Slot slot = take_slot();
  if (slot.rank == 0)
    compute_(request, reply);
  else
    ask_elsewhere(slot, request, reply);
  give_back(slot);
}

void SharedWork::ask_elsewhere(Slot slot, std::span<const double> request, std::vector<double>& reply) const {
  RankTransport& transport = ranks_.transport();
  transport.send(slot.rank, slot.channel, request);
  for (const RankPause pause; !transport.receive(slot.rank, slot.channel, reply); pause.wait())
    ranks_.check_interruption();
  const bool failed = reply.back() == kFailed;
  reply.pop_back();
  if (!failed) return;
  std::string text;
  for (const double c : reply) text += static_cast<char>(static_cast<unsigned char>(c));
  throw std::runtime_error(fmt::format("{}: {}", ranks_.name(slot.rank), text));
}

void SharedWork::finish(std::span<const double> results) {
  finished_ = true;
  if (ranks_.alone()) return;
  VERIDYN_ASSERT(ranks_.first());
  for (std::size_t r = 1; r < ranks_.size(); ++r) ranks_.say(r, Ranks::Word::kDone, results);
  // Whoever has to be helped to receive them is not while this process does something else.
  for (const RankPause pause; !ranks_.transport().delivered(); pause.wait()) ranks_.check_interruption();
}

std::vector<double> SharedWork::serve() {
  VERIDYN_ASSERT(!ranks_.first());
  std::atomic<bool> done = false;
  Ranks::Word end = Ranks::Word::kEnded;
  std::vector<double> results;
  const auto threads = static_cast<std::size_t>(threads_);
  parallel_for(threads, threads_,
               [&](std::size_t t) { serve_on(kFirstChannel + static_cast<int>(t), done, end, results); });
  if (end != Ranks::Word::kDone) throw std::runtime_error("the first process ended");
  return results;
}

void SharedWork::serve_on(int channel, std::atomic<bool>& done, Ranks::Word& end, std::vector<double>& results) const {
  RankTransport& transport = ranks_.transport();
  std::vector<double> request, reply;
  RankPause pause;
  while (!done) {
    ranks_.check_interruption();
    if (transport.receive(0, channel, request)) {
      try {
        compute_(request, reply);
        reply.push_back(kComputed);
      } catch (const std::exception& error) {
        const std::string text = error.what();
        reply.assign(text.begin(), text.end());
        reply.push_back(kFailed);
      }
      transport.send(0, channel, reply);
      pause = RankPause();
    } else if (channel == kFirstChannel && ranks_.hear(0, end, results)) {
      done = true;
    } else {
      pause.wait();
    }
  }
}

void require_same(const Ranks& ranks, std::uint64_t key) {
  SharedWork nothing(ranks, key, 1, {});
  if (ranks.first())
    nothing.finish();
  else
    static_cast<void>(nothing.serve());
}

}  // namespace veridyn::numerics
