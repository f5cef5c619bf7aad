#include "veridyn/numerics/ranks/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

constexpr int kWords = 0;  // channel
constexpr int kWrongInput = 2;
/// After a failure the others are waited for so long: what they compute is of no use any more.
constexpr double kPatience_s = 5.0;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

std::vector<double> numbers_of(const RankEnding& ending) {
  std::vector<double> numbers = {static_cast<double>(ending.exit_code)};
  for (const char c : ending.text) numbers.push_back(static_cast<unsigned char>(c));
  return numbers;
}

RankEnding ending_of(std::span<const double> numbers) {
  RankEnding ending{.exit_code = static_cast<int>(numbers.front())};
  for (const double c : numbers.subspan(1)) ending.text += static_cast<char>(static_cast<unsigned char>(c));
  return ending;
}

}  // namespace

struct Ranks::State {
  std::shared_ptr<RankTransport> transport;
  Interruption interruption;
  std::vector<char> left;  ///< by process: its last word was heard; of the first process: was said
};

Ranks::Ranks() = default;

Ranks::Ranks(std::shared_ptr<RankTransport> transport, Interruption interruption)
    : state_(std::make_shared<State>(State{std::move(transport), std::move(interruption), {}})) {
  state_->left.resize(state_->transport->size(), 0);
}

std::size_t Ranks::rank() const { return state_ ? state_->transport->rank() : 0; }

std::size_t Ranks::size() const { return state_ ? state_->transport->size() : 1; }

std::string Ranks::name(std::size_t rank) const { return fmt::format("process {} of {}", rank + 1, size()); }

RankTransport& Ranks::transport() const {
  VERIDYN_ASSERT(state_ != nullptr);
  return *state_->transport;
}

void Ranks::check_interruption() const {
  if (state_->interruption.requested()) throw std::runtime_error("interrupted");
}

void Ranks::say(std::size_t to, Word word, std::span<const double> values) const {
  std::vector<double> message = {static_cast<double>(word)};
  message.insert(message.end(), values.begin(), values.end());
  transport().send(to, kWords, message);
}

bool Ranks::hear(std::size_t from, Word& word, std::vector<double>& values) const {
  std::vector<double> message;
  if (!transport().receive(from, kWords, message)) return false;
  word = static_cast<Word>(static_cast<int>(message.front()));
  values.assign(message.begin() + 1, message.end());
  if (word == Word::kLeft || word == Word::kEnded) state_->left[from] = 1;
  return true;
}

Ranks::Word Ranks::wait_for_word(std::size_t from, std::vector<double>& values) const {
  Word word = Word::kEnded;
  for (const RankPause pause; !hear(from, word, values); pause.wait()) check_interruption();
  return word;
}

void Ranks::end_others() const {
  if (std::exchange(state_->left[0], 1) != 0) return;
  for (std::size_t r = 1; r < size(); ++r) say(r, Word::kEnded);
}

void Ranks::rethrow(std::size_t from, std::span<const double> left) const {
  const RankEnding ending = ending_of(left);
  const std::string text = ending.text.empty() ? "ended before the others" : ending.text;
  if (ending.exit_code == kWrongInput) throw InputError(name(from), text);
  throw std::runtime_error(fmt::format("{}: {}", name(from), text));
}

RankEnding Ranks::finish(RankEnding own) const {
  if (alone()) return own;
  if (first()) return finish_first(std::move(own));
  finish_other(own);
  return own;
}

RankEnding Ranks::finish_first(RankEnding own) const {
  end_others();
  std::vector<double> values;
  const RankPause pause;
  const auto waited_enough = [&] { return own.exit_code != 0 && pause.seconds() > kPatience_s; };
  for (std::size_t r = 1; r < size(); ++r) {
    for (Word word = Word::kEnded; state_->left[r] == 0 && !waited_enough();) {
      check_interruption();
      if (!hear(r, word, values)) {
        pause.wait();
        continue;
      }
      if (word != Word::kLeft || own.exit_code != 0) continue;
      const RankEnding other = ending_of(values);
      if (other.exit_code != 0) own = {other.exit_code, fmt::format("{}: {}", name(r), other.text)};
    }
  }
  if (std::ranges::count(state_->left, 0) == 0) transport().close();
  return own;
}

void Ranks::finish_other(const RankEnding& own) const {
  say(0, Word::kLeft, numbers_of(own));
  std::vector<double> values;
  while (state_->left[0] == 0) static_cast<void>(wait_for_word(0, values));
  for (const RankPause pause; !transport().delivered(); pause.wait()) check_interruption();
  transport().close();
}

RankPause::RankPause() : begun_(now_s()) {}

void RankPause::wait() const {
  std::this_thread::sleep_for(std::chrono::duration<double>(std::clamp(seconds() / 16.0, 1e-5, 1e-3)));
}

double RankPause::seconds() const { return now_s() - begun_; }

}  // namespace veridyn::numerics
