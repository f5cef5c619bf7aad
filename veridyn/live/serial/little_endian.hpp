#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace veridyn::live {

/// Bytes as they go over a line.
using Bytes = std::span<const std::uint8_t>;

/// Writes integers one after the other, least significant byte first, whatever the machine's own order. The caller sees
/// to it that they fit.
class LittleEndianWriter {
 public:
  explicit LittleEndianWriter(std::span<std::uint8_t> out) : out_(out) {}

  template <class Integer>
  requires std::is_integral_v<Integer>
  void put(Integer value) {
    auto rest = static_cast<std::uint64_t>(static_cast<std::make_unsigned_t<Integer>>(value));
    for (std::size_t byte = 0; byte < sizeof(Integer); ++byte, rest >>= 8U)
      out_[size_++] = static_cast<std::uint8_t>(rest & 0xFFU);
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::span<std::uint8_t> out_;
  std::size_t size_ = 0;
};

/// Reads them again. The caller sees to it that there are enough.
class LittleEndianReader {
 public:
  explicit LittleEndianReader(Bytes in) : in_(in) {}

  template <class Integer>
  requires std::is_integral_v<Integer>
  [[nodiscard]] Integer get() {
    std::uint64_t value = 0;
    for (std::size_t byte = 0; byte < sizeof(Integer); ++byte)
      value |= static_cast<std::uint64_t>(in_[at_++]) << (8U * byte);
    return static_cast<Integer>(static_cast<std::make_unsigned_t<Integer>>(value));
  }

 private:
  Bytes in_;
  std::size_t at_ = 0;
};

}  // namespace veridyn::live
