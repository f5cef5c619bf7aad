#pragma once

#include <string>

#include "veridyn/aircraft/sensors/air_data_calibration.hpp"
#include "veridyn/aircraft/sensors/swing_test.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// Inertia from swing tests: what the test determines, the moments with their error by source, every run with its fit.
[[nodiscard]] Document swing_test_report(const aircraft::SwingTest& test, const aircraft::SwingTestResult& result,
                                         const std::string& program);

/// Calibration of air-data sensors: scales and biases, what the residuals say, fit and residuals of each sensor.
[[nodiscard]] Document calibration_report(const aircraft::CalibrationStudy& study,
                                          const aircraft::CalibrationResult& result, const std::string& program);

}  // namespace veridyn::report
