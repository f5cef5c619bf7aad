#pragma once

#include <cstddef>

#include "veridyn/muscle/model/model.hpp"
#include "veridyn/numerics/random.hpp"

/// Models that the tests of multibody dynamics share, built by hand.
namespace veridyn::muscle::test {

/// The skeleton of OpenSim's arm26 (Holzbaur et al. 2005): a welded base, shoulder and elbow.
[[nodiscard]] Model arm26_skeleton();

/// Universal: two rotations about x and y. Planar: two translations, then a rotation. Spline: rotation and two
/// translations by splines of one coordinate, like OpenSim's knees. Free: three translations, rotations x, y, z.
/// Gimbal: three rotations about axes that are not orthogonal, with a constant translation. Several: rotations and
/// translations by polynomials in three angles; the first rotation by the first one alone, the third not by it, as
/// Simbody's velocity terms have it.
enum class TreeJoint { kPin, kSlider, kUniversal, kPlanar, kSpline, kFree, kGimbal, kSeveral };
constexpr int kTreeJoints = 8;

[[nodiscard]] Eigen::Vector3d random_vector(double size, numerics::RandomStream& random);
[[nodiscard]] Placement random_placement(numerics::RandomStream& random);
/// A body of random mass, mass centre and (physical) inertia; returns its index.
int add_body(Model& model, numerics::RandomStream& random);
/// A joint of this kind with new coordinates, in random frames and about random axes where its kind leaves them open.
Joint& add_joint(Model& model, TreeJoint kind, int parent, int child, numerics::RandomStream& random);
/// Another way to move along with a parent: a joint without coordinates, its axes at random constants.
Joint& add_weld(Model& model, int parent, int child, numerics::RandomStream& random);

/// `bodies` bodies, each hung by a random kind of joint (one in eight: a weld) on a random earlier one.
[[nodiscard]] Model random_tree(int bodies, numerics::RandomStream& random);
/// Rods in a row on pins about z, gravity along -y.
[[nodiscard]] Model pendulum(int rods);
/// As many bodies and coordinates as OpenSim's gait2392: a free pelvis, two legs of pins and three-axis hips with
/// spline knees, a three-axis back; 23 coordinates.
[[nodiscard]] Model gait_like();

/// Uniform in [-magnitude, magnitude].
[[nodiscard]] Eigen::VectorXd random_state(std::size_t size, double magnitude, numerics::RandomStream& random);

}  // namespace veridyn::muscle::test
