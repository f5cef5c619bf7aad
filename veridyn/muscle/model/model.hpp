#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/model/body_force.hpp"
#include "veridyn/muscle/model/expression_force.hpp"
#include "veridyn/muscle/model/loop_constraint.hpp"
#include "veridyn/muscle/model/muscle_parameters.hpp"
#include "veridyn/muscle/model/placement.hpp"
#include "veridyn/numerics/multivariate_polynomial.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

/// A musculoskeletal model as its file describes it: plain data with all names resolved to indices and all offset
/// frames composed into the bodies that carry them. `osim_reader.hpp` makes one, `mechanism.hpp`, `muscle_path.hpp` and
/// `musculotendon.hpp` compute with it.
///
/// SI units, radians. Body 0 is the ground. Lists keep the order of the file.
namespace veridyn::muscle {

/// A rigid body.
struct Body {
  std::string name;
  double mass = 0.0;                                      ///< [kg]
  Eigen::Vector3d mass_center = Eigen::Vector3d::Zero();  ///< in the body frame [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();      ///< about the mass centre, body axes [kg m^2]
};

/// What a coordinate of a joint measures; kCoupled: an angle that moves the joint only through other functions.
enum class CoordinateMotion { kRotational, kTranslational, kCoupled };

/// A generalised coordinate of a joint.
struct Coordinate {
  std::string name;
  CoordinateMotion motion = CoordinateMotion::kRotational;
  int joint = 0;
  double default_value = 0.0;  ///< [rad] or [m]
  double default_speed = 0.0;  ///< rate at the default pose [rad/s] or [m/s]
  double low = 0.0;            ///< of its range [rad] or [m]
  double high = 0.0;
  bool clamped = false;
  bool locked = false;
  /// "m" or "rad".
  std::string unit() const { return motion == CoordinateMotion::kTranslational ? "m" : "rad"; }
  /// low <= value <= high but for rounding; false for NaN.
  [[nodiscard]] bool in_range(double value) const;
  /// "coordinate 'elbow_flexion' = 3 rad is outside its range 0 .. 2.2689", for a message about a value that is not.
  [[nodiscard]] std::string outside_range(double value) const;
};

/// One of the six motions of a joint: by function(coordinate) about or along `axis`.
struct TransformAxis {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< of unit length
  int coordinate = -1;                              ///< index of a coordinate of the model; -1: a constant
  numerics::PiecewisePolynomial function;
  /// Of several coordinates, in place of both: their indices, the arguments of `function_of_several`.
  std::vector<int> several{};
  numerics::MultivariatePolynomial function_of_several{};
};

/// Child frame in the parent frame: rotation R(axis 0) R(axis 1) R(axis 2), body-fixed in this order, and translation
/// sum_i function_i axis_i along the three translation axes, taken in the parent frame. Every type of joint is one.
///
/// Free and ball joints are given the angles and the rates of a body-fixed x-y-z sequence; OpenSim's speeds of such
/// joints are angular velocities, so that their generalised forces differ from ours by that map.
struct Joint {
  std::string name;
  std::string type;        ///< as in the file: "CustomJoint", "PinJoint", ...
  int parent = 0;          ///< body
  int child = 0;           ///< body
  Placement parent_frame;  ///< the joint's frame in the parent body
  Placement child_frame;   ///< the joint's frame in the child body
  std::vector<int> coordinates;
  std::array<TransformAxis, 3> rotation;
  std::array<TransformAxis, 3> translation;
  /// The coordinates give the parent's frame in the child's instead: the body nearer to the ground is `parent` in any
  /// case.
  bool reversed = false;
  /// Above 0: the child's frame is on an ellipsoid about the parent's frame, at radii times its z axis, component by
  /// component, in place of `translation`; rotations 0 and 1 are about x and y by their coordinates themselves [m].
  Eigen::Vector3d ellipsoid_radii = Eigen::Vector3d::Zero();

  [[nodiscard]] bool is_ellipsoid() const { return ellipsoid_radii.x() > 0.0; }
};

/// value(dependent) = function(value(independent)) (CoordinateCouplerConstraint).
struct CoordinateCoupler {
  std::string name;
  int independent = 0;
  int dependent = 0;
  numerics::PiecewisePolynomial function;
};

/// How a point of a muscle's path is given.
enum class PathPointKind {
  kFixed,
  kConditional,  ///< part of the path only while low <= coordinate <= high
  kMoving,       ///< location = functions of coordinates
};

/// A point that a muscle's path passes through.
struct PathPoint {
  std::string name;
  PathPointKind kind = PathPointKind::kFixed;
  int body = 0;
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  ///< in the body frame [m]
  int coordinate = -1;                                 ///< conditional
  double low = 0.0, high = 0.0;
  Placement frame{};                                 ///< moving: in whose axes it is given, in the body
  std::array<int, 3> moving_coordinate{-1, -1, -1};  ///< moving: x, y, z; -1: a constant
  std::array<numerics::PiecewisePolynomial, 3> moving_location;
};

/// Surfaces that paths wrap over.
enum class WrapShape { kSphere, kCylinder, kEllipsoid, kTorus };

/// Half space, in the wrap object's frame, to which wrapping is confined: sign * x[axis] > 0; sign 0: everywhere.
struct WrapQuadrant {
  int axis = 0;
  int sign = 0;
};

/// A surface fixed to a body that muscle paths wrap over.
struct WrapObject {
  std::string name;
  WrapShape shape = WrapShape::kSphere;
  int body = 0;
  Placement placement;  ///< the object's frame in the body
  bool active = true;
  WrapQuadrant quadrant;
  /// Sphere: radius. Cylinder: radius, length (its axis is z). Ellipsoid: the three radii. Torus: inner and outer
  /// radius (its axis is z). [m]
  Eigen::Vector3d dimensions = Eigen::Vector3d::Zero();
};

/// OpenSim's ways of choosing an ellipsoid's wrapping plane.
enum class EllipsoidMethod { kHybrid, kMidpoint, kAxial };

/// A wrap object of a muscle's path.
struct PathWrap {
  int object = 0;       ///< in Model::wrap_objects
  int first_point = 0;  ///< of the path, 0-based, inclusive: only between these points is there wrapping
  int last_point = -1;  ///< inclusive; -1: the path's last
  EllipsoidMethod method = EllipsoidMethod::kHybrid;
};

/// The length [m] of a path as a function of coordinates, without geometry (FunctionBasedPath).
struct PathFunction {
  std::vector<int> coordinates;  ///< the function's arguments, each once
  std::variant<numerics::PiecewisePolynomial, numerics::MultivariatePolynomial> length;
};

/// A muscle with its path.
struct Muscle {
  MuscleParameters parameters;
  std::vector<PathPoint> points;
  std::vector<PathWrap> wraps;
  std::optional<PathFunction> function{};  ///< in place of points and wraps
  bool enabled = true;                     ///< appliesForce
  [[nodiscard]] const std::string& name() const { return parameters.name; }
};

/// Generalised force optimal_force * control on a coordinate (CoordinateActuator).
struct CoordinateActuator {
  std::string name;
  int coordinate = 0;
  double optimal_force = 1.0;  ///< [N] or [N m]
  double min_control = -1.0e300;
  double max_control = 1.0e300;
};

/// Spring and damper that keep a coordinate in its range (CoordinateLimitForce); SI per radian or metre.
struct CoordinateLimitForce {
  std::string name;
  int coordinate = 0;
  double upper_stiffness = 1.0, upper_limit = 0.0;
  double lower_stiffness = 1.0, lower_limit = 0.0;
  double damping = 0.001;
  double transition = 0.1;
};

/// Spring and damper on a coordinate (SpringGeneralizedForce): -stiffness (q - rest_length) - viscosity qdot.
struct CoordinateSpring {
  std::string name;
  int coordinate = 0;
  double stiffness = 0.0;    ///< [N m/rad] or [N/m]
  double rest_length = 0.0;  ///< [rad] or [m]
  double viscosity = 0.0;    ///< [N m s/rad] or [N s/m]
};

/// Tension stiffness (L - L0) (1 + dissipation L') of a stretched path, never below zero (PathSpring).
struct PathSpringLaw {
  double resting_length = 0.0;  ///< [m]
  double stiffness = 0.0;       ///< [N/m]
  double dissipation = 0.0;     ///< [s/m]
};

/// Tension pcsa_force curve((L - L0)/L0) of a stretched path (Ligament).
struct LigamentLaw {
  double resting_length = 0.0;  ///< [m]
  double pcsa_force = 0.0;      ///< [N]
  numerics::PiecewisePolynomial curve;
};

/// Tension of a path at strain e = L/L0 - 1 above 0, as Blankevoort & Huiskes (1991) have it, J Biomech Eng 113:263
/// (Blankevoort1991Ligament): k e^2/(2 e_t) up to the transition strain e_t and k (e - e_t/2) from there, and while it
/// lengthens damping e', which fades out below a strain of 0.01.
struct BlankevoortLaw {
  double slack_length = 0.0;         ///< L0 [m]
  double linear_stiffness = 0.0;     ///< k [N]: per strain
  double transition_strain = 0.06;   ///< e_t
  double damping_coefficient = 0.0;  ///< [N s]: per strain rate
};

/// How a path's tension follows from its length and speed: `passive_tension` in dynamics/coordinate_forces.hpp.
using PassivePathLaw = std::variant<PathSpringLaw, LigamentLaw, BlankevoortLaw>;

/// A path under tension that nothing excites. It wraps as muscles do.
struct PassivePath {
  std::string name;
  std::vector<PathPoint> points;
  std::vector<PathWrap> wraps;
  std::optional<PathFunction> function{};  ///< in place of points and wraps
  PassivePathLaw law;
};

/// A point on a body that motion capture observes.
struct Marker {
  std::string name;
  int body = 0;
  Eigen::Vector3d location = Eigen::Vector3d::Zero();
};

/// An element of the file that this program does not compute with. It is kept when the model is written back.
struct UnsupportedElement {
  std::string element;  ///< "HuntCrossleyForce"
  std::string name;     ///< "contact_r"
  /// True when it would change the motion (a force, a constraint); a simulation then runs only with
  /// `without_unsupported`.
  bool changes_motion = false;
};

/// The whole model. Indices are positions in these lists.
struct Model {
  std::string name;
  std::string credits;
  int version = 0;                               ///< of the document, 40000 for OpenSim 4.0
  Eigen::Vector3d gravity{0.0, -kGravity, 0.0};  ///< in ground [m/s^2]
  std::vector<Body> bodies;                      ///< [0] is the ground
  std::vector<Joint> joints;
  std::vector<Coordinate> coordinates;
  std::vector<CoordinateCoupler> couplers;
  std::vector<LoopConstraint> loops;
  std::vector<WrapObject> wrap_objects;
  std::vector<Muscle> muscles;
  std::vector<CoordinateActuator> actuators;
  std::vector<CoordinateLimitForce> limit_forces;
  std::vector<CoordinateSpring> coordinate_springs;
  BodyForces body_forces;
  ExpressionForces expression_forces;
  std::vector<PassivePath> passive_paths;
  std::vector<Marker> markers;
  std::vector<UnsupportedElement> unsupported;
  std::vector<std::string> warnings;

  /// Index of a name, or -1.
  [[nodiscard]] int body(std::string_view name) const;
  [[nodiscard]] int coordinate(std::string_view name) const;
  [[nodiscard]] int muscle(std::string_view name) const;
  /// In the model's order.
  [[nodiscard]] std::vector<std::string> coordinate_names() const;
  [[nodiscard]] std::vector<std::string> muscle_names() const;
  /// "model 'arm26' has no coordinate 'elbow'; did you mean 'r_elbow_flex'?", for a message about a name without index.
  [[nodiscard]] std::string no_coordinate(std::string_view name) const;
  [[nodiscard]] std::string no_muscle(std::string_view name) const;
  /// Coordinate values and speeds as the file sets them, coupled ones by their couplers.
  [[nodiscard]] Eigen::VectorXd default_pose() const;
};

/// A load held by a body: `mass` [kg], a point at `location` [m] of the body's frame, added to its mass, mass centre
/// and inertia. @throws InputError naming the body when there is none of that name or the mass is negative.
void add_load(Model& model, std::string_view body, double mass, const Eigen::Vector3d& location);

}  // namespace veridyn::muscle
