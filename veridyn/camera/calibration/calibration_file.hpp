#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "veridyn/camera/calibration/fit_camera.hpp"

namespace veridyn::camera {

/// A calibration as TOML: table [camera] with the map, its covariance (lower triangle by rows) and the noise of the
/// points; residuals are not in it. Reads back to the same doubles.
[[nodiscard]] std::string to_toml(const Calibration& calibration);

/// Reads such a file.
/// @throws InputError with file, line and key for what is missing, unknown, not finite, of the wrong count, or no map
/// or no covariance
[[nodiscard]] Calibration read_calibration(const std::filesystem::path& path);
/// The same from text.
[[nodiscard]] Calibration parse_calibration(std::string_view text, std::string name);

}  // namespace veridyn::camera
