#pragma once

#include <span>

#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimate.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

namespace veridyn::vehicle {

/// Whether steering and outputs have less noise inside `spans` than sensors have, so that the recording is a
/// simulator's: what a model leaves of it is an error of the model alone. That follows the motion, and more samples do
/// not make it smaller.
[[nodiscard]] bool is_noise_free(const DriveSignals& signals, std::span<const TimeSpan> spans);

/// By how much variances grow where the residual is one error from the first sample to the last, and aligned with what
/// a parameter does: sqrt(samples) times the standard error of white noise of its rms (Cauchy-Schwarz).
[[nodiscard]] double model_error_factor(const estimation::OutputErrorEstimate& fit, const DriveSignals& signals,
                                        std::span<const TimeSpan> spans);

/// The estimate with covariance and intervals that have such an error; `given_covariance` has it too.
[[nodiscard]] VehicleEstimate with_model_error(VehicleEstimate estimate, double factor, double significance);

}  // namespace veridyn::vehicle
