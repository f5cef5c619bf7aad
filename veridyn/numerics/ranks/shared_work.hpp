#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "veridyn/numerics/ranks/ranks.hpp"

namespace veridyn::numerics {

/// A function that all processes of a `Ranks` compute for the first one, whoever is free. The first runs its algorithm
/// on `threads()` threads and asks for values; the others `serve` until it has finished. Which process computes a value
/// does not matter to the algorithm, so that its results are the same on any number of them.
///
///     SharedWork work(ranks, key, progress.threads(), compute);
///     if (!ranks.first()) return work.serve();
///     parallel_for(items, work.threads(), [&](std::size_t i) { work.ask(request(i), reply[i]); });
///     work.finish(results);
///
/// All processes construct it at the same point of the program. Of a process alone `ask` is a call of the function.
class SharedWork {
 public:
  /// The reply to a request, on any thread. What it throws in another process is thrown by `ask`.
  using Compute = std::function<void(std::span<const double> request, std::vector<double>& reply)>;

  /// In the first process it waits for the others.
  /// @param key  of all that the function follows from (a `Fingerprint`); must be that of the first process
  /// @param threads  of this process; 0: as many as the machine has
  /// @throws InputError naming a process whose key is another; what went wrong in another process;
  /// std::runtime_error when interrupted.
  SharedWork(const Ranks& ranks, std::uint64_t key, int threads, Compute compute);
  /// Of the first process: without `finish` the others are told that there will be no results.
  ~SharedWork();
  SharedWork(const SharedWork&) = delete;
  SharedWork& operator=(const SharedWork&) = delete;

  [[nodiscard]] bool alone() const { return ranks_.alone(); }
  /// Of all processes together: with so many threads that ask none of them idles. 0: as many as the machine has.
  [[nodiscard]] int threads() const { return all_threads_; }
  /// The first process: the reply, computed here or elsewhere. On any thread.
  /// @throws std::runtime_error naming the process where it failed, or when interrupted
  void ask(std::span<const double> request, std::vector<double>& reply);
  /// The first process: `results` are what `serve` returns in the others.
  void finish(std::span<const double> results = {});
  /// The other processes: computes until the first has finished.
  /// @throws std::runtime_error when the first process failed or ended instead, or when interrupted
  [[nodiscard]] std::vector<double> serve();

 private:
  /// A thread that computes for the first process.
  struct Slot {
    std::size_t rank = 0;
    int channel = 0;
  };

  void wait_for_others(std::uint64_t key);
  [[nodiscard]] Slot take_slot();
  void give_back(Slot slot);
  void ask_elsewhere(Slot slot, std::span<const double> request, std::vector<double>& reply) const;
  void serve_on(int channel, std::atomic<bool>& done, Ranks::Word& end, std::vector<double>& results) const;

  Ranks ranks_;
  Compute compute_;
  int threads_, all_threads_;
  bool finished_ = false;
  std::mutex mutex_;
  std::condition_variable freed_;
  std::vector<Slot> free_;  ///< those of this process last: they are taken first
};

/// Whether all processes are about to do the same: each passes a `Fingerprint` of what that follows from.
/// @throws in the first process as the constructor of `SharedWork`; in the others as `serve`
void require_same(const Ranks& ranks, std::uint64_t key);

}  // namespace veridyn::numerics
