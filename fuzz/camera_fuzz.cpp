#include <cmath>
#include <string_view>

#include "veridyn/camera/calibration/calibration_file.hpp"
#include "veridyn/camera/calibration/calibration_points.hpp"
#include "veridyn/camera/tracking/pose_tables.hpp"
#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"

// One byte says which file: points of a calibration, a calibration, poses. A map that was read must go there and back.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace veridyn::camera;
  if (size < 1) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    switch (data[0] % 3) {
      case 0: {
        const CalibrationPoints points = parse_calibration_points(text, "fuzz");
        VERIDYN_ASSERT(points.points.size() >= 4);
        for (const CalibrationPoint& p : points.points) VERIDYN_ASSERT(p.track.allFinite() && p.image.allFinite());
        break;
      }
      case 1: {
        const Calibration calibration = parse_calibration(text, "fuzz");
        (void)calibration.camera.to_track({100.0, 50.0});
        (void)calibration.camera.to_image({1.0, 0.5});
        (void)parse_calibration(to_toml(calibration), "again");
        break;
      }
      default:
        for (const TimedPose& p : parse_poses(text, "fuzz")) VERIDYN_ASSERT(std::isfinite(p.time));
    }
  } catch (const veridyn::InputError&) {
  }
  return 0;
}
