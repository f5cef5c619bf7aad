#include "veridyn/io/packets/packet_derivatives.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace veridyn::io {
namespace {

/// Slope of a vector over time about sample k, by least squares over the samples in the window.
template <typename Value>
Eigen::Vector3d slope(std::span<const PacketMotion> motions, std::size_t k, const DerivativeWindow& window,
                      const Value& value) {
  double n = 0.0, t1 = 0.0, t2 = 0.0;
  Eigen::Vector3d y0 = Eigen::Vector3d::Zero(), y1 = y0;
  const double at = motions[k].time;
  const auto take = [&](std::size_t i) {
    const double t = motions[i].time - at;
    const Eigen::Vector3d y = value(motions[i]);
    n += 1.0;
    t1 += t;
    t2 += t * t;
    y0 += y;
    y1 += t * y;
  };
  take(k);
  for (std::size_t i = k; i-- > 0 && motions[i].time >= at - window.before;) take(i);
  for (std::size_t i = k + 1; i < motions.size() && motions[i].time <= at + window.after; ++i) take(i);
  const double spread = t2 - t1 * t1 / n;
  if (!(spread > 0.0)) return Eigen::Vector3d::Zero();
  return (y1 - t1 / n * y0) / spread;
}

}  // namespace

DerivedMotion with_derivatives(std::span<const PacketMotion> motions, std::size_t k, const DerivativeWindow& window) {
  const PacketMotion& said = motions[k];
  DerivedMotion derived{.motion = said, .acceleration = {}};
  const Eigen::Matrix3d R = said.attitude.toRotationMatrix();
  if (!R.allFinite()) return derived;
  if (!said.acceleration.allFinite() && said.velocity.allFinite()) {
    const Eigen::Vector3d a =
        R.transpose() * slope(motions, k, window, [](const PacketMotion& m) { return m.velocity; });
    for (int i = 0; i < 3; ++i) {
      if (std::isfinite(said.acceleration(i))) continue;
      derived.motion.acceleration(i) = a(i);
      derived.acceleration.set(static_cast<std::size_t>(i));
    }
  }
  if (!said.rate.allFinite()) {
    // R' R^T is the cross product with the angular velocity.
    const auto turn_of = [&](int axis) {
      return slope(motions, k, window,
                   [axis](const PacketMotion& m) { return Eigen::Vector3d(m.attitude.toRotationMatrix().col(axis)); });
    };
    const Eigen::Vector3d forward = turn_of(0), left = turn_of(1);
    derived.motion.rate = {R.col(2).dot(left), -R.col(2).dot(forward), R.col(1).dot(forward)};
    derived.rate = true;
  }
  return derived;
}

Eigen::Vector3d angular_acceleration(std::span<const PacketMotion> motions, std::size_t k,
                                     const DerivativeWindow& window) {
  return slope(motions, k, window, [](const PacketMotion& m) { return m.rate; });
}

bool follows(const PacketMotion& before, const PacketMotion& after) {
  constexpr double kLongestPause = 1.0, kStray = 1.0;  // [s], [m]
  const double step = after.time - before.time;
  if (!(step > 0.0 && step <= kLongestPause)) return false;
  const Eigen::Vector3d moved = after.position - before.position;
  if (!moved.allFinite() || !after.velocity.allFinite()) return true;
  const double way = step * std::max(before.velocity.norm(), after.velocity.norm());
  return moved.norm() <= 1.5 * way + kStray;
}

}  // namespace veridyn::io
