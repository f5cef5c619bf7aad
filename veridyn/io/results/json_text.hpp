#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace veridyn::io {

/// A value of nlohmann's library as JSON, on one line or with `indent` blanks a level. Names out of strangers' files
/// may hold bytes that are no UTF-8: they become U+FFFD instead of an exception.
template <typename Json>
[[nodiscard]] std::string json_text(const Json& value, int indent = -1) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace veridyn::io
