#pragma once

#include <cstdint>
#include <string_view>

#include "veridyn/core/bytes.hpp"
#include "veridyn/io/ros/message_layout.hpp"

namespace veridyn::io::internal {

/// Reads a serialised message from front to back. Past its end nothing is read: what is asked is then zero or empty,
/// and `failed()` says so from there on.
class MessageCursor {
 public:
  /// Of the message alone: without the encapsulation header that CDR has before it.
  MessageCursor(std::string_view bytes, RosEncoding encoding, bool swapped)
      : bytes_(bytes), packed_(encoding == RosEncoding::kRos1), swapped_(swapped) {}

  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] bool failed() const { return failed_; }
  void fail() { failed_ = true; }

  /// To a multiple of `size`, a power of 2.
  void align(std::size_t size) {
    if (!packed_) (void)skip((size - at_ % size) % size);
  }
  /// Where the next `size` bytes lie; null past the end.
  const char* skip(std::size_t size) {
    if (failed_ || size > left()) {
      failed_ = true;
      return nullptr;
    }
    at_ += size;
    return bytes_.data() + (at_ - size);
  }
  /// `count` numbers of `size` bytes one after the other.
  const char* numbers(std::size_t count, std::size_t size) {
    if (count == 0) return bytes_.data();
    align(size);
    if (failed_ || count > left() / size) {
      failed_ = true;
      return nullptr;
    }
    return skip(count * size);
  }
  std::uint32_t count() {
    align(4);
    const char* const at = skip(4);
    return at == nullptr ? 0 : load<std::uint32_t>(at);
  }
  double real() {
    align(8);
    const char* const at = skip(8);
    return at == nullptr ? 0.0 : load<double>(at);
  }
  /// Without the zero that ends it in CDR.
  std::string_view text() {
    const std::uint32_t size = count();
    const char* const at = skip(size);
    if (at == nullptr) return {};
    const std::string_view text(at, size);
    return text.ends_with('\0') ? text.substr(0, size - 1) : text;
  }

  template <typename Number>
  [[nodiscard]] Number load(const char* from) const {
    return load_number<Number>(from, swapped_);
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool packed_;
  bool swapped_;
  bool failed_ = false;
};

}  // namespace veridyn::io::internal
