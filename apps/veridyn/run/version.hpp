#pragma once

#include <string>
#include <string_view>

namespace veridyn::app {

/// The version of the CMake project: "0.7.0".
[[nodiscard]] std::string_view version();

/// Who made a result, for reports: "veridyn 0.7.0".
[[nodiscard]] std::string program_name();

}  // namespace veridyn::app
