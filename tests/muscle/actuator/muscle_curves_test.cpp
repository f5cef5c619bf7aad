// Printed numbers: an independent implementation of the published equations in Python, and OpenSim 4.5.2 where named.
#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "tests/muscle/arm26_muscles.hpp"
#include "tests/muscle/reference_table.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/actuator/degroote_fregly2016.hpp"
#include "veridyn/muscle/actuator/millard2012.hpp"
#include "veridyn/muscle/actuator/thelen2003.hpp"
#include "veridyn/muscle/actuator/thelen2003_deprecated.hpp"

namespace veridyn::muscle {
namespace {

struct Point {
  double x, y;
};

template <std::size_t n, typename Function>
void expect_points(const std::array<Point, n>& points, const Function& f, double relative) {
  for (const Point& p : points) EXPECT_NEAR(f(p.x), p.y, relative * std::max(std::abs(p.y), 1e-3)) << "at " << p.x;
}

TEST(Thelen2003, MatchesPrintedValuesOfItsCurves) {
  const Thelen2003 defaults, arm26(arm26_thelen());
  const auto fL = [](const Thelen2003& t) { return [&](double l) { return t.active_length(l); }; };
  const auto fP = [](const Thelen2003& t) { return [&](double l) { return t.passive_force(l); }; };
  const auto fT = [](const Thelen2003& t) { return [&](double l) { return t.tendon_force(l); }; };
  expect_points(
      std::array<Point, 4>{
          {{0.5, 0.573753420737}, {0.75, 0.870324725833}, {1.2, 0.914947228730}, {1.5, 0.573753420737}}},
      fL(defaults), 2e-12);
  expect_points(
      std::array<Point, 4>{
          {{0.5, 0.606530659713}, {0.75, 0.882496902585}, {1.2, 0.923116346387}, {1.5, 0.606530659713}}},
      fL(arm26), 2e-12);
  expect_points(std::array<Point, 3>{{{0.75, 0.0}, {1.2, 0.0291323385009}, {1.5, 0.430762717870}}}, fP(defaults),
                2e-12);
  expect_points(std::array<Point, 3>{{{0.75, 0.0}, {1.2, 0.0521224686478}, {1.5, 0.504338766876}}}, fP(arm26), 2e-12);
  expect_points(std::array<Point, 5>{{{1.005, 0.0147279361341},
                                      {1.01, 0.0420009751365},
                                      {1.02, 0.186027557773},
                                      {1.033, 0.700422445583},
                                      {1.05, 1.42796793488}}},
                fT(defaults), 5e-12);
  expect_points(std::array<Point, 5>{{{1.005, 0.0191985126475},
                                      {1.01, 0.0597140020098},
                                      {1.02, 0.325653710074},
                                      {1.033, 1.0},
                                      {1.05, 1.88187332036}}},
                fT(arm26), 5e-12);
  EXPECT_NEAR(defaults.toe_strain() / 0.04, 0.60861553787588, 1e-14);
}

TEST(Thelen2003, MatchesPrintedValuesOfForceVelocity) {
  const Thelen2003 defaults, arm26(arm26_thelen());
  const auto fV = [](const Thelen2003& t, double a) {
    return [&t, a](double v) { return t.active_force(a, 1.0, v) / a; };
  };
  expect_points(std::array<Point, 4>{{{-0.2, 0.4444444444}, {-0.1, 0.6428571429}, {0.1, 1.285714286}, {0.3, 1.364125}}},
                fV(defaults, 1.0), 1e-9);
  expect_points(std::array<Point, 4>{{{-0.2, 0.48}, {-0.1, 0.675}, {0.1, 1.416}, {0.3, 1.611764706}}}, fV(arm26, 1.0),
                1e-9);
  expect_points(std::array<Point, 4>{{{-0.2, 0.2982456140}, {-0.1, 0.5121951220}, {0.1, 1.32}, {0.3, 1.41925}}},
                fV(defaults, 0.5), 1e-9);
  expect_points(
      std::array<Point, 4>{{{-0.2, 0.3290322581}, {-0.1, 0.5478260870}, {0.1, 1.507317073}, {0.3, 1.670967742}}},
      fV(arm26, 0.5), 1e-9);
}

// Forward and inverse force-velocity relation of every kind of muscle; damping only where it is part of the balance.
template <typename Curves>
void expect_velocity_inverts_force(const Curves& c, double damping, double most) {
  for (const double a : {0.01, 0.2, 1.0})
    for (const double fL : {0.1, 0.8, 1.0})
      for (double v = -most; v <= most; v += 0.0371) {
        const double F = c.active_force(a, fL, v) + damping * v;
        EXPECT_NEAR(c.velocity(a, fL, F, damping), v, 1e-10) << a << " " << fL;
      }
}

TEST(MuscleCurves, VelocityIsTheInverseOfForce) {
  expect_velocity_inverts_force(Thelen2003(arm26_thelen()), 0.0, 3.0);
  expect_velocity_inverts_force(Thelen2003Deprecated(), 0.0, 3.0);
  expect_velocity_inverts_force(Millard2012(), 0.1, 2.0);
  expect_velocity_inverts_force(Millard2012(), 0.001, 0.99);
  expect_velocity_inverts_force(Millard2012({}, false), 0.0, 1.5);
  expect_velocity_inverts_force(DeGrooteFregly2016(), 0.0, 1.0);
  expect_velocity_inverts_force(DeGrooteFregly2016(), 0.05, 2.0);
}

TEST(Thelen2003Deprecated, DiffersFromThelen2003InItsFiveKnownWays) {
  const Thelen2003Deprecated old;
  const Thelen2003 now(arm26_thelen());
  // The tendon: slope 1.712/e0 beyond a toe of force 1/3 at 0.609 e0, 0.001 of the length at all lengths.
  EXPECT_NEAR(old.tendon_force(0.9), 0.0009, 1e-16);
  const double toe = 1.0 + 0.609 * 0.033;
  EXPECT_NEAR(old.tendon_force(toe), 1.0 / 3.0 + 0.001 * toe, 1e-14);
  EXPECT_NEAR(old.tendon_force(1.05), 1.0 / 3.0 + 1.712 / 0.033 * (1.05 - toe) + 0.00105, 1e-13);
  // Passive force is e^-k at l = 1 and goes on straight after its strain.
  EXPECT_NEAR(old.passive_force(1.0), 0.018315638888734, 1e-14);
  EXPECT_NEAR(old.passive_force(1.6), 1.0, 1e-14);
  EXPECT_NEAR(old.passive_force(1.9), 1.0 + 4.0 / 0.6 * 0.3, 1e-13);
  EXPECT_EQ(old.active_length(1.23), now.active_length(1.23));
  // v = (F - A)/(b + 0.05), with speeds of Vmax0 + a (Vmax - Vmax0).
  const double a = 0.6, fL = 0.9, A = a * fL;
  EXPECT_NEAR(old.velocity(a, fL, 0.3, 0.0), (0.3 - A) / (A + 0.3 / 0.3 + 0.05), 1e-15);
  EXPECT_NEAR(old.velocity(a, fL, 0.7, 0.0), (0.7 - A) / ((2.0 + 2.0 / 0.3) * (A * 1.8 - 0.7) / 0.8 + 0.05), 1e-14);
  EXPECT_NEAR(old.velocity_unit(a, 10.0), 8.0, 1e-15);
  EXPECT_NEAR(old.activation_rate(1.0, 0.1, 0.01, 0.04), 90.0, 1e-12);
  EXPECT_NEAR(old.activation_rate(0.0, 0.1, 0.01, 0.04), -2.5, 1e-12);
}

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

TEST(DeGrooteFregly2016, MatchesPrintedValues) {
  const DeGrooteFregly2016 c;
  EXPECT_NEAR(c.active_length(0.8), 0.836439566115, 1e-12);
  EXPECT_NEAR(c.active_length(1.2), 0.793689718066, 1e-12);
  EXPECT_NEAR(c.active_length(1.0), 1.0, 1e-14);
  EXPECT_NEAR(c.passive_force(1.0), 0.0182288238201, 1e-13);
  EXPECT_NEAR(c.passive_force(1.5), 0.513374088169, 1e-12);
  EXPECT_NEAR(c.passive_force(0.2), 0.0, 1e-16);
  EXPECT_NEAR(c.tendon_force(1.02), 0.215568624601, 1e-12);
  EXPECT_NEAR(c.tendon_force(1.049), 1.0, 1e-13);
  EXPECT_NEAR(c.tendon_force(1.0), 0.0, 1e-16);
  EXPECT_NEAR(c.force_velocity(-0.5), 0.234036393549, 1e-12);
  EXPECT_NEAR(c.force_velocity(0.0), 1.0, 1e-14);
  EXPECT_NEAR(c.force_velocity(0.5), 1.58842340125, 1e-11);
  EXPECT_NEAR(c.force_velocity(1.0), 1.79434296356, 1e-11);
}

TEST(ActivationDynamics, MatchesPrintedRates) {
  struct Row {
    double u, a, fast, slow, smooth, sharp;
  };
  for (const Row& r : {Row{1.0, 0.1, 138.461538462, 92.3076923077, 54.7339439415, 92.3076910503},
                       Row{0.5, 0.2, 37.5, 25.0, 14.814905534, 24.9480749137},
                       Row{0.1, 0.5, -12.5, -10.0, -14.5734719113, -8.33769288503}}) {
    EXPECT_NEAR(activation_rate(r.u, r.a, 0.010, 0.040), r.fast, 1e-8);
    EXPECT_NEAR(activation_rate(r.u, r.a, 0.015, 0.050), r.slow, 1e-8);
    EXPECT_NEAR(smooth_activation_rate(r.u, r.a, 0.015, 0.060, 0.1), r.smooth, 1e-8);
    EXPECT_NEAR(smooth_activation_rate(r.u, r.a, 0.015, 0.060, 10.0), r.sharp, 1e-8);
  }
  EXPECT_NEAR(activation_rate(0.0, 1.0, 0.010, 0.040), -50.0, 1e-12);
  EXPECT_NEAR(smooth_activation_rate(0.0, 1.0, 0.015, 0.060, 0.1), -33.3333333333, 1e-9);
}

// Slopes against automatic differentiation of the values, energies against quadrature of the forces.
template <typename Curves>
void expect_consistent(const Curves& c) {
  using Jet = ceres::Jet<double, 1>;
  const auto simpson = [](const auto& f, double from, double to) {
    double sum = 0.0;
    const int n = 4000;
    const double h = (to - from) / n;
    for (int i = 0; i < n; ++i) {
      const double x = from + i * h;
      sum += h / 6.0 * (f(x) + 4.0 * f(x + 0.5 * h) + f(x + h));
    }
    return sum;
  };
  for (double l = 0.4537; l < 1.95; l += 0.0131) {
    const Jet x(l, 0);
    EXPECT_NEAR(c.active(l).value, c.active_length(l), 1e-14);
    EXPECT_NEAR(c.active(l).slope, c.active_length(x).v[0], 1e-12) << l;
    EXPECT_NEAR(c.passive(l).value, c.passive_force(l), 1e-14);
    EXPECT_NEAR(c.passive(l).slope, c.passive_force(x).v[0], 1e-11) << l;
    const double step = 1e-6;
    EXPECT_NEAR((c.active_length(l + step) - c.active_length(l - step)) / (2.0 * step), c.active(l).slope, 1e-8) << l;
  }
  for (double s = 0.9803; s < 1.08; s += 0.0017) {
    EXPECT_NEAR(c.tendon(s).value, c.tendon_force(s), 1e-13);
    EXPECT_NEAR(c.tendon(s).slope, c.tendon_force(Jet(s, 0)).v[0], 1e-10) << s;
  }
  const auto tendon = [&](double s) { return c.tendon_force(s); };
  const auto passive = [&](double l) { return c.passive_force(l); };
  EXPECT_NEAR(c.tendon_energy(1.06) - c.tendon_energy(1.003), simpson(tendon, 1.003, 1.06), 1e-9);
  EXPECT_NEAR(c.passive_energy(1.71) - c.passive_energy(0.9), simpson(passive, 0.9, 1.71), 1e-8);
  EXPECT_NEAR(c.passive_energy(1.3) - c.passive_energy(1.1), simpson(passive, 1.1, 1.3), 1e-11);
}

TEST(MuscleCurves, SlopesAndEnergiesBelongToTheirForces) {
  expect_consistent(Thelen2003());
  expect_consistent(Thelen2003(arm26_thelen()));
  expect_consistent(Thelen2003Deprecated());
  expect_consistent(Millard2012());
  expect_consistent(Millard2012({}, false));
  expect_consistent(DeGrooteFregly2016());
}

TEST(QuinticBezierCurve, TableFollowsTheExactCurveForManyShapes) {
  std::mt19937_64 generator(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  double worst = 0.0;
  for (int i = 0; i < 5; ++i) {
    MillardCurves shape;
    shape.min_norm_active_fiber_length = 0.3 + 0.2 * uniform(generator);
    shape.transition_norm_fiber_length = 0.65 + 0.1 * uniform(generator);
    shape.max_norm_active_fiber_length = 1.5 + 0.5 * uniform(generator);
    shape.tendon_strain_at_one_norm_force = 0.02 + 0.1 * uniform(generator);
    shape.strain_at_one_norm_force = 0.3 + 0.7 * uniform(generator);
    shape.concentric_curviness = uniform(generator);
    shape.eccentric_curviness = uniform(generator);
    shape.fiber_curviness = uniform(generator);
    const Millard2012 m(shape, i % 2 == 0);
    for (const QuinticBezierCurve* curve :
         {&m.active_curve(), &m.passive_curve(), &m.tendon_curve(), &m.velocity_curve(), &m.inverse_velocity_curve()}) {
      EXPECT_LT(curve->table_error(), 1e-12);
      for (int k = 0; k < 300; ++k) {
        const double x = curve->begin() + (curve->end() - curve->begin()) * (1.2 * uniform(generator) - 0.1);
        const double y = curve->exact(x).value;
        worst = std::max(worst, std::abs(curve->value(x) - y) / std::max(1.0, std::abs(y)));
      }
    }
    if (!m.damped()) {
      const QuinticBezierCurve back = m.inverse_velocity_curve().inverse();
      for (const double v : {-1.3, -0.97, -0.4, 0.0, 0.2, 0.95, 1.2})
        EXPECT_NEAR(back.value(v), m.velocity_curve().value(v), 1e-13);
    }
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(QuinticBezierCurve, ShapesThatAreNoFunctionAreRefused) {
  MillardCurves shape;
  shape.tendon_stiffness_at_one_norm_force = 10.0;  // less than the mean slope to one: its toe would bend backwards
  EXPECT_THROW(Millard2012{shape}, InputError);
}

}  // namespace
}  // namespace veridyn::muscle
