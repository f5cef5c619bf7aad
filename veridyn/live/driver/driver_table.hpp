#pragma once

#include <filesystem>
#include <vector>

#include "veridyn/live/driver/wheel_calibration.hpp"

namespace veridyn::live {

/// A driver who follows a table, as the events of a wheel with `table_calibration`, 100 times a second: columns
/// `time[s]` and `steering[rad]` (or `[deg]`; of the steering wheel, left positive), `throttle` and `brake` from 0 to
/// 1, `reverse` 0 or 1 where there is such a column; on lines between the rows. Rows begin when the driving does.
/// @throws InputError with file and line: a column that is missing, rows whose time does not grow, a value out of range
[[nodiscard]] std::vector<WheelEvent> read_driver_table(const std::filesystem::path& path);

/// Wheel and pedals of these events: steering in steps of 1e-5 rad on ABS_X, up to 20 rad to either side, throttle and
/// brake in steps of 1e-5 on ABS_GAS and ABS_BRAKE, gear on ABS_MISC; no deadbands.
[[nodiscard]] WheelCalibration table_calibration();

}  // namespace veridyn::live
