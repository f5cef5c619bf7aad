#pragma once

#include <span>

#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

namespace veridyn::vehicle {

/// Whether steering and outputs have less noise inside `spans` than sensors have, so that the recording is a
/// simulator's: what a model leaves of it is an error of the model alone. That follows the motion, and more samples do
/// not make it smaller.
[[nodiscard]] bool is_noise_free(const DriveSignals& signals, std::span<const TimeSpan> spans);

}  // namespace veridyn::vehicle
