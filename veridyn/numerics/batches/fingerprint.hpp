#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

namespace veridyn::numerics {

/// Hash of what results follow from (FNV-1a, 64 bits): distinguishes batches and finds damage; no protection from
/// malice.
class Fingerprint {
 public:
  /// A text with its length, so that two texts are not one.
  void add(std::string_view text) {
    add(static_cast<std::uint64_t>(text.size()));
    for (const char c : text) step(static_cast<unsigned char>(c));
  }
  void add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) step(static_cast<unsigned char>(value >> (8 * byte)));
  }
  /// All bits of it.
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }

  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  void step(unsigned char byte) { hash_ = (hash_ ^ byte) * 0x100000001b3ULL; }

  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace veridyn::numerics
