#pragma once

#include <Eigen/Core>
#include <array>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_systems/state_space.hpp"

namespace veridyn::cueing {

/// Numbers of the open program shoarai/washout, as it is delivered.
struct ShoaraiSettings {
  double step = 0.01;            ///< [s]
  double shift_high_pass = 2.5;  ///< second order [rad/s]
  double tilt_low_pass = 5.0;    ///< second order [rad/s]
  double turn_high_pass = 2.5;   ///< first order [rad/s]
  double zeta = 1.0;
  bool gravity_from_zero = false;  ///< as there: at the first step the platform knows of no gravity
};

/// The classical algorithm of the open program shoarai/washout, discretised as there (bilinear without prewarping,
/// sums for integrals), to compare with rigs that run it. `ClassicalWashout` is exact at any step; this is not.
///
///     shift   sum of sums of high-pass(a + R' g - g), R the platform's angles at the step before
///     tilt    roll asin(low-pass(a_y) / g), pitch -asin(low-pass(a_x) / g)
///     angle   tilt + sum of high-pass(omega)
///
/// Axes as there: x forward, y left, z up, angles about them. The program starts its gravity at zero, so that a
/// platform that stands falls by 0.96 mm in the first step and 3.6 mm in four; here that is an option.
class ShoaraiWashout {
 public:
  /// @throws InputError for frequencies or a step of zero or below.
  explicit ShoaraiWashout(const ShoaraiSettings& settings);

  /// Commanded pose of the platform.
  struct Pose {
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< [m]
    Eigen::Vector3d angle = Eigen::Vector3d::Zero();  ///< [rad]
  };
  /// @param a acceleration with gravity's reaction, as an accelerometer has it [m/s^2] @param omega [rad/s]
  const Pose& step(const Eigen::Vector3d& a, const Eigen::Vector3d& omega);

 private:
  /// A discrete system of two states at most.
  class Filter {
   public:
    explicit Filter(const numerics::StateSpace& discrete);
    double step(double u);

   private:
    Eigen::Matrix2d A_ = Eigen::Matrix2d::Zero();
    Eigen::Vector2d B_ = Eigen::Vector2d::Zero(), C_ = Eigen::Vector2d::Zero(), x_ = Eigen::Vector2d::Zero();
    double D_ = 0.0;
  };

  ShoaraiSettings settings_;
  std::array<Filter, 3> shift_, turn_;
  std::array<Filter, 2> tilt_;
  Eigen::Vector3d gravity_, speed_ = Eigen::Vector3d::Zero(), turned_ = Eigen::Vector3d::Zero();
  Pose pose_;
};

}  // namespace veridyn::cueing
