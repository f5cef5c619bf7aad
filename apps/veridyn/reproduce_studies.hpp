#pragma once

#include <span>

#include "veridyn/core/embedded_text.hpp"

namespace veridyn::app {

/// examples/reproduce/aircraft, in order.
[[nodiscard]] std::span<const EmbeddedText> aircraft_studies();

}  // namespace veridyn::app
