#include "veridyn/vehicle/simulation/surface_drive.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Heights under the wheels of a vehicle that begins each part of a step at the distance 0: on a line from the part's
/// beginning to its end.
class HeldHeights final : public Road {
 public:
  [[nodiscard]] double height(const RoadPoint& point) const override {
    const std::size_t wheel = (point.distance > 0.0 ? kFrontLeft : kRearLeft) + (point.offset >= 0.0 ? 0U : 1U);
    return begin[wheel] + slope[wheel] * (point.distance - ahead[wheel]);
  }
  PerWheel<double> ahead{}, begin{}, end{}, slope{};
};

Vector3d normal(const RoadSurface::Point& point) {
  return Vector3d(-point.slope.x(), -point.slope.y(), 1.0).normalized();
}

/// How far one unit vector is turned from the other, about the axis square to both; for small turns.
Vector3d turned(const Vector3d& from, const Vector3d& to) { return from.cross(to); }

class SurfaceVehicle final : public SteppedVehicle {
 public:
  SurfaceVehicle(const Vehicle& vehicle, const FourWheelOptions& options, std::shared_ptr<const RoadSurface> surface,
                 double usual_speed)
      : vehicle_(vehicle),
        options_(options),
        usual_speed_(usual_speed),
        surface_(std::move(surface)),
        held_(std::make_shared<HeldHeights>()),
        plane_(stepped_vehicle(vehicle, options, held_, usual_speed)) {
    const VehicleParameters<double>& p = vehicle.parameters;
    for (std::size_t i = 0; i < kWheels; ++i) {
      wheels_[i] = {is_front(i) ? p.a : -p.b, (is_left(i) ? 0.5 : -0.5) * (is_front(i) ? p.track_f : p.track_r)};
      held_->ahead[i] = wheels_[i].x();
    }
    sprung_x_ = options.convention == FourWheelConvention::kFirstPrinciples
                    ? 2.0 * p.unsprung_mass * (p.b - p.a) / (p.mass - 4.0 * p.unsprung_mass)
                    : 0.0;
    cg_height_ = p.cg_height;
    reset(0.0);
  }
  void reset(double speed) override {
    plane_->reset(speed);
    const DriveState start = plane_->state();
    reset(start);
  }
  void reset(const DriveState& state) override {
    state_ = state;
    turning_rate_.setZero();
    const RoadSurface::Point point = surface_->at(place());
    const double yaw = state_.vehicle(kYaw);
    axes_.col(2) = normal(point);
    axes_.col(0) = forward_at(yaw);
    axes_.col(1) = axes_.col(2).cross(axes_.col(0));
    turning_ = turning_at(place());
    held_->end = heights_at(place());
    hold(0.0);
  }
  void reset(const DriveState& state, const Vector3d& /*field*/, const Vector2d& /*turning*/) override { reset(state); }

  void step(const Controls& controls, double dt) noexcept override {
    if (!(dt > 0.0 && dt <= 1.0)) {
      ++state_.refused;
      return;
    }
    constexpr double kLongestPart = 0.25e-3;
    const int parts = static_cast<int>(std::ceil(dt / kLongestPart - 1e-9));
    for (int k = 0; k < parts; ++k) part(controls, dt / parts);
    hold(0.0);
  }
  [[nodiscard]] const DriveState& state() const override { return state_; }
  [[nodiscard]] const WheelArray<double>& loads() const override { return plane_->loads(); }

  [[nodiscard]] recording::MotionSample motion(const Vector3d& at) const override {
    recording::MotionSample out = plane_->motion(Vector3d::Zero());
    out.time = state_.time;
    out.position = world().position.head<2>();
    const Eigen::Quaterniond to_body = out.attitude.conjugate();  // from the plane's axes, against which it is
    out.rate += to_body * turning_;
    out.angular_acceleration += to_body * turning_rate_;
    out.attitude = Eigen::Quaterniond(axes_) * out.attitude;
    return recording::at_place(out, at);
  }
  [[nodiscard]] WorldMotion world() const override {
    const FourWheelState<double>& s = state_.vehicle;
    const Vector3d under(s(kX), s(kY), surface_->at(place()).height - cg_height_);
    return {.position = under + height() * axes_.col(2), .velocity = axes_ * Vector3d(s(kU), s(kV), s(kHeaveRate))};
  }
  [[nodiscard]] std::unique_ptr<SteppedVehicle> clone() const override {
    auto copy = std::make_unique<SurfaceVehicle>(vehicle_, options_, surface_, usual_speed_);
    copy->state_ = state_;
    copy->axes_ = axes_;
    copy->turning_ = turning_;
    copy->turning_rate_ = turning_rate_;
    copy->held_->end = held_->end;
    copy->hold(0.0);
    return copy;
  }

 private:
  [[nodiscard]] Vector2d place() const { return {state_.vehicle(kX), state_.vehicle(kY)}; }
  /// The direction in the plane that the map shows at this angle.
  [[nodiscard]] Vector3d forward_at(double yaw) const {
    const Vector3d& n = axes_.col(2);
    const Vector3d level(std::cos(yaw), std::sin(yaw), 0.0);
    return Vector3d(level.x(), level.y(), -(level.x() * n.x() + level.y() * n.y()) / n.z()).normalized();
  }
  /// Of the centre of gravity above the point of the plane under it.
  [[nodiscard]] double height() const { return cg_height_ + state_.vehicle(kHeave); }
  /// How that point moves on the map: the faster, the farther outside of the road's bend the centre of gravity is.
  [[nodiscard]] Vector2d velocity_on_map() const {
    const FourWheelState<double>& s = state_.vehicle;
    return axes_.topLeftCorner<2, 2>() * Vector2d(s(kU) - height() * turning_.y(), s(kV) + height() * turning_.x());
  }
  /// How the plane turns where the vehicle drives on from a place as it does, in the plane's axes [rad/s].
  [[nodiscard]] Vector3d turning_at(const Vector2d& at) const {
    constexpr double kAround = 1e-4;  // [s]
    const Vector2d by = kAround * velocity_on_map();
    const Vector3d turn = turned(normal(surface_->at(at - by)), normal(surface_->at(at + by))) / (2.0 * kAround);
    Vector3d in_plane = axes_.transpose() * turn;
    in_plane.z() = 0.0;
    return in_plane;
  }
  /// Where the wheels stand against the plane that touches the surface at a place.
  [[nodiscard]] PerWheel<double> heights_at(const Vector2d& at) const {
    const RoadSurface::Point under = surface_->at(at);
    const Vector3d n = normal(under), from(at.x(), at.y(), under.height);
    PerWheel<double> heights;
    for (std::size_t i = 0; i < kWheels; ++i) {
      Vector3d wheel = axes_.col(0) * wheels_[i].x() + axes_.col(1) * wheels_[i].y();
      wheel += from - n * n.dot(wheel);
      // Straight up or down to the surface, and what of that is square to the plane: twice, since that is elsewhere.
      double above = 0.0;
      for (int round = 0; round < 2; ++round) {
        const Vector3d there = wheel + above * n;
        above += (surface_->at(there.head<2>()).height - there.z()) * n.z();
      }
      heights[i] = above + surface_->relief(wheel.head<2>());
    }
    return heights;
  }
  /// The plane's vehicle at this state, in the field of the middle of the next part.
  void hold(double h) {
    const Vector2d by = h * velocity_on_map();
    const Vector3d at_end = turning_at(place() + by);
    if (h > 0.0) turning_rate_ = (at_end - turning_) / h;
    mean_turning_ = 0.5 * (turning_ + at_end);
    stand(place() + by, by.norm());
    const FourWheelState<double>& s = state_.vehicle;
    Vector3d down = -options_.gravity * (axes_.transpose() * Vector3d::UnitZ());
    down -= 0.5 * h * mean_turning_.cross(down);
    // Of the velocity in axes that turn, where these are held.
    const Vector3d held_back = mean_turning_.cross(Vector3d(s(kU), s(kV), s(kHeaveRate)));
    DriveState in_plane = state_;
    for (const FourWheelIndex index : {kX, kY, kYaw, kDistance}) in_plane.vehicle(index) = 0.0;
    plane_->reset(in_plane, Vector3d(down.x(), down.y(), options_.gravity + down.z()) - held_back,
                  turning_rate_.head<2>());
  }
  /// The wheels go on from where they stood to where they stand at a place.
  void stand(const Vector2d& at, double distance) {
    held_->begin = held_->end;
    held_->end = heights_at(at);
    for (std::size_t i = 0; i < kWheels; ++i)
      held_->slope[i] = distance > 1e-9 ? (held_->end[i] - held_->begin[i]) / distance : 0.0;
  }
  void part(const Controls& controls, double h) noexcept {
    hold(h);
    plane_->step(controls, h);
    const DriveState& moved = plane_->state();
    const Vector2d before = place();
    const double distance = state_.vehicle(kDistance), yaw_before = state_.vehicle(kYaw);
    state_ = moved;
    const Vector2d after =
        before + axes_.topLeftCorner<2, 2>() * Vector2d(moved.vehicle(kX) - h * height() * mean_turning_.y(),
                                                        moved.vehicle(kY) + h * height() * mean_turning_.x());
    turning_ += h * turning_rate_;
    const double c = std::cos(moved.vehicle(kYaw)), sine = std::sin(moved.vehicle(kYaw));
    const Vector3d n = normal(surface_->at(after));
    const Vector3d turn = turned(axes_.col(2), n);
    // The forward axis is carried to the new plane without turning in it.
    Vector3d forward = c * axes_.col(0) + sine * axes_.col(1);
    forward += turn.cross(forward);
    forward = (forward - forward.dot(n) * n).normalized();
    const Vector3d missed = axes_.transpose() * turn - h * mean_turning_;
    FourWheelState<double>& s = state_.vehicle;
    s(kRoll) -= missed.x();
    s(kPitch) -= missed.y();
    axes_.col(0) = forward;
    axes_.col(1) = n.cross(forward);
    axes_.col(2) = n;
    s(kX) = after.x();
    s(kY) = after.y();
    const double yaw = std::atan2(forward.y(), forward.x());
    s(kYaw) = yaw_before + std::remainder(yaw - yaw_before, 2.0 * kPi);
    s(kDistance) = distance + moved.vehicle(kDistance);
  }

  Vehicle vehicle_;
  FourWheelOptions options_;
  double usual_speed_;
  std::shared_ptr<const RoadSurface> surface_;
  std::shared_ptr<HeldHeights> held_;
  std::unique_ptr<SteppedVehicle> plane_;
  PerWheel<Vector2d> wheels_;
  double sprung_x_ = 0.0, cg_height_ = 0.0;
  DriveState state_;
  Eigen::Matrix3d axes_ = Eigen::Matrix3d::Identity();  ///< of the plane, forward, left, up, in the world
  Vector3d turning_ = Vector3d::Zero();                 ///< of the plane, in its axes [rad/s]
  Vector3d mean_turning_ = Vector3d::Zero();            ///< of a part
  Vector3d turning_rate_ = Vector3d::Zero();            ///< [rad/s^2]
};

}  // namespace

std::unique_ptr<SteppedVehicle> surface_vehicle(const Vehicle& vehicle, const FourWheelOptions& options,
                                                std::shared_ptr<const RoadSurface> surface, double usual_speed) {
  if (!surface) throw InputError("surface", "there is none");
  if (!options.longitudinal)
    throw InputError("vehicle", "without longitudinal dynamics it keeps its speed uphill; a surface needs them");
  if (options.longitudinal->grade != 0.0)
    throw InputError("vehicle", "has a grade of its own; on a surface that is the surface's");
  return std::make_unique<SurfaceVehicle>(vehicle, options, std::move(surface), usual_speed);
}

}  // namespace veridyn::vehicle
