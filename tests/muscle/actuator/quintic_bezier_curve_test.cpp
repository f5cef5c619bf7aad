#include "veridyn/muscle/actuator/quintic_bezier_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/actuator/millard2012.hpp"

namespace veridyn::muscle {
namespace {

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
