#include "veridyn/camera/rendering/overhead_scene.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::camera {
namespace {

constexpr std::size_t kNoiseTable = std::size_t{1} << 20;
constexpr int kExposureSteps = 12;

bool during(const std::vector<TimeSpan>& spans, double t) {
  return std::any_of(spans.begin(), spans.end(), [&](const TimeSpan& s) { return s.contains(t); });
}

Eigen::Vector2d on_track(const Eigen::Vector3d& pose, const Eigen::Vector2d& place) {
  const double c = std::cos(pose(2)), s = std::sin(pose(2));
  return {pose(0) + c * place(0) - s * place(1), pose(1) + s * place(0) + c * place(1)};
}

/// SplitMix64, for the place in the table of noise.
std::uint64_t next(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9E3779B97F4A7C15ULL);
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

}  // namespace

OverheadRenderer::OverheadRenderer(OverheadScene scene, std::uint64_t seed) : scene_(std::move(scene)), state_(seed) {
  if (scene_.width < 16 || scene_.height < 16 || scene_.width > 8192 || scene_.height > 8192)
    throw InputError("scene", "width and height must be 16 to 8192 px");
  if (!scene_.pose) throw InputError("scene", "the car has no pose");
  if (!(scene_.exposure_s >= 0.0 && scene_.noise >= 0.0 && scene_.spread_px > 0.0))
    throw InputError("scene", "exposure and noise must be >= 0, the spread > 0");
  numerics::RandomStream random(seed, "rendering/noise");
  noise_.resize(kNoiseTable);
  for (float& n : noise_) n = static_cast<float>(random.normal());
  const std::size_t pixels = at(scene_.width) * at(scene_.height);
  still_.resize(pixels);
  light_.resize(pixels);
  constexpr double kEvery = 0.5, kHalfWidth = 0.01;
  for (int y = 0; y < scene_.height; ++y) {
    for (int x = 0; x < scene_.width; ++x) {
      double grey = scene_.background;
      if (const auto p = scene_.camera.to_track({x, y})) {
        const double dx = std::abs(std::remainder((*p)(0), kEvery)), dy = std::abs(std::remainder((*p)(1), kEvery));
        if (std::min(dx, dy) < kHalfWidth) grey += scene_.line;
      }
      still_[y * scene_.width + x] = static_cast<float>(grey);
    }
  }
}

void OverheadRenderer::add_spot(const std::vector<Eigen::Vector2d>& path, double radius_px, double brightness) {
  // A disc of even light with the soft rim of the lens: the share of a Gaussian within the radius along the ray.
  const double reach = radius_px + 4.0 * scene_.spread_px;
  for (const Eigen::Vector2d& centre : path) {
    if (!centre.allFinite()) continue;
    const int x0 = std::max(0, static_cast<int>(std::floor(centre(0) - reach)));
    const int x1 = std::min(scene_.width - 1, static_cast<int>(std::ceil(centre(0) + reach)));
    const int y0 = std::max(0, static_cast<int>(std::floor(centre(1) - reach)));
    const int y1 = std::min(scene_.height - 1, static_cast<int>(std::ceil(centre(1) + reach)));
    constexpr int kSub = 3;
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        double sum = 0.0;
        for (int i = 0; i < kSub; ++i) {
          for (int k = 0; k < kSub; ++k) {
            const double r = std::hypot(x + (i - 1.0) / kSub - centre(0), y + (k - 1.0) / kSub - centre(1));
            sum += 0.5 * std::erfc((r - radius_px) / (std::sqrt(2.0) * scene_.spread_px));
          }
        }
        light_[y * scene_.width + x] +=
            static_cast<float>(brightness * sum / (kSub * kSub * static_cast<double>(path.size())));
      }
    }
  }
}

GreyImage OverheadRenderer::render(double time) {
  const double room = scene_.room_light ? scene_.room_light(time) : 1.0;
  for (std::size_t i = 0; i < light_.size(); ++i) light_[i] = still_[i] * static_cast<float>(room);
  const auto scale_at = [&](const Eigen::Vector2d& place) {
    return std::sqrt(std::abs(scene_.camera.J_image_track(place).determinant()));
  };
  const auto seen_at = [&](const Eigen::Vector2d& place) {
    const auto image = scene_.camera.to_image(place);
    return image ? *image : Eigen::Vector2d(Eigen::Vector2d::Constant(std::nan("")));
  };
  for (const SceneLight& light : scene_.lights) {
    const double share = light.flicker ? light.flicker(time) : 1.0;
    if (share > 0.0) add_spot({seen_at(light.place)}, light.radius * scale_at(light.place), share * light.brightness);
  }
  if (!during(scene_.hidden, time)) {
    const Eigen::Vector3d middle = scene_.pose(time);
    // The body where it is in the middle of the exposure.
    const double reach = 0.2 * scale_at(middle.head<2>());
    const Eigen::Vector2d c = seen_at(middle.head<2>());
    if (c.allFinite()) {
      const int left = std::max(0, static_cast<int>(c(0) - reach)), top = std::max(0, static_cast<int>(c(1) - reach));
      for (int y = top; y <= std::min(scene_.height - 1, static_cast<int>(c(1) + reach)); ++y) {
        for (int x = left; x <= std::min(scene_.width - 1, static_cast<int>(c(0) + reach)); ++x) {
          // The share of the pixel that the body covers, from nine points in it.
          int covered = 0;
          for (int sub = 0; sub < 9; ++sub) {
            const int column = sub % 3 - 1, line = sub / 3 - 1;
            const auto p = scene_.camera.to_track({x + column / 3.0, y + line / 3.0});
            if (!p) continue;
            const Eigen::Vector2d d = *p - middle.head<2>();
            const double forward = std::cos(middle(2)) * d(0) + std::sin(middle(2)) * d(1);
            const double side = -std::sin(middle(2)) * d(0) + std::cos(middle(2)) * d(1);
            covered += std::abs(forward) < 0.15 && std::abs(side) < 0.075 ? 1 : 0;
          }
          light_[y * scene_.width + x] += static_cast<float>(scene_.car * room * covered / 9.0);
        }
      }
    }
    for (const SceneMarker& marker : scene_.markers) {
      if (during(marker.hidden, time)) continue;
      std::vector<Eigen::Vector2d> path;
      for (int i = 0; i < kExposureSteps; ++i) {
        const double t = time + scene_.exposure_s * ((i + 0.5) / kExposureSteps - 0.5);
        path.push_back(seen_at(on_track(scene_.pose(t), marker.place)));
      }
      add_spot(path, marker.radius * scale_at(middle.head<2>()), marker.brightness);
    }
  }
  GreyImage image{.width = scene_.width, .height = scene_.height, .pixels = {}};
  image.pixels.resize(light_.size());
  const double dark = scene_.noise * scene_.noise;
  std::size_t i = 0;
  for (int y = 0; y < scene_.height; ++y) {
    const std::size_t from = next(state_) % (kNoiseTable - at(scene_.width));
    for (int x = 0; x < scene_.width; ++x, ++i) {
      const float grey = light_[i];
      const auto sigma = static_cast<float>(std::sqrt(dark + scene_.photons * grey));
      image.pixels[i] = static_cast<std::uint8_t>(std::clamp(grey + sigma * noise_[from + x] + 0.5F, 0.0F, 255.0F));
    }
  }
  return image;
}

}  // namespace veridyn::camera
