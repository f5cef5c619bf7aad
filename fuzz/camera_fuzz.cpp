#include <cmath>
#include <string_view>

#include "veridyn/camera/calibration/calibration_points.hpp"
#include "veridyn/camera/tracking/pose_tables.hpp"
#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"

// One byte says which file: points of a calibration, or poses. Not the calibration itself: toml++, which reads it as it
// does every study, runs into its own TOML_UNREACHABLE on some blanks of Unicode.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace veridyn::camera;
  if (size < 1) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if (data[0] % 2 == 0) {
      const CalibrationPoints points = parse_calibration_points(text, "fuzz");
      VERIDYN_ASSERT(points.points.size() >= 4);
      for (const CalibrationPoint& p : points.points) VERIDYN_ASSERT(p.track.allFinite() && p.image.allFinite());
    } else {
      for (const TimedPose& p : parse_poses(text, "fuzz")) VERIDYN_ASSERT(std::isfinite(p.time));
    }
  } catch (const veridyn::InputError&) {
  }
  return 0;
}
