#include "veridyn/estimation/output_error/autodiff_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/output_error/example_models.hpp"

namespace veridyn::estimation {
namespace {

using namespace testing_support;

TEST(AutodiffModel, SensitivitiesAreThoseOfTheClosedForm) {
  // u = 0: x = x0 exp(-a t), so dx/da = -t x, dx/dx0 = exp(-a t), dx/db = 0; rate = -a x.
  const FirstOrder model({VectorXd::Zero(50)}, 0.05);
  const std::vector<Index> active{2, 0, 1};
  ModelResponse r;
  ASSERT_TRUE(model.respond(0, Eigen::Vector3d(kA, kB, 0.8), active, r));
  for (Index k = 0; k < 50; ++k) {
    const double t = 0.05 * static_cast<double>(k), x = 0.8 * std::exp(-kA * t);
    EXPECT_NEAR(r.output(k, 0), x, 1e-13);
    EXPECT_NEAR(r.sensitivity(2 * k, 0), std::exp(-kA * t), 1e-13);
    EXPECT_NEAR(r.sensitivity(2 * k, 1), -t * x, 1e-13);
    EXPECT_NEAR(r.sensitivity(2 * k, 2), 0.0, 1e-15);
    EXPECT_NEAR(r.sensitivity(2 * k + 1, 1), -x + kA * t * x, 1e-13);
  }
}

TEST(AutodiffModel, SensitivitiesAreThoseOfCentralDifferences) {
  const FirstOrder model(doublets(1, 80), 0.05);
  const VectorXd theta = Eigen::Vector3d(kA, kB, 0.4);
  const std::vector<Index> active{0, 1, 2};
  ModelResponse r, low, high;
  ASSERT_TRUE(model.respond(0, theta, active, r));
  for (Index i = 0; i < 3; ++i) {
    const double h = 1e-5;  // error of the differences: h^2 f'''/6 and 1e-16/h, both about 1e-10
    ASSERT_TRUE(model.respond(0, theta + h * VectorXd::Unit(3, i), {}, high));
    ASSERT_TRUE(model.respond(0, theta - h * VectorXd::Unit(3, i), {}, low));
    const RowMatrix difference = (high.output - low.output) / (2.0 * h);
    for (Index k = 0; k < difference.size(); ++k) EXPECT_NEAR(r.sensitivity(k, i), difference.data()[k], 1e-9);
  }
}

/// The same model, whose initial condition has a pass of its own that ends early.
class Forgetful : public AutodiffModel<Forgetful, 2> {
 public:
  explicit Forgetful(const FirstOrder& whole) : whole_(whole) {}
  std::span<const ModelParameter> parameters() const override { return whole_.parameters(); }
  std::span<const ModelOutput> outputs() const override { return whole_.outputs(); }
  std::size_t segments() const override { return whole_.segments(); }
  Index samples(std::size_t s) const override { return whole_.samples(s); }
  std::span<const ModelParameter> initial_conditions(std::size_t s) const override {
    return whole_.initial_conditions(s);
  }
  template <typename Scalar>
  bool simulate(std::size_t s, const Column<Scalar>& theta, Table<Scalar>& y) const {
    ++whole_passes;
    return whole_.simulate(s, theta, y);
  }
  bool simulate_transient(std::size_t s, const Column<ceres::Jet<double, 2>>& theta,
                          Table<ceres::Jet<double, 2>>& y) const {
    ++short_passes;
    EXPECT_EQ(theta(0).v.norm() + theta(1).v.norm(), 0.0);
    const bool done = whole_.simulate(s, theta, y);
    y.bottomRows(y.rows() / 2).setConstant(ceres::Jet<double, 2>(0.0));
    return done;
  }
  mutable int whole_passes = 0, short_passes = 0;

 private:
  const FirstOrder& whole_;
};

TEST(AutodiffModel, InitialConditionsHaveAPassOfTheirOwnWhereThatSavesAWholeOne) {
  const FirstOrder whole(doublets(1, 400), 0.05);
  const Forgetful model(whole);
  const VectorXd theta = Eigen::Vector3d(kA, kB, 0.4);
  const std::vector<Index> all{2, 0, 1};
  ModelResponse expected, made;
  ASSERT_TRUE(whole.respond(0, theta, all, expected));
  ASSERT_TRUE(model.respond(0, theta, all, made));
  EXPECT_EQ(model.whole_passes, 1);
  EXPECT_EQ(model.short_passes, 1);
  EXPECT_EQ(made.output, expected.output);
  EXPECT_LT((made.sensitivity - expected.sensitivity).cwiseAbs().maxCoeff(), 1e-6);  // exp(-1.7 * 10)
  // Two unknowns fit into one pass anyway, and an initial condition alone is no transient of anything.
  const std::vector<Index> two{2, 0}, alone{2};
  ASSERT_TRUE(model.respond(0, theta, two, made));
  ASSERT_TRUE(model.respond(0, theta, alone, made));
  EXPECT_EQ(model.whole_passes, 3);
  EXPECT_EQ(model.short_passes, 1);
}

}  // namespace
}  // namespace veridyn::estimation
