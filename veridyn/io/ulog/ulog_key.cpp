#include "veridyn/io/ulog/ulog_key.hpp"

#include <cstdint>

#include "veridyn/core/bytes.hpp"
#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

std::optional<ULogKey> parse_ulog_key(std::string_view body) {
  if (body.empty()) return std::nullopt;
  const auto length = static_cast<unsigned char>(body[0]);
  if (body.size() < 1U + length) return std::nullopt;
  const std::string_view key = body.substr(1, length);
  const std::size_t blank = key.find(' ');
  if (blank == std::string_view::npos || blank == 0 || blank + 1 == key.size()) return std::nullopt;
  return ULogKey{internal::printable(key.substr(0, blank)), internal::printable(key.substr(blank + 1)),
                 body.substr(1U + length)};
}

std::optional<double> ulog_number(const ULogKey& key) {
  const auto as = [&]<typename T>(T) -> std::optional<double> {
    if (key.value.size() < sizeof(T)) return std::nullopt;
    return static_cast<double>(load_number<T>(key.value.data()));
  };
  if (key.type == "float") return as(float{});
  if (key.type == "double") return as(double{});
  if (key.type == "int32_t") return as(std::int32_t{});
  if (key.type == "uint32_t") return as(std::uint32_t{});
  if (key.type == "int64_t") return as(std::int64_t{});
  if (key.type == "uint64_t") return as(std::uint64_t{});
  if (key.type == "int16_t") return as(std::int16_t{});
  if (key.type == "uint16_t") return as(std::uint16_t{});
  if (key.type == "int8_t") return as(std::int8_t{});
  if (key.type == "uint8_t" || key.type == "bool") return as(std::uint8_t{});
  return std::nullopt;
}

}  // namespace veridyn::io
