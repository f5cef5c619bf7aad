#include "veridyn/live/virtual/noisy_line.hpp"

#include <algorithm>
#include <cmath>

namespace veridyn::live {

FlippedBytes::FlippedBytes(double probability, std::uint64_t seed, bool single_bits)
    : probability_(probability), single_bits_(single_bits), random_(seed, "line") {
  next_ = gap();
}

std::size_t FlippedBytes::damage(std::span<std::uint8_t> bytes) {
  std::size_t flipped = 0;
  while (next_ < bytes.size()) {
    bytes[next_] ^= static_cast<std::uint8_t>(single_bits_ ? 1U << random_.index(8) : 1 + random_.index(255));
    ++flipped;
    next_ += 1 + gap();
  }
  next_ -= bytes.size();
  return flipped;
}

std::size_t FlippedBytes::gap() {
  return static_cast<std::size_t>(std::log1p(-random_.uniform()) / std::log1p(-probability_));
}

NoisyLine::NoisyLine(double flipped, std::uint64_t seed, int baud)
    : flipped_(flipped), byte_(10 * kSecond / baud), damage_(flipped > 0.0 ? flipped : 0.5, seed) {}

void NoisyLine::send(Bytes bytes, Nanoseconds now) {
  std::vector<std::uint8_t> sent(bytes.begin(), bytes.end());
  if (flipped_ > 0.0) damage_.damage(sent);
  free_at_ = std::max(free_at_, now);
  for (const std::uint8_t byte : sent) {
    free_at_ += byte_;
    if (cut) continue;
    last_arrival_ = std::max(free_at_ + delay, last_arrival_);
    on_the_way_.emplace_back(last_arrival_, byte);
  }
}

std::vector<std::uint8_t> NoisyLine::arrived(Nanoseconds now) {
  std::vector<std::uint8_t> bytes;
  for (; !on_the_way_.empty() && on_the_way_.front().first <= now; on_the_way_.pop_front())
    bytes.push_back(on_the_way_.front().second);
  return bytes;
}

std::optional<Nanoseconds> NoisyLine::last_arrival() const {
  if (on_the_way_.empty()) return std::nullopt;
  return on_the_way_.back().first;
}

}  // namespace veridyn::live
