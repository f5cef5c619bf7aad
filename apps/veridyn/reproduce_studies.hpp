#pragma once

#include <span>

#include "veridyn/core/embedded_text.hpp"

namespace veridyn::app {

/// examples/reproduce/aircraft, in order.
[[nodiscard]] std::span<const EmbeddedText> aircraft_studies();
/// examples/reproduce/vehicle, in order.
[[nodiscard]] std::span<const EmbeddedText> vehicle_studies();
/// examples/reproduce/muscle, in order.
[[nodiscard]] std::span<const EmbeddedText> muscle_studies();
/// examples/reproduce/cueing, in order.
[[nodiscard]] std::span<const EmbeddedText> cueing_studies();

}  // namespace veridyn::app
