// Where is a model car on its track, seen by a camera above it? Calibrate the camera, then follow the car's three
// bright markers from picture to picture, also under a bridge where nothing is seen.
//
// The pictures are rendered, so that the truth is known; frames of a video come from camera::VideoFrames.
#include <cmath>
#include <cstdio>
#include <exception>
#include <vector>

#include "picture.hpp"
#include "veridyn/camera.hpp"
#include "veridyn/numerics.hpp"

namespace {

// A figure of eight on a track of 4.4 m by 2.4 m: place [m] and heading [rad].
Eigen::Vector3d driven(double t) {
  const double s = 0.9 * t;
  return {2.2 + 1.6 * std::sin(s), 1.2 + 0.7 * std::sin(2.0 * s),
          std::atan2(1.4 * std::cos(2.0 * s), 1.6 * std::cos(s))};
}

}  // namespace

int main() try {
  using namespace veridyn;
  // The camera that nobody knows: about 215 px a metre, a little oblique, with a lens that bends straight lines.
  camera::TrackCamera::Parameters numbers;
  numbers << 310.0, 6.0, 477.5, 4.5, -312.5, 272.5, 0.03, -0.02, 485.0, 265.0, -0.05, 0.01;
  const camera::TrackCamera lens(numbers, {2.2, 1.2}, 1.45, 550.0);

  // Calibration: points of the track that somebody measured, found in the picture to a third of a pixel.
  numerics::RandomStream noise(1, "points");
  camera::CalibrationPoints points;
  for (double x = 0.2; x < 4.3; x += 0.4)
    for (double y = 0.2; y < 2.3; y += 0.4) {
      const Eigen::Vector2d error(0.3 * noise.normal(), 0.3 * noise.normal());
      points.points.push_back({{x, y}, lens.to_image({x, y}).value() + error, 0});
    }
  const camera::Calibration calibration = camera::fit_camera(points);
  std::printf("calibration: %zu points, %.2f px or %.1f mm off\n", calibration.points, calibration.rms_image,
              1e3 * calibration.rms_track);

  camera::OverheadScene scene{.camera = lens, .width = 960, .height = 540, .pose = driven};
  for (const Eigen::Vector2d& marker : camera::MarkerLayout{}.markers)
    scene.markers.push_back({.place = marker, .radius = 0.01});
  scene.hidden = {{3.0, 3.3}};
  camera::OverheadRenderer renderer(scene, 1);
  camera::CarTracker tracker(calibration, {});
  std::vector<double> time, x, y, true_x, true_y, error, low, high;
  std::size_t inside = 0, predicted = 0;
  double squares = 0.0;
  for (int k = 0; k < 210; ++k) {
    const double t = k / 30.0;
    const camera::GreyImage frame = renderer.render(t);
    const camera::TrackedPose car = tracker.add(t, frame.view());
    if (car.status == camera::TrackStatus::kLost) continue;
    const double off = 1e3 * (car.pose.x() - driven(t).x()), band = 1e3 * 1.96 * std::sqrt(car.covariance(0, 0));
    inside += std::abs(off) <= band ? 1 : 0;
    if (car.measured)
      squares += (car.pose - driven(t)).head<2>().squaredNorm();
    else
      ++predicted;
    time.push_back(t);
    x.push_back(car.pose.x());
    y.push_back(car.pose.y());
    true_x.push_back(driven(t).x());
    true_y.push_back(driven(t).y());
    error.push_back(off);
    low.push_back(-band);
    high.push_back(band);
  }
  picture::write("12_see_a_car.csv", {{"time[s]", time},
                                      {"x[m]", x},
                                      {"y[m]", y},
                                      {"true_x[m]", true_x},
                                      {"true_y[m]", true_y},
                                      {"error[mm]", error},
                                      {"low[mm]", low},
                                      {"high[mm]", high}});
  const double share = static_cast<double>(inside) / static_cast<double>(time.size());
  const double rms_mm = 1e3 * std::sqrt(squares / static_cast<double>(time.size() - predicted));
  std::printf(
      "%zu of 210 pictures: %.1f mm off where the car is seen; hidden in %zu; 95 %% band of x holds in %.0f %%\n",
      time.size(), rms_mm, predicted, 100.0 * share);
  return time.size() > 200 && rms_mm < 3.0 && predicted > 5 && share > 0.85 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
