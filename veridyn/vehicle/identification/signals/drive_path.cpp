#include "veridyn/vehicle/identification/signals/drive_path.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::vehicle {
namespace {

using Eigen::Vector2d;

/// A way shorter than this [m] does not tell which way a window begins.
constexpr double kShortestBase_m = 1.0;

/// A window's path, heading ahead and beginning at the origin.
struct Path {
  std::vector<double> heading;
  std::vector<Vector2d> place;
  std::vector<double> way;  ///< driven so far [m]
};

Path integrated(const SimulatedTurning& motion, const std::vector<double>& speed, double step) {
  Path path{.heading = {0.0}, .place = {Vector2d::Zero()}, .way = {0.0}};
  for (std::size_t k = 1; k < motion.yaw_rate.size(); ++k) {
    const double psi = path.heading.back() + 0.5 * step * (motion.yaw_rate[k - 1] + motion.yaw_rate[k]);
    const double middle = 0.5 * (path.heading.back() + psi);
    const double u = 0.5 * (speed[motion.first + k - 1] + speed[motion.first + k]);
    const double v = 0.5 * (motion.lateral_velocity[k - 1] + motion.lateral_velocity[k]);
    const double c = std::cos(middle), s = std::sin(middle);
    path.place.emplace_back(path.place.back() + step * Vector2d(u * c - v * s, u * s + v * c));
    path.way.push_back(path.way.back() + step * std::hypot(u, v));
    path.heading.push_back(psi);
  }
  return path;
}

/// The turn and shift that lay `from` onto `to`, least squares; nothing where the points are all one.
struct Placement {
  double angle = 0.0;
  Vector2d from_centre = Vector2d::Zero(), to_centre = Vector2d::Zero();

  [[nodiscard]] Vector2d operator()(const Vector2d& p) const {
    const double c = std::cos(angle), s = std::sin(angle);
    const Vector2d d = p - from_centre;
    return to_centre + Vector2d(c * d.x() - s * d.y(), s * d.x() + c * d.y());
  }
};

std::optional<Placement> placement(const std::vector<Vector2d>& from, const std::vector<Vector2d>& to) {
  if (from.size() < 2) return std::nullopt;
  Placement out;
  for (std::size_t i = 0; i < from.size(); ++i) {
    out.from_centre += from[i] / static_cast<double>(from.size());
    out.to_centre += to[i] / static_cast<double>(from.size());
  }
  double along = 0.0, across = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Vector2d a = from[i] - out.from_centre, b = to[i] - out.to_centre;
    along += a.dot(b);
    across += a.x() * b.y() - a.y() * b.x();
  }
  if (along == 0.0 && across == 0.0) return std::nullopt;
  out.angle = std::atan2(across, along);
  return out;
}

/// Squared errors over all windows, and the size of the last of each.
struct Errors {
  double squares = 0.0;
  std::size_t samples = 0;
  std::vector<double> ends = {};

  [[nodiscard]] std::optional<DrivePath::Error> error() const {
    if (samples == 0) return std::nullopt;
    return DrivePath::Error{std::sqrt(squares / static_cast<double>(samples)), numerics::median(ends), samples};
  }
};

/// View of the signals while windows are compared with them.
class Comparison {
 public:
  explicit Comparison(const DriveSignals& signals)
      : s_(signals),
        has_heading_(signals[DriveSignal::kYaw].available()),
        has_position_(signals[DriveSignal::kX].available() && signals[DriveSignal::kY].available()) {}

  void add(const SimulatedTurning& motion) {
    const std::size_t n = motion.yaw_rate.size();
    if (n <= motion.forecast_from || motion.forecast_from == 0) return;
    const Path path = integrated(motion, s_[DriveSignal::kSpeed].value, s_.grid.step);
    const std::optional<double> heading = heading_offset(motion, path);
    const std::optional<Placement> placed = place(motion, path);
    const std::size_t begin = out_.time.size();
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t at = motion.first + k;
      const Vector2d p = placed ? (*placed)(path.place[k]) : Vector2d::Constant(kNaN);
      out_.time.push_back(s_.grid.at(at));
      out_.x.push_back(has_position_ ? s_[DriveSignal::kX].value[at] : kNaN);
      out_.y.push_back(has_position_ ? s_[DriveSignal::kY].value[at] : kNaN);
      out_.yaw.push_back(has_heading_ ? s_[DriveSignal::kYaw].value[at] : kNaN);
      out_.x_model.push_back(p.x());
      out_.y_model.push_back(p.y());
      out_.yaw_model.push_back(heading ? path.heading[k] + *heading : kNaN);
    }
    score(motion, path, placed ? placed->angle : 0.0, begin);
    ways_.push_back(path.way.back() - path.way[motion.forecast_from]);
    out_.time.push_back(out_.time.back());
    for (auto* series : {&out_.x, &out_.y, &out_.yaw, &out_.x_model, &out_.y_model, &out_.yaw_model})
      series->push_back(kNaN);
  }

  DrivePath finish() {
    out_.heading = heading_.error();
    out_.position = position_.error();
    if (out_.position) out_.across_rmse = std::sqrt(across_squares_ / static_cast<double>(position_.samples));
    if (!ways_.empty()) out_.distance_m = numerics::median(ways_);
    if (!out_.available()) return {};
    return std::move(out_);
  }

 private:
  [[nodiscard]] std::optional<double> heading_offset(const SimulatedTurning& motion, const Path& path) const {
    if (!has_heading_) return std::nullopt;
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < motion.forecast_from; ++k) {
      const double measured = s_[DriveSignal::kYaw].value[motion.first + k];
      if (!std::isfinite(measured)) continue;
      sum += measured - path.heading[k];
      count += 1.0;
    }
    return count > 0.0 ? std::optional(sum / count) : std::nullopt;
  }

  [[nodiscard]] std::optional<Placement> place(const SimulatedTurning& motion, const Path& path) const {
    if (!has_position_ || !(path.way[motion.forecast_from] > kShortestBase_m)) return std::nullopt;
    std::vector<Vector2d> from, to;
    for (std::size_t k = 0; k < motion.forecast_from; ++k) {
      const Vector2d measured = position(motion.first + k);
      if (!measured.allFinite()) continue;
      from.push_back(path.place[k]);
      to.push_back(measured);
    }
    return placement(from, to);
  }

  [[nodiscard]] Vector2d position(std::size_t at) const {
    return {s_[DriveSignal::kX].value[at], s_[DriveSignal::kY].value[at]};
  }

  /// @param angle  by which the path was turned  @param begin  of the window in the series
  void score(const SimulatedTurning& motion, const Path& path, double angle, std::size_t begin) {
    double last_heading = kNaN, last_position = kNaN;
    for (std::size_t k = motion.forecast_from; k < path.heading.size(); ++k) {
      const std::size_t row = begin + k;
      if (const double e = out_.yaw[row] - out_.yaw_model[row]; std::isfinite(e)) {
        heading_.squares += e * e;
        ++heading_.samples;
        last_heading = std::abs(e);
      }
      const Vector2d e(out_.x[row] - out_.x_model[row], out_.y[row] - out_.y_model[row]);
      if (!e.allFinite()) continue;
      const double psi = path.heading[k] + angle;
      const double across = std::cos(psi) * e.y() - std::sin(psi) * e.x();
      position_.squares += e.squaredNorm();
      across_squares_ += across * across;
      ++position_.samples;
      last_position = e.norm();
    }
    if (std::isfinite(last_heading)) heading_.ends.push_back(last_heading);
    if (std::isfinite(last_position)) position_.ends.push_back(last_position);
  }

  const DriveSignals& s_;
  bool has_heading_, has_position_;
  DrivePath out_;
  Errors heading_, position_;
  double across_squares_ = 0.0;
  std::vector<double> ways_;
};

}  // namespace

DrivePath drive_path(const DriveSignals& signals, std::span<const SimulatedTurning> windows) {
  Comparison comparison(signals);
  for (const SimulatedTurning& window : windows) comparison.add(window);
  return comparison.finish();
}

void add_path(const DrivePath& path, estimation::Estimate& estimate) {
  if (path.heading) {
    estimate.fit["open_loop.yaw.rmse"] = path.heading->rmse;
    estimate.fit["open_loop.yaw.at_end"] = path.heading->at_end;
  }
  if (path.position) {
    estimate.fit["open_loop.position.rmse"] = path.position->rmse;
    estimate.fit["open_loop.position.across_rmse"] = path.across_rmse;
    estimate.fit["open_loop.position.at_end"] = path.position->at_end;
    estimate.fit["open_loop.position.way"] = path.distance_m;
  }
}

}  // namespace veridyn::vehicle
