#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/interruption.hpp"
#include "veridyn/numerics/ranks/rank_transport.hpp"

namespace veridyn::numerics {

/// How a process ended: its exit code, and what is to be said of it where that is not 0.
struct RankEnding {
  int exit_code = 0;
  std::string text = {};
};

/// This process among those that a launcher started together to do one work ("ranks" in MPI), counted from 0. The first
/// leads: it alone decides what comes next, prints, and writes files; the others compute what it asks for
/// (`SharedWork`). Copies are the same connection. One that is not given a transport is a process alone.
class Ranks {
 public:
  Ranks();
  /// @param interruption  ends whatever waits for another process
  Ranks(std::shared_ptr<RankTransport> transport, Interruption interruption);

  [[nodiscard]] std::size_t rank() const;
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] bool first() const { return rank() == 0; }
  [[nodiscard]] bool alone() const { return size() == 1; }
  /// "process 2 of 3", as a launcher's users count them.
  [[nodiscard]] std::string name(std::size_t rank) const;

  /// Ends the work of all: every process calls it as its last. What went wrong in another process is what the first is
  /// told where nothing went wrong in itself. After a failure the first waits for the others for some seconds only.
  /// @return what the first process has to say, and its exit code; in the others their own ending
  [[nodiscard]] RankEnding finish(RankEnding own) const;

  // What `SharedWork` is made of.

  /// Between the first process and another.
  enum class Word {
    kHere,   ///< to the first: this process has come to a shared work; what follows says to which
    kLeft,   ///< to the first: this process is at its end; exit code and text
    kDone,   ///< of the first: the shared work is done; what follows are its results
    kEnded,  ///< of the first, its last: it is at its end, or a shared work has failed
  };
  /// @param values  follow the word
  void say(std::size_t to, Word word, std::span<const double> values = {}) const;
  /// Takes the next word of another process; false where there is none.
  [[nodiscard]] bool hear(std::size_t from, Word& word, std::vector<double>& values) const;
  /// Waits for it. @throws std::runtime_error when interrupted
  [[nodiscard]] Word wait_for_word(std::size_t from, std::vector<double>& values) const;
  /// The first process: says `kEnded` to all, unless it has.
  void end_others() const;
  /// Throws what `kLeft` of another process says: InputError for exit code 2, else std::runtime_error.
  [[noreturn]] void rethrow(std::size_t from, std::span<const double> left) const;
  /// @throws std::runtime_error where the user wants the end
  void check_interruption() const;
  /// Channel 0 is that of the words.
  [[nodiscard]] RankTransport& transport() const;

 private:
  struct State;
  [[nodiscard]] RankEnding finish_first(RankEnding own) const;
  void finish_other(const RankEnding& own) const;

  std::shared_ptr<State> state_;  ///< nullptr: alone
};

/// Waits between two looks for a message: at first not for long, then for a sixteenth of the time waited, 1 ms at most.
class RankPause {
 public:
  RankPause();
  void wait() const;
  /// So long has been waited [s].
  [[nodiscard]] double seconds() const;

 private:
  double begun_;
};

}  // namespace veridyn::numerics
