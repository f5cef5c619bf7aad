#include "veridyn/muscle/osim/joint_speeds.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

bool has_angular_velocity(const Joint& joint) {
  return joint.type == "BallJoint" || joint.type == "FreeJoint" || joint.is_ellipsoid();
}

/// Of a joint whose speeds are an angular velocity: its angles' coordinates, and what their rates make.
struct JointAngles {
  JointAngles(const Joint& joint, const Eigen::VectorXd& q) {
    for (std::size_t i = 0; i < 3; ++i) coordinates[i] = joint.rotation[i].coordinate;
    first = q(coordinates[0]);
    second = q(coordinates[1]);
  }

  /// w = B rates.
  [[nodiscard]] Eigen::Vector3d angular_velocity(const Eigen::Vector3d& rates) const {
    const double c0 = std::cos(first), s0 = std::sin(first), c1 = std::cos(second), s1 = std::sin(second);
    return {rates(0) + s1 * rates(2), c0 * rates(1) - s0 * c1 * rates(2), s0 * rates(1) + c0 * c1 * rates(2)};
  }
  [[nodiscard]] Eigen::Vector3d rates(const Eigen::Vector3d& w) const {
    const double c0 = std::cos(first), s0 = std::sin(first);
    const double third = (c0 * w(2) - s0 * w(1)) / std::cos(second);
    return {w(0) - std::sin(second) * third, c0 * w(1) + s0 * w(2), third};
  }

  std::array<int, 3> coordinates{};
  double first = 0.0, second = 0.0;
};

/// Calls change(joint, angles, three numbers) with the numbers of each such joint among `values`, and puts them back.
template <typename Change>
Eigen::VectorXd with_angular_velocities(const Model& model, const Eigen::VectorXd& q, Eigen::VectorXd values,
                                        const Change& change) {
  for (const Joint& joint : model.joints) {
    if (!has_angular_velocity(joint)) continue;
    const JointAngles angles(joint, q);
    Eigen::Vector3d three;
    for (int i = 0; i < 3; ++i) three(i) = values(angles.coordinates[static_cast<std::size_t>(i)]);
    if (three.isZero(0.0)) continue;
    three = change(joint, angles, three);
    for (int i = 0; i < 3; ++i) values(angles.coordinates[static_cast<std::size_t>(i)]) = three(i);
  }
  return values;
}

}  // namespace

Eigen::VectorXd opensim_speeds(const Model& model, const Eigen::VectorXd& q, const Eigen::VectorXd& rates) {
  return with_angular_velocities(model, q, rates,
                                 [](const Joint&, const JointAngles& angles, const Eigen::Vector3d& three) {
                                   return angles.angular_velocity(three);
                                 });
}

Eigen::VectorXd rates_of_opensim_speeds(const Model& model, const Eigen::VectorXd& q, const Eigen::VectorXd& speeds) {
  return with_angular_velocities(
      model, q, speeds, [&](const Joint& joint, const JointAngles& angles, const Eigen::Vector3d& three) {
        constexpr double kSingular = 1e-6;
        if (!(std::abs(std::cos(angles.second)) > kSingular))
          throw InputError(
              model.name,
              fmt::format("joint '{}' has a second angle of {:.6g} rad, where no rates of its angles give the "
                          "angular velocity that its speeds are",
                          joint.name, angles.second));
        return angles.rates(three);
      });
}

}  // namespace veridyn::muscle
