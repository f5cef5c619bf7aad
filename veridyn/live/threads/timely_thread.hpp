#pragma once

#include <string>

namespace veridyn::live {

/// Asks the kernel to wake this thread on time: real-time priority, memory that stays in, no timer slack.
/// @return what was refused, in words; empty where nothing was
[[nodiscard]] std::string make_thread_timely();

}  // namespace veridyn::live
