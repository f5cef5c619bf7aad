#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "veridyn/core/bytes.hpp"

namespace veridyn::live {

/// Bytes as they go over a line.
using Bytes = std::span<const std::uint8_t>;

/// Writes numbers one after the other, least significant byte first. The caller sees to it that they fit.
class LittleEndianWriter {
 public:
  explicit LittleEndianWriter(std::span<std::uint8_t> out) : out_(out) {}

  template <class Number>
  requires std::is_arithmetic_v<Number>
  void put(Number value) {
    put_at(out_, size_, value);
    size_ += sizeof value;
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

  template <class Number>
  requires std::is_arithmetic_v<Number>
  [[nodiscard]] Number get() {
    const Number value = number_at<Number>(in_, at_);
    at_ += sizeof value;
    return value;
  }

 private:
  Bytes in_;
  std::size_t at_ = 0;
};

}  // namespace veridyn::live
