#pragma once

#include <string>
#include <string_view>

#include "veridyn/io/log/log.hpp"
#include "veridyn/io/tables/npy.hpp"

namespace veridyn::io {

// Telemetry of games by Codemasters (DiRT Rally and others, `extradata="3"`): packets of 66 little-endian floats. What
// the floats mean is known from users of the game; signs and frame were checked on recordings: speed is the length of
// the velocity, right x forward points up, lateral g points left, gravity is in none of them.

/// Whether the columns (rows of an array: 66 rows, a sample each column) are such telemetry: speed and velocity agree,
/// and the car's axes are unit vectors at right angles.
[[nodiscard]] bool is_codemasters(const NpyArray& array);
/// Whether bytes are such packets one after the other.
[[nodiscard]] bool is_codemasters(std::string_view bytes);

/// The drive in frame flu, without gravity: `accel_x`, `accel_y` from the game's own g; `accel_z` and the angular rates
/// `gyro_x|y|z` derived from velocity and attitude over 0.1 s, since the packets' stamps jitter by as much as they
/// are apart; `roll`, `pitch`, `yaw`; `speed`, `pos_x|y|z`, `throttle`, `brake`, `steering`, wheel speeds [m/s] and
/// suspension as the game has them. Packets that repeat a stamp, or go back, are left out and counted.
/// @throws InputError with fewer than ten samples.
[[nodiscard]] Log codemasters_log(const NpyArray& array, const std::string& source);
/// The same of packets one after the other. @throws as above
[[nodiscard]] Log codemasters_log(std::string_view bytes, const std::string& source);

}  // namespace veridyn::io
