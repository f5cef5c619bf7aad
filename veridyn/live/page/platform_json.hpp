#pragma once

#include <string>

#include "veridyn/cueing/platform/platform.hpp"

namespace veridyn::live {

/// What a page needs to draw a platform in space, in one line: the feet and heads of its legs, how far a leg goes from
/// its neutral length, and the rider's head; forward, right, down [m]. Without legs both lists are empty.
[[nodiscard]] std::string platform_json(const cueing::Platform& platform);

}  // namespace veridyn::live
