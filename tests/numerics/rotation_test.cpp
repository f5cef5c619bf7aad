#include "veridyn/numerics/rotation.hpp"

#include <ceres/jet.h>

#include <Eigen/LU>

#include "veridyn/numerics/random.hpp"

namespace veridyn::numerics {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Values from Beard & McLain's definition R = Rx(phi) Ry(theta) Rz(psi), built of elementary rotations by Eigen.
TEST(Rotation, IsTheProductOfThreeElementaryRotations) {
  RandomStream random(1, "rotation");
  for (int i = 0; i < 100; ++i) {
    const double phi = random.uniform(-3, 3), theta = random.uniform(-1.5, 1.5), psi = random.uniform(-3, 3);
    const Matrix3d body_to_ned =
        (Eigen::AngleAxisd(psi, Vector3d::UnitZ()) * Eigen::AngleAxisd(theta, Vector3d::UnitY()) *
         Eigen::AngleAxisd(phi, Vector3d::UnitX()))
            .toRotationMatrix();
    EXPECT_LT((R_body_from_ned(phi, theta, psi) - body_to_ned.transpose()).norm(), 1e-14);
    EXPECT_LT((quaternion_from_euler(phi, theta, psi).toRotationMatrix() - body_to_ned).norm(), 1e-14);
    const EulerAngles<double> back =
        euler_from_quaternion(Eigen::Quaterniond((-1.7 * quaternion_from_euler(phi, theta, psi).coeffs()).eval()));
    EXPECT_NEAR(back.phi, phi, 1e-12);
    EXPECT_NEAR(back.theta, theta, 1e-12 + 1e-15 / std::cos(theta));
    EXPECT_NEAR(back.psi, psi, 1e-12);
  }
}

TEST(Rotation, PutsAClimbingNorthwardNoseUpAndGravityIntoMinusX) {
  const Vector3d gravity = R_body_from_ned(0.0, 0.3, 0.0) * Vector3d(0, 0, 9.81);
  EXPECT_NEAR(gravity.x(), -9.81 * std::sin(0.3), 1e-14);
  EXPECT_NEAR(gravity.z(), 9.81 * std::cos(0.3), 1e-14);
}

TEST(Rotation, KinematicsAgreeWithTheDerivativeOfTheMatrix) {
  // With the angles as functions of time, R' = -[omega]x R defines the body rates; R' comes from a Jet in time.
  using Jet = ceres::Jet<double, 1>;
  RandomStream random(2, "kinematics");
  for (int i = 0; i < 50; ++i) {
    const double phi = random.uniform(-3, 3), theta = random.uniform(-1.4, 1.4), psi = random.uniform(-3, 3);
    const Vector3d omega(random.normal(), random.normal(), random.normal());
    const Vector3d rates = euler_rates(phi, theta, omega);
    EXPECT_LT((body_rates(phi, theta, rates) - omega).norm(), 1e-13);

    Jet p(phi), t(theta), s(psi);
    p.v[0] = rates(0);
    t.v[0] = rates(1);
    s.v[0] = rates(2);
    const Matrix3<Jet> R = R_body_from_ned(p, t, s);
    Matrix3d value, rate;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        value(r, c) = R(r, c).a;
        rate(r, c) = R(r, c).v[0];
      }
    Matrix3d cross;
    cross << 0, -omega(2), omega(1), omega(2), 0, -omega(0), -omega(1), omega(0), 0;
    EXPECT_LT((rate + cross * value).norm(), 1e-13);

    const Eigen::Quaternion<Jet> q = quaternion_from_euler(p, t, s);
    const Eigen::Vector4d q_rate = quaternion_rate(quaternion_from_euler(phi, theta, psi), omega);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(q.coeffs()(k).v[0], q_rate(k), 1e-13);
  }
}

TEST(Rotation, WrapsAnglesToHalfATurn) {
  EXPECT_DOUBLE_EQ(wrap_angle(M_PI), M_PI);
  EXPECT_DOUBLE_EQ(wrap_angle(-M_PI), M_PI);
  EXPECT_NEAR(wrap_angle(3 * M_PI + 0.1), -M_PI + 0.1, 1e-14);
  EXPECT_DOUBLE_EQ(wrap_angle(0.5), 0.5);
}

}  // namespace
}  // namespace veridyn::numerics
