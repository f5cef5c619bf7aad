#include "veridyn/cueing/platform/legs.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::cueing {
namespace {

using Vector = Eigen::Vector3d;

/// Components along north, east, down of the platform's neutral axes from its own.
Eigen::Matrix3d turned(const PlatformCommand& pose) {
  return numerics::R_body_from_ned(pose.angle(0), pose.angle(1), pose.angle(2)).transpose();
}

Vector between(const LegGeometry& g, const PlatformCommand& pose, const Eigen::Matrix3d& R, std::size_t leg) {
  return shift_from_frd(pose.shift) + R * g.heads[leg] - g.feet[leg];
}

/// Points of a hexagon of unequal sides: three pairs, `half` [rad] to either side of `first`, `first` + 120 deg, ...
std::vector<Vector> pairs(double radius, double first, double half, double down) {
  std::vector<Vector> points;
  for (int k = 0; k < 3; ++k) {
    for (const double side : {-half, half}) {
      const double at = first + k * 120.0 * kDegree + side;
      points.emplace_back(radius * std::cos(at), radius * std::sin(at), down);
    }
  }
  return points;
}

}  // namespace

LegGeometry three_legs() {
  LegGeometry g;
  g.heads = {{0.45, 0.0, 0.0}, {-0.35, -0.35, 0.0}, {-0.35, 0.35, 0.0}};
  for (const Vector& head : g.heads) g.feet.emplace_back(head.x(), head.y(), 0.6);
  g.leg = {.lowest = -0.3, .highest = 0.3, .rate = 0.8, .acceleration = 8.0, .jerk = 200.0};
  return g;
}

LegGeometry six_legs() {
  LegGeometry g;
  // The heads' pairs point between the feet's, and each leg goes to the neighbouring one.
  g.feet = pairs(1.6, 60.0 * kDegree, 6.0 * kDegree, 1.7);
  const std::vector<Vector> heads = pairs(1.2, 0.0, 6.0 * kDegree, 0.0);
  for (const std::size_t i : {1U, 2U, 3U, 4U, 5U, 0U}) g.heads.push_back(heads[i]);
  g.leg = {.lowest = -0.6, .highest = 0.6, .rate = 1.0, .acceleration = 10.0, .jerk = 250.0};
  return g;
}

Legs::Legs(const LegGeometry& geometry, const PlatformLimits& limits) : geometry_(geometry) {
  PlatformLimits one;
  one[PlatformAxis::kHeave] = geometry.leg;
  one.validate();
  axes_ = limits.moving_axes();
  if (geometry.feet.size() != axes_.size() || geometry.heads.size() != axes_.size())
    throw InputError("platform.legs", fmt::format("has {} feet and {} heads; a platform of {} axes takes as many",
                                                  geometry.feet.size(), geometry.heads.size(), axes_.size()));
  const Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    neutral_.push_back(between(geometry_, {}, R, i).norm());
    if (!(neutral_.back() > 1e-3))
      throw InputError("platform.legs", fmt::format("leg {} has its foot at its head", i + 1));
  }
  Eigen::FullPivLU<Square> lu;
  lu.setThreshold(1e-4);
  if (!lu.compute(jacobian({})).isInvertible())
    throw InputError("platform.legs",
                     "do not hold the platform in its neutral position: it can move with every leg at "
                     "rest");
  check_range(limits);
}

void Legs::check_range(const PlatformLimits& limits) const {
  for (const PlatformAxis axis : axes_) {
    for (const double end : {limits[axis].lowest, limits[axis].highest}) {
      PlatformState at;
      set_axis(at, axis, {.position = end});
      const Values lengths = positions(at);
      for (Eigen::Index i = 0; i < count(); ++i) {
        if (lengths(i) < geometry_.leg.lowest || lengths(i) > geometry_.leg.highest)
          throw InputError(fmt::format("platform.{}", name_of(axis)),
                           fmt::format("at {:.3g} {} leg {} is {:+.3f} m from its neutral length; it reaches {:+.3f} "
                                       "to {:+.3f} m",
                                       turns(axis) ? end / kDegree : end, turns(axis) ? "deg" : "m", i + 1, lengths(i),
                                       geometry_.leg.lowest, geometry_.leg.highest));
      }
    }
  }
}

Legs::Values Legs::positions(const PlatformCommand& pose) const {
  const Eigen::Matrix3d R = turned(pose);
  Values l(count());
  for (Eigen::Index i = 0; i < count(); ++i) {
    l(i) = between(geometry_, pose, R, i).norm() - neutral_[i];
  }
  return l;
}

Legs::Square Legs::jacobian(const PlatformCommand& pose) const {
  const Eigen::Matrix3d R = turned(pose);
  Square J(count(), count());
  for (Eigen::Index i = 0; i < count(); ++i) {
    const Vector along = between(geometry_, pose, R, i).normalized();
    // along . (omega x head), in the platform's own axes.
    const Vector turning = geometry_.heads[i].cross(R.transpose() * along);
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      const auto axis = static_cast<Eigen::Index>(axes_[k]);
      double& entry = J(i, k);
      if (turns(axes_[k])) {
        entry = turning.dot(numerics::body_rates(pose.angle(0), pose.angle(1), Vector(Vector::Unit(axis - 3))));
      } else {
        entry = along.dot(shift_from_frd(Vector::Unit(axis)));
      }
    }
  }
  return J;
}

namespace {

/// Half the step of central differences of a Jacobian matrix along the motion [s].
constexpr double kAlongMotion = 1e-4;

/// The pose a moment later, at the present rates.
PlatformCommand moved(const PlatformState& s, double time) {
  PlatformCommand pose = s;
  pose.shift += time * s.velocity;
  pose.angle += time * s.rate;
  return pose;
}

}  // namespace

Legs::Lengths Legs::lengths(const PlatformState& s) const {
  const Eigen::Index n = count();
  Values rate(n), acceleration(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const AxisState a = axis(s, axes_[k]);
    rate(k) = a.rate;
    acceleration(k) = a.acceleration;
  }
  const Square J = jacobian(s);
  const Square changing = (jacobian(moved(s, kAlongMotion)) - jacobian(moved(s, -kAlongMotion))) / (2.0 * kAlongMotion);
  Lengths l{.position = positions(s), .rate = Values(n), .acceleration = Values(n)};
  l.rate.noalias() = J.lazyProduct(rate);
  l.acceleration.noalias() = J.lazyProduct(acceleration) + changing.lazyProduct(rate);
  return l;
}

std::optional<PlatformState> Legs::state(const Lengths& lengths, const PlatformState& near) const {
  const Eigen::Index n = count();
  const auto as_state = [&](const Values& values, auto&& set) {
    for (Eigen::Index k = 0; k < n; ++k) set(axes_[k], values(k));
  };
  PlatformState found;
  found.shift = near.shift;
  found.angle = near.angle;
  constexpr int kMostSteps = 20;
  constexpr double kExact = 1e-13;  // [m]
  double left = kInfinity;
  for (int k = 0; k < kMostSteps && left > kExact; ++k) {
    const Values off = lengths.position - positions(found);
    const double before = left;
    left = off.cwiseAbs().maxCoeff();
    if (!std::isfinite(left)) return std::nullopt;
    if (left >= before && left < 1e-10) break;  // rounding
    const Values change = jacobian(found).partialPivLu().solve(off);
    as_state(change, [&](PlatformAxis which, double by) {
      AxisState a = axis(found, which);
      a.position += std::clamp(by, -0.3, 0.3);
      set_axis(found, which, a);
    });
  }
  if (!(left < 1e-9)) return std::nullopt;
  const Eigen::PartialPivLU<Square> lu(jacobian(found));
  const Values rate = lu.solve(lengths.rate);
  as_state(rate, [&](PlatformAxis which, double value) {
    AxisState a = axis(found, which);
    a.rate = value;
    set_axis(found, which, a);
  });
  const Square changing =
      (jacobian(moved(found, kAlongMotion)) - jacobian(moved(found, -kAlongMotion))) / (2.0 * kAlongMotion);
  const Values acceleration = lu.solve(Values(lengths.acceleration - changing.lazyProduct(rate)));
  as_state(acceleration, [&](PlatformAxis which, double value) {
    AxisState a = axis(found, which);
    a.acceleration = value;
    set_axis(found, which, a);
  });
  return found;
}

}  // namespace veridyn::cueing
