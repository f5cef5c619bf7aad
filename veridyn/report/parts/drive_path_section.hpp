#pragma once

#include "veridyn/report/document/document.hpp"
#include "veridyn/vehicle/identification/signals/drive_path.hpp"

namespace veridyn::report {

/// Heading and path of a drive that was integrated open loop; no blocks where neither was recorded.
[[nodiscard]] Section drive_path_section(const vehicle::DrivePath& path);

}  // namespace veridyn::report
