#include "veridyn/muscle/dynamics/inverse_dynamics.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/muscle/dynamics/model_trees.hpp"
#include "tests/muscle/reference_table.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

// One rod on a pin, by hand: (I + m l^2) qddot + m g l sin q.
TEST(InverseDynamics, IsThatOfAPendulum) {
  const Model model = test::pendulum(1);
  const Mechanism mechanism(model);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.7), qdot = Eigen::VectorXd::Constant(1, -2.0),
                        qddot = Eigen::VectorXd::Constant(1, 3.0);
  const double expected = (0.02 + 1.0 * 0.25 * 0.25) * 3.0 + 1.0 * 9.80665 * 0.25 * std::sin(0.7);
  EXPECT_NEAR(inverse_dynamics(mechanism, q, qdot, qddot)(0), expected, 1e-14);
}

// Two rods: the textbook's double pendulum in relative angles.
TEST(InverseDynamics, IsThatOfADoublePendulum) {
  const Model model = test::pendulum(2);
  const Mechanism mechanism(model);
  const double m1 = 1.0, m2 = 1.5, I = 0.02, l = 0.5, c = 0.25, g = 9.80665;
  const double a = 0.4, b = -0.9, da = 1.3, db = -0.6, dda = 2.0, ddb = -4.0;
  const double M11 = 2.0 * I + m1 * c * c + m2 * (l * l + c * c + 2.0 * l * c * std::cos(b));
  const double M12 = I + m2 * (c * c + l * c * std::cos(b)), M22 = I + m2 * c * c;
  const double h = -m2 * l * c * std::sin(b);
  const double t1 = M11 * dda + M12 * ddb + h * (2.0 * da * db + db * db) + (m1 * c + m2 * l) * g * std::sin(a) +
                    m2 * c * g * std::sin(a + b);
  const double t2 = M12 * dda + M22 * ddb - h * da * da + m2 * c * g * std::sin(a + b);
  const Eigen::VectorXd tau =
      inverse_dynamics(mechanism, Eigen::VectorXd(Eigen::Vector2d(a, b)), Eigen::VectorXd(Eigen::Vector2d(da, db)),
                       Eigen::VectorXd(Eigen::Vector2d(dda, ddb)));
  EXPECT_NEAR(tau(0), t1, 1e-13);
  EXPECT_NEAR(tau(1), t2, 1e-13);
}

class OpenSimInverseDynamics : public testing::TestWithParam<const char*> {};

// OpenSim 4.5.2's InverseDynamicsSolver in 20 random states.
TEST_P(OpenSimInverseDynamics, IsOurs) {
  const std::string name = GetParam();
  const std::string file = fmt::format("{}/data/opensim/{}.osim", veridyn::test::shared_folder().string(), name);
  const test::ReferenceTable table = test::read_reference(fmt::format("opensim/g_{}_inverse_dynamics.csv", name));
  if (table.rows.empty() || !std::filesystem::exists(file)) GTEST_SKIP() << "no " << file << " or its reference";
  const Model model = read_osim(file);
  const Mechanism mechanism(model);
  const auto n = static_cast<std::size_t>(mechanism.coordinates());
  ASSERT_EQ(table.rows.size() % n, 0U);
  double worst = 0.0;
  for (std::size_t first = 0; first < table.rows.size(); first += n) {
    Eigen::VectorXd q(mechanism.coordinates()), qdot(q), qddot(q), expected(q), gravity(q);
    for (std::size_t row = first; row < first + n; ++row) {
      ASSERT_EQ(table.text(row, "case"), table.text(first, "case"));
      const int c = model.coordinate(table.text(row, "coordinate"));
      ASSERT_GE(c, 0);
      q(c) = table.number(row, "q_rad_or_m");
      qdot(c) = table.number(row, "qdot");
      qddot(c) = table.number(row, "qddot");
      expected(c) = table.number(row, "generalized_force_Nm_or_N");
      gravity(c) = table.number(row, "gravity_only_generalized_force");
    }
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(q.size());
    const Eigen::VectorXd tau = inverse_dynamics(mechanism, q, qdot, qddot);
    const Eigen::VectorXd at_rest = inverse_dynamics(mechanism, q, zero, zero);
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      EXPECT_NEAR(tau(i), expected(i), 1e-8 * std::abs(expected(i))) << "row " << first << " coordinate " << i;
      EXPECT_NEAR(at_rest(i), gravity(i), 1e-8 * std::abs(gravity(i)) + 1e-12);
      worst = std::max(worst, std::abs(tau(i) - expected(i)) / std::abs(expected(i)));
    }
  }
  RecordProperty("worst_relative_difference", fmt::format("{:.2e}", worst));
}

INSTANTIATE_TEST_SUITE_P(Models, OpenSimInverseDynamics, testing::Values("arm26", "leg6dof9musc"));

// A flexion of the elbow with minimum jerk, sampled every 5 ms.
TEST(InverseDynamics, OfAnElbowFlexionIsOpenSims) {
  const test::ReferenceTable table = test::read_reference("opensim/d_arm26_inverse_dynamics.csv");
  if (table.rows.empty()) GTEST_SKIP() << "no reference/opensim under " << veridyn::test::shared_folder().string();
  const Model model = test::arm26_skeleton();
  const Mechanism mechanism(model);
  const auto rows = static_cast<Eigen::Index>(table.rows.size());
  CoordinateTable q = CoordinateTable::Zero(rows, 2), qdot = q, qddot = q;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double t = table.number(static_cast<std::size_t>(i), "time_s"), s = std::numbers::pi / 2.0;
    q(i, 1) = s * (10.0 * std::pow(t, 3) - 15.0 * std::pow(t, 4) + 6.0 * std::pow(t, 5));
    qdot(i, 1) = s * (30.0 * std::pow(t, 2) - 60.0 * std::pow(t, 3) + 30.0 * std::pow(t, 4));
    qddot(i, 1) = s * (60.0 * t - 180.0 * t * t + 120.0 * std::pow(t, 3));
  }
  const CoordinateTable tau = inverse_dynamics(mechanism, q, qdot, qddot);
  for (Eigen::Index i = 0; i < rows; ++i) {
    EXPECT_NEAR(tau(i, 0), table.number(i, "r_shoulder_elev_moment_Nm"), 1e-12);
    EXPECT_NEAR(tau(i, 1), table.number(i, "r_elbow_flex_moment_Nm"), 1e-12);
  }
}

}  // namespace
}  // namespace veridyn::muscle
