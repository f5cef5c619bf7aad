#include "veridyn/vehicle/road/circuit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

/// From 0 to 1 with continuous curvature, its slope and what lies under it.
double blend(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10.0 + t * (6.0 * t - 15.0));
}
double blend_slope(double t) { return t > 0.0 && t < 1.0 ? 30.0 * t * t * (1.0 - t) * (1.0 - t) : 0.0; }
double under_blend(double t) {
  if (t <= 0.0) return 0.0;
  if (t >= 1.0) return t - 0.5;
  return t * t * t * t * (2.5 + t * (t - 3.0));
}

/// Height and slope a distance after the beginning of a climb, which ends at the ramp's height.
std::pair<double, double> climbed(const CircuitOptions::Ramp& r, double x) {
  const double steep = std::tan(r.angle), after = (x - r.blend - r.even()) / r.blend;
  return {steep * r.blend * (under_blend(x / r.blend) - under_blend(after)),
          steep * (blend(x / r.blend) - blend(after))};
}

void check(bool holds, const char* name, double value, const char* rule) {
  if (!holds) throw InputError(name, fmt::format("is {:g}; {}", value, rule));
}

}  // namespace

double CircuitOptions::Ramp::even() const { return height / std::tan(angle) - blend; }
double CircuitOptions::Ramp::length() const { return 2.0 * (even() + 2.0 * blend) + top; }

void CircuitOptions::validate() const {
  check(straight > 0.0 && straight < 1e5, "straight", straight, "must be > 0");
  check(width > 0.0, "width", width, "must be > 0");
  check(radius > 1.5 * width && radius < 1e5, "radius", radius, "must be more than 1.5 widths");
  check(banks.size() == 4, "banks", static_cast<double>(banks.size()), "numbers are given; there are four quarters");
  for (const double bank : banks)
    check(bank >= 0.0 && bank <= 45.0 * kDegree, "banks", bank, "must be from 0 to 45 deg");
  const double second = straight + kPi * radius;
  const auto on_straight = [&](double at, double length, const char* name) {
    check(
        length > 0.0 && ((at >= 0.0 && at + length <= straight) || (at >= second && at + length <= second + straight)),
        name, at, "what begins there does not end on the same straight");
  };
  for (const Ramp& r : ramps) {
    check(r.angle > 0.0 && r.angle <= 45.0 * kDegree, "ramp.angle", r.angle, "must be above 0, at most 45 deg");
    check(r.blend > 0.0 && r.even() >= 0.0, "ramp.height", r.height, "must be more than blend times the slope");
    check(r.top >= 0.0, "ramp.top", r.top, "must be >= 0");
    on_straight(r.at, r.length(), "ramp.at");
  }
  for (const Bump& b : bumps) {
    check(std::abs(b.height) <= 1.0, "bump.height", b.height, "must be at most 1 m");
    on_straight(b.at, b.length, "bump.at");
  }
  for (const Rough& r : rough) {
    check(r.roughness > 0.0, "rough.roughness", r.roughness, "must be > 0");
    check(r.length > 0.0, "rough.length", r.length, "must be > 0");
    check(r.at >= 0.0 && r.at + r.length <= 2.0 * second, "rough.at", r.at, "what begins there ends beyond the lap");
  }
}

Circuit::Circuit(const CircuitOptions& options)
    : options_(options), curve_(kPi * options.radius), lap_(2.0 * (options.straight + curve_)) {
  options_.validate();
  for (std::size_t i = 0; i < options_.rough.size(); ++i) {
    rough_.emplace_back(Iso8608Options{.roughness = options_.rough[i].roughness,
                                       .length = std::max(100.0, lap_),
                                       .fade_in = 0.0,
                                       .coherence_length = 0.8,
                                       .seed = options_.seed + i});
  }
}

Circuit::Located Circuit::locate(const Eigen::Vector2d& place) const {
  const double l = options_.straight, r = options_.radius;
  const double x = place.x(), y = place.y() - r;  // from the line through the curves' middles
  if (x >= 0.0 && x <= l) {
    if (y < 0.0) return {.distance = x, .offset = y + r, .along = {1.0, 0.0}};
    return {.distance = l + curve_ + (l - x), .offset = r - y, .along = {-1.0, 0.0}};
  }
  const bool second = x < 0.0;
  const double out = second ? -x : x - l, left = second ? -y : y;
  const double rho = std::max(std::hypot(out, left), 1e-9 * r);
  const double begin = second ? 2.0 * l + curve_ : l;
  Eigen::Vector2d along(-left / rho, out / rho);
  if (second) along = -along;
  return {.distance = begin + r * (std::atan2(left, out) + 0.5 * kPi),
          .offset = r - rho,
          .stretch = rho / r,
          .along = along,
          .straight = false};
}

Eigen::Vector2d Circuit::middle(double distance) const {
  double s = std::fmod(distance, lap_);
  if (s < 0.0) s += lap_;
  const double l = options_.straight, r = options_.radius;
  if (s <= l) return {s, 0.0};
  s -= l;
  if (s <= curve_) return {l + r * std::sin(s / r), r - r * std::cos(s / r)};
  s -= curve_;
  if (s <= l) return {l - s, 2.0 * r};
  s -= l;
  return {-r * std::sin(s / r), r + r * std::cos(s / r)};
}

Circuit::Profile Circuit::climb(double distance) const {
  Profile sum;
  for (const CircuitOptions::Ramp& r : options_.ramps) {
    const double x = distance - r.at, length = r.length();
    if (x <= 0.0 || x >= length) continue;
    const bool down = x > 0.5 * length;
    const auto [height, slope] = climbed(r, down ? length - x : x);
    sum.value += height;
    sum.slope += down ? -slope : slope;
  }
  return sum;
}

Circuit::Profile Circuit::bank(double distance) const {
  const double l = options_.straight, quarter = 0.5 * curve_, over = 0.35 * quarter;
  const bool second = distance > l + curve_;
  const double x = distance - (second ? 2.0 * l + curve_ : l);
  if (x < 0.0 || x > curve_) return {};
  const double first = std::tan(options_.banks[second ? 2 : 0]), last = std::tan(options_.banks[second ? 3 : 1]);
  const std::array<std::array<double, 2>, 3> changes{
      {{0.0, first}, {quarter - 0.5 * over, last - first}, {curve_ - over, -last}}};
  Profile sum;
  for (const auto& [begin, by] : changes) {
    sum.value += by * blend((x - begin) / over);
    sum.slope += by * blend_slope((x - begin) / over) / over;
  }
  return sum;
}

Circuit::Profile Circuit::across(double offset) const {
  const double beyond = (std::abs(offset) - 0.5 * options_.width) / options_.width;
  return {1.0 - blend(beyond), -std::copysign(blend_slope(beyond), offset) / options_.width};
}

RoadSurface::Point Circuit::at(const Eigen::Vector2d& place) const {
  const Located on = locate(place);
  const Profile share = across(on.offset);
  const Profile along = on.straight ? climb(on.distance) : bank(on.distance);
  // Height = along(distance) arm(offset) share(offset): the arm is 1 on straights, -offset in curves.
  const double arm = on.straight ? 1.0 : -on.offset, arm_slope = on.straight ? 0.0 : -1.0;
  const double forward = along.slope * arm * share.value / on.stretch;
  const double leftward = along.value * (arm_slope * share.value + arm * share.slope);
  return {along.value * arm * share.value,
          forward * on.along + leftward * Eigen::Vector2d(-on.along.y(), on.along.x())};
}

double Circuit::relief(const Eigen::Vector2d& place) const {
  const Located on = locate(place);
  double height = 0.0;
  for (const CircuitOptions::Bump& b : options_.bumps) {
    const double t = (on.distance - b.at) / b.length;
    if (t > 0.0 && t < 1.0) height += 0.5 * b.height * (1.0 - std::cos(2.0 * kPi * t));
  }
  for (std::size_t i = 0; i < rough_.size(); ++i) {
    const CircuitOptions::Rough& r = options_.rough[i];
    const double x = on.distance - r.at, fade = 0.1 * r.length;
    if (x <= 0.0 || x >= r.length) continue;
    // The tracks lie left and right of the middle; from one to the other within the width of a tyre.
    const double left = blend(0.5 + on.offset / (0.1 * options_.width));
    const double both = left * rough_[i].height({.x = 0, .y = 0, .distance = x, .offset = 1.0}) +
                        (1.0 - left) * rough_[i].height({.x = 0, .y = 0, .distance = x, .offset = -1.0});
    height += both * blend(x / fade) * blend((r.length - x) / fade);
  }
  return height * across(on.offset).value;
}

std::shared_ptr<const Circuit> read_circuit(const StudyTable& table, std::uint64_t seed) {
  CircuitOptions o;
  o.seed = seed;
  o.straight = table.positive_or("straight", "m", o.straight);
  o.radius = table.positive_or("radius", "m", o.radius);
  o.width = table.positive_or("width", "m", o.width);
  if (table.has("banks")) o.banks = table.numbers("banks", "rad");
  const bool flat = table.flag_or("flat", false);
  if (flat || !table.tables("ramp").empty()) o.ramps.clear();
  if (flat || !table.tables("bump").empty()) o.bumps.clear();
  if (flat || !table.tables("rough").empty()) o.rough.clear();
  for (const StudyTable& t : table.tables("ramp")) {
    CircuitOptions::Ramp ramp{.at = t.number("at", "m"), .angle = t.positive("angle", "rad")};
    ramp.height = t.positive("height", "m");
    ramp.top = t.number_or("top", "m", ramp.top);
    ramp.blend = t.positive_or("blend", "m", ramp.blend);
    o.ramps.push_back(ramp);
  }
  for (const StudyTable& t : table.tables("bump"))
    o.bumps.push_back(
        {.at = t.number("at", "m"), .height = t.number("height", "m"), .length = t.positive("length", "m")});
  for (const StudyTable& t : table.tables("rough")) {
    if (t.has("class") && t.has("roughness")) t.fail("roughness", "is given as well as `class`: give one of them");
    const std::array<std::string, 8> classes{"A", "B", "C", "D", "E", "F", "G", "H"};
    const double roughness = t.has("roughness") ? t.positive("roughness", "m^3")
                                                : iso8608_roughness(t.choice_or("class", classes, "A").front());
    o.rough.push_back({.at = t.number("at", "m"), .length = t.positive("length", "m"), .roughness = roughness});
  }
  try {
    return std::make_shared<Circuit>(o);
  } catch (const InputError& error) {
    throw InputError(table.path(), error.what());
  }
}

}  // namespace veridyn::vehicle
