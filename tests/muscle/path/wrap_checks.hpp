#pragma once

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "veridyn/muscle/path/wrap_result.hpp"

/// Checks that every wrap object has to pass.
namespace veridyn::muscle::test {

inline Eigen::Vector3d random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> u(-size, size);
  const double x = u(random), y = u(random);
  return {x, y, u(random)};
}

/// Gradients against differences of lengths, and the gradients of Jets against differences of gradients.
template <typename Object>
void expect_derivatives(const Object& object, double size, double gradient_tolerance, double curvature_tolerance,
                        int at_least = 200) {
  std::mt19937 random(7);
  int wraps = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d p = random_point(random, 2.5 * size), q = random_point(random, 2.5 * size);
    const WrapResult<double> r = wrap(object, p, q);
    if (!r.wrapped() || r.weight < 1.0 || r.spread < 0.2) continue;
    // Next to the surface lengths bend too sharply for differences of this step.
    if ((r.r1 - p).norm() < 0.3 * size || (r.r2 - q).norm() < 0.3 * size) continue;
    using Jet = ceres::Jet<double, 6>;
    Eigen::Matrix<Jet, 3, 1> pj, qj;
    for (int k = 0; k < 3; ++k) {
      pj[k] = Jet(p[k], k);
      qj[k] = Jet(q[k], 3 + k);
    }
    const WrapResult<Jet> rj = wrap(object, pj, qj);
    const double h = 1e-6 * size;
    bool smooth = true;
    for (int k = 0; k < 6 && smooth; ++k) {
      Eigen::Vector3d p1 = p, p2 = p, q1 = q, q2 = q;
      (k < 3 ? p1[k] : q1[k - 3]) += h;
      (k < 3 ? p2[k] : q2[k - 3]) -= h;
      const WrapResult<double> r1 = wrap(object, p1, q1), r2 = wrap(object, p2, q2);
      smooth = r1.wrapped() && r2.wrapped();
      if (!smooth) break;
      const double gradient = k < 3 ? r.gradient_p[k] : r.gradient_q[k - 3];
      EXPECT_NEAR((r1.length - r2.length) / (2.0 * h), gradient, gradient_tolerance)
          << p.transpose() << " | " << q.transpose();
      EXPECT_NEAR(rj.length.v[k], gradient, gradient_tolerance);
      for (int m = 0; m < 3; ++m) {
        const double difference = (r1.gradient_p[m] - r2.gradient_p[m]) / (2.0 * h) * size;
        EXPECT_NEAR(rj.gradient_p[m].v[k] * size, difference, curvature_tolerance * (1.0 + std::abs(difference)));
      }
    }
    wraps += smooth ? 1 : 0;
  }
  EXPECT_GT(wraps, at_least);
}

}  // namespace veridyn::muscle::test
