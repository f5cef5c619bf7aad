#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace veridyn::io {

/// What a file of recordings is that is known but not read, and what to do instead, as the rest of a sentence about it:
/// "is an ASAM MDF file, which is not read: ...". Empty for all else.
[[nodiscard]] std::optional<std::string> format_not_read(std::string_view bytes);

}  // namespace veridyn::io
