#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/io/log/gather.hpp"

namespace veridyn::io {

/// A field of a ULog topic with nested messages and arrays resolved.
struct ULogField {
  std::string name;       ///< "control[0]", "esc[1].esc_rpm"
  std::string base_name;  ///< "control", "esc_rpm"
  GatherType type = GatherType::kUint8;
  std::uint32_t offset = 0;  ///< bytes from the start of the data
  std::uint32_t size = 0;    ///< bytes

  friend bool operator==(const ULogField&, const ULogField&) = default;
};

/// A topic's fields and the bytes that its data must have at least (padding at the end is not logged).
struct ULogLayout {
  std::vector<ULogField> fields;
  std::uint32_t size = 0;

  friend bool operator==(const ULogLayout&, const ULogLayout&) = default;
};

/// The formats of a ULog by name, each "type name;type[n] name;...".
using ULogFormats = std::map<std::string, std::string, std::less<>>;

/// Resolves a format. Nothing when it, or one it contains, is not defined, contains itself, is malformed, or is larger
/// than a data message can be.
[[nodiscard]] std::optional<ULogLayout> resolve_ulog_format(const ULogFormats& formats, std::string_view name);

/// A typed key of ULog's information and parameter messages, "float NAME", "char[12] NAME", with the bytes of its
/// value.
struct ULogKey {
  std::string type;
  std::string name;
  std::string_view value;  ///< view of the message
};

/// The key of a message's body: its length in a byte, the key, the value. Nothing where it is cut or has no name.
[[nodiscard]] std::optional<ULogKey> parse_ulog_key(std::string_view body);

/// The value of a key of a numeric type; nothing for others, and where bytes are missing.
[[nodiscard]] std::optional<double> ulog_number(const ULogKey& key);

}  // namespace veridyn::io
