#include "veridyn/muscle/actuator/millard2012.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/muscle/actuator/curve_checks.hpp"
#include "tests/muscle/reference_table.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

TEST(Millard2012, MatchesPrintedValuesOfItsCurves) {
  const Millard2012 m;
  expect_points(
      std::array<Point, 8>{{{0.5, 0.0985324896188},
                            {0.6, 0.451101878326},
                            {0.7, 0.767020368569},
                            {0.8, 0.870676613280},
                            {0.9, 0.956759832543},
                            {1.1, 0.957375532280},
                            {1.2, 0.823680970871},
                            {1.6, 0.263026883712}}},
      [&](double l) { return m.active_length(l); }, 2e-12);
  expect_points(
      std::array<Point, 8>{{{1.01, 9.52905496297e-5},
                            {1.05, 0.00650549281026},
                            {1.1, 0.0170448350974},
                            {1.2, 0.0496920302056},
                            {1.4, 0.262889776607},
                            {1.6, 0.717069527083},
                            {1.7, 1.0},
                            {1.8, 1.28571428571}}},
      [&](double l) { return m.passive_force(l); }, 5e-12);
  expect_points(
      std::array<Point, 8>{{{1.002, 0.0073169466243},
                            {1.005, 0.0376044936314},
                            {1.01, 0.0996782701220},
                            {1.02, 0.260935982615},
                            {1.03, 0.479398712348},
                            {1.04, 0.747448979592},
                            {1.049, 1.0},
                            {1.06, 1.30867346939}}},
      [&](double l) { return m.tendon_force(l); }, 1e-11);
  expect_points(
      std::array<Point, 8>{{{-0.95, 0.0028515625},
                            {-0.75, 0.0515193957346},
                            {-0.5, 0.158085604442},
                            {-0.25, 0.387332954220},
                            {-0.1, 0.625214284313},
                            {0.1, 1.22515383775},
                            {0.25, 1.28321080995},
                            {0.75, 1.36995390035}}},
      [&](double v) { return m.velocity_curve().value(v); }, 5e-12);
  EXPECT_NEAR(m.active(0.7).slope, 1.75543533, 5e-9);
  EXPECT_NEAR(m.passive(1.4).slope, 1.658116768, 5e-10);
  EXPECT_NEAR(m.tendon(1.01).slope, 13.83603693, 5e-9);
  EXPECT_NEAR(m.velocity_curve().value_and_slope(-0.5).slope, 0.642631454, 5e-10);
  EXPECT_NEAR(m.velocity_curve().value_and_slope(0.0).slope, 5.0, 1e-10);
  const Millard2012 undamped({}, false);
  expect_points(
      std::array<Point, 4>{
          {{0.2, -0.44776076324}, {0.5, -0.169084471713}, {1.2, 0.0727384571168}, {1.35, 0.643461276194}}},
      [&](double f) { return undamped.inverse_velocity_curve().value(f); }, 1e-11);
}

TEST(Millard2012, CurvesAreThoseOfOpenSimToABillionth) {
  const std::string file = "b3_millard_default_curves.csv";
  const test::ReferenceTable table = test::read_reference("opensim/" + file);
  if (table.rows.empty()) GTEST_SKIP() << "no reference/opensim/" << file << " in the folder of others\' data";
  const Millard2012 damped, undamped({}, false);
  // The program that wrote the file gave the inverse curve end slopes of 0.1.
  const Millard2012 steep({.concentric_slope_at_vmax = 0.1, .eccentric_slope_at_vmax = 0.1}, false);
  double value = 0.0, slope = 0.0, curvature = 0.0, quick = 0.0, quick_slope = 0.0;
  std::size_t used = 0;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const std::string& name = table.text(i, "curve");
    const QuinticBezierCurve* curve = nullptr;
    if (name == "active_force_length_min0.1") curve = &undamped.active_curve();
    if (name == "active_force_length_min0") curve = &damped.active_curve();
    if (name == "force_velocity_inverse") curve = &steep.inverse_velocity_curve();
    if (name == "force_velocity") curve = &damped.velocity_curve();
    if (name.starts_with("passive") || name.starts_with("fiber")) curve = &damped.passive_curve();
    if (name.starts_with("tendon")) curve = &damped.tendon_curve();
    ASSERT_NE(curve, nullptr) << name;
    ++used;
    const double x = table.number(i, "x");
    const numerics::FunctionValue<double> f = curve->exact(x);
    const CurveValue g = curve->value_and_slope(x);
    const auto worst = [](double& greatest, double a, double b) {
      greatest = std::max(greatest, std::abs(a - b) / std::max(1.0, std::abs(b)));
    };
    worst(value, f.value, table.number(i, "value"));
    worst(slope, f.slope, table.number(i, "dvalue_dx"));
    worst(curvature, f.curvature, table.number(i, "d2value_dx2"));
    worst(quick, g.value, f.value);
    worst(quick_slope, g.slope, f.slope);
  }
  EXPECT_EQ(used, table.rows.size());
  EXPECT_LT(value, 1e-9);
  EXPECT_LT(slope, 1e-9);
  EXPECT_LT(curvature, 1e-9);
  EXPECT_LT(quick, 1e-12);
  EXPECT_LT(quick_slope, 1e-10);
  RecordProperty("value", fmt::format("{:.2g}", value));
  fmt::print("b3: value {:.2g}, slope {:.2g}, curvature {:.2g}; table {:.2g}, its slope {:.2g}\n", value, slope,
             curvature, quick, quick_slope);
}

TEST(Millard2012, VelocityIsTheInverseOfForce) {
  expect_velocity_inverts_force(Millard2012(), 0.1, 2.0);
  expect_velocity_inverts_force(Millard2012(), 0.001, 0.99);
  expect_velocity_inverts_force(Millard2012({}, false), 0.0, 1.5);
}

TEST(Millard2012, SlopesAndEnergiesBelongToTheForces) {
  expect_consistent(Millard2012());
  expect_consistent(Millard2012({}, false));
}

}  // namespace
}  // namespace veridyn::muscle
