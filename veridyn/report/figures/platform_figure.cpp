#include "veridyn/report/figures/platform_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace veridyn::report {
namespace {

using cueing::PlatformAxis;
using Place = Eigen::Vector3d;

/// Half the side of the plate of a platform whose heads span none [m].
constexpr double kHalfPlate = 0.4;
/// From the neutral centre of rotation to the floor of a platform without legs [m].
constexpr double kPedestal = 0.6;

/// A place that is given forward, right, down.
ScenePoint point(const Place& frd, bool moves) { return {frd.x(), -frd.y(), -frd.z(), moves}; }

std::vector<ScenePoint> points(const std::vector<Place>& places, bool moves) {
  std::vector<ScenePoint> all;
  for (const Place& p : places) all.push_back(point(p, moves));
  return all;
}

std::vector<Place> rectangle(double rear, double front, double half, double down) {
  return {{rear, -half, down}, {front, -half, down}, {front, half, down}, {rear, half, down}};
}

/// The polygon through some places, seen from above; a square where they are fewer than three.
std::vector<Place> outline(std::vector<Place> places, double down) {
  if (places.size() < 3) return rectangle(-kHalfPlate, kHalfPlate, kHalfPlate, down);
  Place middle = Place::Zero();
  for (const Place& p : places) middle += p / static_cast<double>(places.size());
  std::sort(places.begin(), places.end(), [&](const Place& a, const Place& b) {
    return std::atan2(a.y() - middle.y(), a.x() - middle.x()) < std::atan2(b.y() - middle.y(), b.x() - middle.x());
  });
  return places;
}

/// Somebody who sits and steers, by where the head is; the feet no lower than the plate.
void add_rider(Scene& scene, const Place& head, double plate_down) {
  using Kind = SceneShape::Kind;
  const auto at = [&](double forward, double right, double down) -> Place {
    return {head.x() + forward, head.y() + right, std::min(head.z() + down, std::max(plate_down, head.z()))};
  };
  const auto add = [&](Kind kind, SceneTone tone, const std::vector<Place>& places, double size) {
    scene.shapes.push_back({.kind = kind, .tone = tone, .points = points(places, true), .size = size});
  };
  add(Kind::kFace, SceneTone::kLink,
      {at(-0.12, -0.2, 0.66), at(0.3, -0.2, 0.6), at(0.3, 0.2, 0.6), at(-0.12, 0.2, 0.66)}, 0.0);
  add(Kind::kFace, SceneTone::kLink,
      {at(-0.12, -0.2, 0.66), at(-0.12, 0.2, 0.66), at(-0.24, 0.17, 0.1), at(-0.24, -0.17, 0.1)}, 0.0);
  add(Kind::kLine, SceneTone::kPerson, {at(-0.02, 0.0, 0.1), at(0.0, 0.0, 0.6)}, 9.0);
  for (const double side : {-1.0, 1.0}) {
    add(Kind::kLine, SceneTone::kPerson,
        {at(0.0, 0.09 * side, 0.6), at(0.4, 0.12 * side, 0.52), at(0.56, 0.12 * side, 0.78)}, 5.0);
    add(Kind::kLine, SceneTone::kPerson,
        {at(-0.02, 0.17 * side, 0.2), at(0.16, 0.24 * side, 0.42), at(0.38, 0.15 * side, 0.36)}, 4.0);
  }
  std::vector<Place> wheel;
  constexpr int kSpokes = 18;
  for (int k = 0; k <= kSpokes; ++k) {
    const double turn = kFullTurn * k / kSpokes;
    wheel.push_back(at(0.38 + 0.06 * std::cos(turn), 0.16 * std::sin(turn), 0.36 - 0.14 * std::cos(turn)));
  }
  add(Kind::kLine, SceneTone::kLink, wheel, 3.0);
  add(Kind::kBall, SceneTone::kPerson, {at(0.0, 0.0, 0.0)}, 0.12);
}

void add_actuators(Scene& scene, const cueing::Platform& platform, double floor) {
  using Kind = SceneShape::Kind;
  const auto add = [&](const Place& foot, const Place& head) {
    scene.shapes.push_back({.kind = Kind::kActuator,
                            .tone = SceneTone::kLink,
                            .points = {point(foot, false), point(head, true)},
                            .size = 0.55 * (head - foot).norm()});
  };
  if (!platform.legs) {
    add({0.0, 0.0, floor}, Place::Zero());
    return;
  }
  for (std::size_t k = 0; k < platform.legs->feet.size(); ++k) add(platform.legs->feet[k], platform.legs->heads[k]);
}

void add_shapes(Scene& scene, const cueing::Platform& platform) {
  using Kind = SceneShape::Kind;
  const bool legs = platform.legs.has_value();
  double floor = legs ? -kInfinity : kPedestal, plate_down = legs ? -kInfinity : 0.0, far = 0.0;
  if (legs) {
    for (const Place& foot : platform.legs->feet) floor = std::max(floor, foot.z());
    for (const Place& head : platform.legs->heads) plate_down = std::max(plate_down, head.z());
  }
  const std::vector<Place> base = outline(legs ? platform.legs->feet : std::vector<Place>{}, floor);
  const std::vector<Place> plate = outline(legs ? platform.legs->heads : std::vector<Place>{}, plate_down);
  for (const std::vector<Place>* each : {&base, &plate}) {
    for (const Place& p : *each) far = std::max(far, std::hypot(p.x(), p.y()));
  }
  const auto add = [&](Kind kind, SceneTone tone, std::vector<ScenePoint> at, double size) {
    scene.shapes.push_back({.kind = kind, .tone = tone, .points = std::move(at), .size = size});
  };
  const double radius = 1.15 * far;
  std::vector<Place> ground;
  constexpr int kCorners = 36;
  for (int k = 0; k < kCorners; ++k) {
    const double turn = kFullTurn * k / kCorners;
    ground.emplace_back(radius * std::cos(turn), radius * std::sin(turn), floor);
  }
  add(Kind::kFace, SceneTone::kGround, points(ground, false), 0.0);
  const double tip = 1.22 * radius, wing = 0.07 * radius;
  add(Kind::kLine, SceneTone::kGround,
      points({{0.85 * radius, 0.0, floor},
              {tip, 0.0, floor},
              {tip - 1.5 * wing, -wing, floor},
              {tip, 0.0, floor},
              {tip - 1.5 * wing, wing, floor}},
             false),
      2.5);
  scene.shapes.push_back({.kind = Kind::kLabel,
                          .tone = SceneTone::kGround,
                          .points = {point({1.42 * radius, 0.0, floor}, false)},
                          .text = "front"});
  std::vector<ScenePoint> rest = points(plate, false);
  rest.push_back(rest.front());
  add(Kind::kLine, SceneTone::kOutline, std::move(rest), 1.4);
  add_actuators(scene, platform, floor);
  add(Kind::kFace, SceneTone::kBody, points(plate, true), 0.0);
  add_rider(scene, platform.rider, plate_down);
}

/// The axes that move, in the order in which the platform's attitude is made: shifts, then yaw, pitch, roll.
std::vector<PlatformAxis> moving_axes(const cueing::Platform& platform) {
  std::vector<PlatformAxis> axes;
  for (const PlatformAxis axis : {PlatformAxis::kSurge, PlatformAxis::kSway, PlatformAxis::kHeave, PlatformAxis::kYaw,
                                  PlatformAxis::kPitch, PlatformAxis::kRoll}) {
    if (platform.limits[axis].moves()) axes.push_back(axis);
  }
  return axes;
}

/// Forward, left, up of a positive shift, or the direction about which a positive turn goes.
std::array<double, 3> direction_of(PlatformAxis axis) {
  switch (axis) {
    case PlatformAxis::kSurge:
    case PlatformAxis::kRoll:
      return {1.0, 0.0, 0.0};
    case PlatformAxis::kSway:
    case PlatformAxis::kPitch:
      return {0.0, -1.0, 0.0};
    case PlatformAxis::kHeave:
      return {0.0, 0.0, 1.0};
    case PlatformAxis::kYaw:
      break;
  }
  return {0.0, 0.0, -1.0};
}

/// The stamps, or an even grid over them where they are too many.
std::vector<double> thinned(const std::vector<double>& time, std::size_t most) {
  if (time.size() <= most || most < 2) return time;
  std::vector<double> grid(most);
  for (std::size_t k = 0; k < most; ++k)
    grid[k] = time.front() + (time.back() - time.front()) * static_cast<double>(k) / static_cast<double>(most - 1);
  return grid;
}

/// Values between stamps on straight lines. @param at increasing, within the stamps
std::vector<double> at_times(const std::vector<double>& time, const std::vector<double>& values,
                             const std::vector<double>& at) {
  std::vector<double> result;
  result.reserve(at.size());
  std::size_t k = 0;
  for (const double t : at) {
    while (k + 2 < time.size() && time[k + 1] < t) ++k;
    if (time.size() < 2) {
      result.push_back(values.front());
      continue;
    }
    const double share = std::clamp((t - time[k]) / (time[k + 1] - time[k]), 0.0, 1.0);
    result.push_back(values[k] + share * (values[k + 1] - values[k]));
  }
  return result;
}

}  // namespace

Scene platform_figure(const cueing::Platform& platform, const cueing::CueingResult& result, std::size_t most_samples) {
  Scene scene{.title = "The platform", .choice = "algorithm"};
  const std::vector<PlatformAxis> axes = moving_axes(platform);
  for (const PlatformAxis axis : axes) {
    const bool turns = cueing::turns(axis);
    scene.joints.push_back({.name = std::string(name_of(axis)),
                            .unit = turns ? "deg" : "mm",
                            .turns = turns,
                            .direction = direction_of(axis),
                            .scale = turns ? kDegree : 1e-3});
  }
  add_shapes(scene, platform);
  std::vector<double> time;
  for (const auto& sample : result.algorithms.front().run.vehicle) time.push_back(sample.time);
  const std::size_t numbers = std::max<std::size_t>(1, axes.size() * result.algorithms.size());
  scene.samples = thinned(time, std::max<std::size_t>(2, most_samples / numbers));
  for (const cueing::AlgorithmResult& a : result.algorithms) {
    SceneMotion motion{.name = a.run.algorithm};
    for (std::size_t j = 0; j < axes.size(); ++j) {
      std::vector<double> values;
      for (const cueing::CueingStep& s : a.run.steps)
        values.push_back(axis(s.reached, axes[j]).position / scene.joints[j].scale);
      motion.values.push_back(at_times(time, values, scene.samples));
    }
    scene.motions.push_back(std::move(motion));
  }
  scene.caption =
      "Where legs and actuators bring it; dashed where the plate is at rest. Drag, or use the arrow keys, to "
      "turn the view; point at the histories to go to a moment.";
  if (scene.samples.size() < time.size())
    scene.caption +=
        fmt::format(" A pose every {:.2g} s, {} in all; the histories are finer.",
                    (time.back() - time.front()) / static_cast<double>(scene.samples.size() - 1), scene.samples.size());
  return scene;
}

}  // namespace veridyn::report
