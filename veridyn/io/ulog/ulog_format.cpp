#include "veridyn/io/ulog/ulog_format.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>

#include "veridyn/core/bytes.hpp"
#include "veridyn/io/log/log.hpp"

namespace veridyn::io {
namespace {

constexpr std::uint32_t kLargestMessage = 65535;
constexpr int kDeepestNesting = 16;

struct BasicType {
  std::string_view name;
  GatherType type;
  std::uint32_t size;
};
constexpr BasicType kBasicTypes[] = {
    {"int8_t", GatherType::kInt8, 1},     {"uint8_t", GatherType::kUint8, 1},   {"int16_t", GatherType::kInt16, 2},
    {"uint16_t", GatherType::kUint16, 2}, {"int32_t", GatherType::kInt32, 4},   {"uint32_t", GatherType::kUint32, 4},
    {"int64_t", GatherType::kInt64, 8},   {"uint64_t", GatherType::kUint64, 8}, {"float", GatherType::kFloat, 4},
    {"double", GatherType::kDouble, 8},   {"bool", GatherType::kUint8, 1},      {"char", GatherType::kText, 1}};

/// View of the formats of a log, whose nested ones it resolves.
struct Resolver {
  const ULogFormats& formats;
  ULogLayout layout;
  std::uint32_t end = 0;    ///< where the next field begins
  std::uint32_t nodes = 0;  ///< formats entered; bounds the work that a hostile file can ask for

  bool run(std::string_view name, const std::string& prefix, int depth) {
    const auto found = formats.find(name);
    if (found == formats.end() || depth > kDeepestNesting || ++nodes > kLargestMessage) return false;
    std::string_view rest = found->second;
    while (!rest.empty()) {
      const std::size_t stop = std::min(rest.find(';'), rest.size());
      const std::string_view field = rest.substr(0, stop);
      rest.remove_prefix(std::min(stop + 1, rest.size()));
      if (!field.empty() && !add(field, prefix, depth)) return false;
    }
    return true;
  }

  bool add(std::string_view field, const std::string& prefix, int depth) {
    const std::size_t blank = field.find(' ');
    if (blank == std::string_view::npos || blank == 0) return false;
    std::string_view type = field.substr(0, blank);
    const std::string_view name = field.substr(blank + 1);
    std::uint32_t count = 1;
    bool array = false;
    if (const std::size_t open = type.find('['); open != std::string_view::npos) {
      const std::string_view digits = type.substr(open + 1);
      const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
      if (error != std::errc{} || stop == digits.data() + digits.size() || *stop != ']') return false;
      if (count > kLargestMessage) return false;
      array = true;
      type = type.substr(0, open);
    }
    for (const BasicType& basic : kBasicTypes) {
      if (basic.name == type) return add_basic(basic, name, prefix, count, array);
    }
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::string inner = array ? fmt::format("{}{}[{}].", prefix, name, i) : fmt::format("{}{}.", prefix, name);
      if (!run(type, inner, depth + 1)) return false;
    }
    return true;
  }

  bool add_basic(const BasicType& basic, std::string_view name, const std::string& prefix, std::uint32_t count,
                 bool array) {
    const std::uint32_t size = basic.size * count;
    if (end + size > kLargestMessage) return false;
    const bool padding = name.substr(0, 8) == "_padding";
    if (!padding) {
      const std::string whole = prefix + std::string(name);
      if (basic.type == GatherType::kText) {
        layout.fields.push_back({whole, std::string(name), basic.type, end, size});
      } else {
        for (std::uint32_t i = 0; i < count; ++i) {
          layout.fields.push_back({array ? fmt::format("{}[{}]", whole, i) : whole, std::string(name), basic.type,
                                   end + i * basic.size, basic.size});
        }
      }
      layout.size = end + size;
    }
    end += size;
    return true;
  }
};

}  // namespace

std::optional<ULogLayout> resolve_ulog_format(const ULogFormats& formats, std::string_view name) {
  Resolver resolver{formats, {}};
  if (!resolver.run(name, "", 0)) return std::nullopt;
  return std::move(resolver.layout);
}

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
