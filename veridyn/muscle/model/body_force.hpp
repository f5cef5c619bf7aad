#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "veridyn/muscle/model/placement.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

/// Forces of a model that act between bodies: `dynamics/body_forces.hpp` has their laws.
namespace veridyn::muscle {

/// A linear spring between points of two bodies (PointToPointSpring).
struct PointSpring {
  std::string name;
  int body_1 = 0, body_2 = 0;
  Eigen::Vector3d point_1 = Eigen::Vector3d::Zero(), point_2 = Eigen::Vector3d::Zero();  ///< in their bodies [m]
  double stiffness = 1.0;                                                                ///< [N/m]
  double rest_length = 0.0;                                                              ///< [m]
};

/// Springs and linear dampers between frames of two bodies (BushingForce, FunctionBasedBushingForce).
struct Bushing {
  std::string name;
  int body_1 = 0, body_2 = 0;
  Placement frame_1, frame_2;  ///< in their bodies
  /// What each deflection is resisted with: moments of the three angles [N m of rad], forces of the translations [N of
  /// m]. None: 0.
  std::array<numerics::PiecewisePolynomial, 6> resistance;
  Eigen::Vector3d rotational_damping = Eigen::Vector3d::Zero();     ///< [N m s/rad]
  Eigen::Vector3d translational_damping = Eigen::Vector3d::Zero();  ///< [N s/m]

  /// Linear springs [N m/rad], [N/m].
  void set_stiffness(const Eigen::Vector3d& rotational, const Eigen::Vector3d& translational) {
    for (std::size_t i = 0; i < 3; ++i) {
      resistance[i] = numerics::PiecewisePolynomial::linear(rotational(static_cast<int>(i)), 0.0);
      resistance[i + 3] = numerics::PiecewisePolynomial::linear(translational(static_cast<int>(i)), 0.0);
    }
  }
};

/// A sphere of one body against a half space of another (HuntCrossleyForce, SmoothSphereHalfSpaceForce).
struct SphereContact {
  std::string name;
  int sphere_body = 0, plane_body = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< in its body [m]
  double radius = 0.0;                               ///< [m]
  Placement plane;                                   ///< in its body; the half space is where x > 0
  double half_stiffness = 0.0;                       ///< k1 k2/(k1 + k2) of k = modulus^(2/3) [N^(2/3) m^(-4/3)]
  double dissipation = 0.0;                          ///< [s/m]
  double static_friction = 0.0, dynamic_friction = 0.0;
  double viscous_friction = 0.0;     ///< [s/m]
  double transition_velocity = 0.1;  ///< [m/s]
  bool smooth = false;
  double constant_force = 1e-5;           ///< smooth: added to squares under roots
  double hertz_smoothing = 300.0;         ///< smooth: steepness of the step at depth 0 [1/m]
  double hunt_crossley_smoothing = 50.0;  ///< smooth: of the step where the force would be a pull [s/m]
};

/// All of a model.
struct BodyForces {
  std::vector<PointSpring> springs;
  std::vector<Bushing> bushings;
  std::vector<SphereContact> contacts;

  [[nodiscard]] bool empty() const { return springs.empty() && bushings.empty() && contacts.empty(); }
};

}  // namespace veridyn::muscle
