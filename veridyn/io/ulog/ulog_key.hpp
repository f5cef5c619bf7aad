#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace veridyn::io {

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
