#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <memory>
#include <vector>

namespace veridyn::muscle::test {

/// A tree of joints without any type of ours: Simbody's headers need C++17, ours C++20. See `simbody_description.hpp`.
struct TreeDescription {
  struct Frame {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
  };
  struct Body {
    double mass;
    Eigen::Vector3d mass_center;
    Eigen::Matrix3d inertia;  ///< about the mass centre
  };
  struct Axis {
    Eigen::Vector3d direction;
    int coordinate;  ///< -1: none
    /// Value, slope and curvature.
    std::function<std::array<double, 3>(double)> function;
    std::vector<int> several{};  ///< coordinates, in place of both, of
    /// the value at x, or its derivative by one or two arguments.
    std::function<double(const std::vector<int>& by, const std::vector<double>& x)> of_several{};
  };
  /// As OpenSim builds a joint: of functions of coordinates, or by the mobilizer of its own type.
  enum class Mobilizer { kFunctions, kUniversal, kBall, kGimbal, kPlanar, kFree, kEllipsoid };
  struct Joint {
    int parent, child;
    Frame parent_frame, child_frame;
    std::vector<int> coordinates;
    std::array<Axis, 6> axes;  ///< rotations, translations
    Mobilizer mobilizer = Mobilizer::kFunctions;
    Eigen::Vector3d radii = Eigen::Vector3d::Ones();  ///< of an ellipsoid
    bool reversed = false;                            ///< coordinates move the parent against the child
  };
  /// Holds body 2 to body 1. Points are the frames' origins; the line is the x axis of frame 1.
  struct Constraint {
    enum class Kind { kPoint, kWeld, kDistance, kPointOnLine } kind;
    int body_1, body_2;
    Frame frame_1, frame_2;
    double distance;
  };
  Eigen::Vector3d gravity;
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Constraint> constraints;
  std::size_t coordinates = 0;
};

/// Bodies and joints as a Simbody system (Sherman, Seth & Delp 2011), joints as FunctionBased mobilizers (what OpenSim
/// makes of a CustomJoint) or of their own types. Speeds, accelerations and forces are those of the coordinates, also
/// where Simbody's own speeds are angular velocities.
class SimbodyTree {
 public:
  explicit SimbodyTree(const TreeDescription& tree);
  ~SimbodyTree();
  SimbodyTree(const SimbodyTree&) = delete;
  SimbodyTree& operator=(const SimbodyTree&) = delete;

  /// Vectors by the coordinates of the model.
  void set_state(const Eigen::VectorXd& q, const Eigen::VectorXd& qdot);
  /// Simbody's, of the state set, by the coordinate whose place among its joint's they have.
  [[nodiscard]] Eigen::VectorXd speeds() const;
  /// With the coordinate forces tau and gravity.
  [[nodiscard]] Eigen::VectorXd accelerations(const Eigen::VectorXd& tau);
  /// Realizes to accelerations with no forces but gravity, after a change of state: for time measurements.
  void realize_accelerations();
  /// Mass matrix and inverse dynamics where Simbody's speeds are those of the coordinates, and no constraints.
  [[nodiscard]] Eigen::MatrixXd mass_matrix() const;
  [[nodiscard]] Eigen::VectorXd inverse_dynamics(const Eigen::VectorXd& qddot) const;
  [[nodiscard]] TreeDescription::Frame body_pose(int body) const;
  /// Of the body's mass centre, and the angular velocity, in ground.
  [[nodiscard]] Eigen::Vector3d mass_center_velocity(int body) const;
  [[nodiscard]] Eigen::Vector3d angular_velocity(int body) const;

 private:
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace veridyn::muscle::test
