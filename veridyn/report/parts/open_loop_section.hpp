#pragma once

#include "veridyn/estimation/open_loop/open_loop.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// What an identified model does open loop, from recorded inputs alone: scores of each state, predicted against
/// measured with the 95 % bands, where each window started. Without blocks where nothing was asked for.
[[nodiscard]] Section open_loop_section(const estimation::OpenLoop& open_loop);

}  // namespace veridyn::report
