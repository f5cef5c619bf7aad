#include "veridyn/camera/rendering/virtual_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::camera {
namespace {

/// Of the picture that the track fills; the rest is its surroundings.
constexpr double kFilled = 0.9;
/// Of a marker, so that it is more than the noise of single pixels [px].
constexpr double kLeastRadius_px = 1.0;
/// Between two markers: closer ones are taken for one spot in some pictures, at 9 px in a third of them [px].
constexpr double kLeastApart_px = 12.0;
/// How long before the newest place pictures may be exposed [s].
constexpr double kKept_s = 2.0;
/// Of a point that somebody reads from a picture [px].
constexpr double kPointNoise_px = 0.1;

double px_per_m(const VirtualCameraOptions& o) {
  return kFilled * std::min(o.width / (o.x[1] - o.x[0]), o.height / (o.y[1] - o.y[0]));
}

/// 1 % nearer at one corner than at the other, 2 % of barrel distortion at the edge.
TrackCamera lens(const VirtualCameraOptions& o) {
  const Eigen::Vector2d centre(0.5 * (o.x[0] + o.x[1]), 0.5 * (o.y[0] + o.y[1]));
  const double scale = 0.5 * std::max(o.x[1] - o.x[0], o.y[1] - o.y[0]), zoom = px_per_m(o) * scale;
  const Eigen::Vector2d middle(0.5 * (o.width - 1), 0.5 * (o.height - 1));
  TrackCamera::Parameters p;
  p << zoom, 0.01 * zoom, middle(0), 0.01 * zoom, -zoom, middle(1), 0.005, -0.005, middle(0) + 3.0, middle(1) - 2.0,
      -0.02, 0.0;
  return {p, centre, scale, middle(0)};
}

Calibration calibrated(const TrackCamera& camera, const VirtualCameraOptions& o, std::uint64_t seed) {
  numerics::RandomStream random(seed, "points of calibration");
  CalibrationPoints points{.source = "virtual camera", .points = {}};
  constexpr int kAcross = 14, kUp = 9;
  for (int i = 0; i <= kAcross; ++i) {
    for (int j = 0; j <= kUp; ++j) {
      const Eigen::Vector2d track(o.x[0] + (o.x[1] - o.x[0]) * i / kAcross, o.y[0] + (o.y[1] - o.y[0]) * j / kUp);
      const std::optional<Eigen::Vector2d> image = camera.to_image(track);
      VERIDYN_ASSERT(image.has_value());
      points.points.push_back({track, *image + kPointNoise_px * Eigen::Vector2d(random.normal(), random.normal()), 0});
    }
  }
  return fit_camera(points);
}

/// The smaller number first.
void check_extent(const StudyTable& table, const char* key, const std::array<double, 2>& extent) {
  if (!(extent[1] > extent[0])) table.fail(key, "must be two numbers, the smaller first, as [\"-5 m\", \"5 m\"]");
}

}  // namespace

const KeyTable<VirtualCameraOptions>& VirtualCameraOptions::keys() {
  using O = VirtualCameraOptions;
  static const auto table =
      KeyTable<O>("live.camera.view", "A camera above the virtual car.")
          .numbers("x", &O::x, "m", kAnyNumber, "of the track, all of which it sees: least, greatest")
          .numbers("y", &O::y, "m", kAnyNumber, "the same across")
          .count("width", &O::width, 64, 8192, "of its pictures [px]")
          .count("height", &O::height, 64, 8192, "of its pictures [px]")
          .number("rate", &O::rate_Hz, "Hz", from_to(1.0, 200.0), "of its pictures")
          .number("exposure", &O::exposure_s, "s", kNotNegative, "of a picture, at most the time between two")
          .check([](const StudyTable& t, O& o) {
            check_extent(t, "x", o.x);
            check_extent(t, "y", o.y);
            if (!(o.exposure_s <= 1.0 / o.rate_Hz))
              t.fail("exposure", fmt::format("= {:g} s must be 0 to the time between two pictures, {:.3g} s",
                                             o.exposure_s, 1.0 / o.rate_Hz));
          });
  return table;
}

VirtualCamera::VirtualCamera(const VirtualCameraOptions& options, const MarkerLayout& markers, std::uint64_t seed)
    : options_(options) {
  const TrackCamera camera = lens(options_);
  calibration_ = calibrated(camera, options_, seed);
  OverheadScene scene{
      .camera = camera, .width = options_.width, .height = options_.height, .pose = [this](double time) {
        return pose_at(time);
      }};
  scene.exposure_s = options_.exposure_s;
  double apart = kInfinity;
  for (std::size_t i = 0; i < markers.markers.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) apart = std::min(apart, (markers.markers[i] - markers.markers[j]).norm());
  if (apart * px_per_m(options_) < kLeastApart_px)
    throw InputError(
        "live.camera.view",
        fmt::format(
            "on a picture of {} x {} px of {:g} x {:g} m the car's markers are {:.1f} px apart; must be at least "
            "{:g}: more pixels or a smaller track",
            options_.width, options_.height, options_.x[1] - options_.x[0], options_.y[1] - options_.y[0],
            apart * px_per_m(options_), kLeastApart_px));
  // Balls of light as large as they have to be to be seen from so far.
  const double radius = std::max(0.008, kLeastRadius_px / px_per_m(options_));
  for (const Eigen::Vector2d& place : markers.markers) scene.markers.push_back({.place = place, .radius = radius});
  const auto at = [&](double share_x, double share_y) {
    return Eigen::Vector2d(options_.x[0] + share_x * (options_.x[1] - options_.x[0]),
                           options_.y[0] + share_y * (options_.y[1] - options_.y[0]));
  };
  scene.lights = {{.place = at(0.02, 0.03), .radius = radius, .brightness = 220.0, .flicker = {}},
                  {.place = at(0.97, 0.95), .radius = 2.0 * radius, .brightness = 230.0, .flicker = [](double t) {
                     return std::fmod(7.3 * t, 1.0) < 0.5 ? 1.0 : 0.1;
                   }}};
  renderer_ = std::make_unique<OverheadRenderer>(std::move(scene), seed);
}

void VirtualCamera::place(double time, const Eigen::Vector3d& pose) {
  if (!places_.empty() && !(time > places_.back().time)) return;
  places_.push_back({time, pose});
  while (places_.front().time < time - kKept_s) places_.pop_front();
}

bool VirtualCamera::knows(double time) const {
  const double half = 0.5 * options_.exposure_s;
  return !places_.empty() && places_.front().time <= time - half && places_.back().time >= time + half;
}

Eigen::Vector3d VirtualCamera::pose_at(double time) const {
  const auto after = std::ranges::lower_bound(places_, time, {}, &Placed::time);
  if (after == places_.begin()) return after->pose;
  if (after == places_.end()) return places_.back().pose;
  const Placed& before = *std::prev(after);
  const double share = (time - before.time) / (after->time - before.time);
  Eigen::Vector3d pose = before.pose + share * (after->pose - before.pose);
  pose(2) = before.pose(2) + share * std::remainder(after->pose(2) - before.pose(2), 2.0 * kPi);
  return pose;
}

GreyImage VirtualCamera::picture(double time) { return renderer_->render(time); }

}  // namespace veridyn::camera
