#pragma once

#include <string>

#include "veridyn/aircraft/swing_test.hpp"
#include "veridyn/report/document.hpp"

namespace veridyn::report {

/// Inertia from swing tests: what the test determines, the moments with their error by source, every run with its fit.
[[nodiscard]] Document swing_test_report(const aircraft::SwingTest& test, const aircraft::SwingTestResult& result,
                                         const std::string& program);

}  // namespace veridyn::report
