#pragma once

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

/// What the curves of every kind of muscle have to keep. Printed numbers: an independent implementation of the
/// published equations in Python, and OpenSim 4.5.2 where named.
namespace veridyn::muscle {

struct Point {
  double x, y;
};

template <std::size_t n, typename Function>
void expect_points(const std::array<Point, n>& points, const Function& f, double relative) {
  for (const Point& p : points) EXPECT_NEAR(f(p.x), p.y, relative * std::max(std::abs(p.y), 1e-3)) << "at " << p.x;
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

// Slopes against automatic differentiation of the values, energies against quadrature of the forces.
template <typename Curves>
void expect_consistent(const Curves& c) {
  using Jet1 = ceres::Jet<double, 1>;
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
    const Jet1 x(l, 0);
    EXPECT_NEAR(c.active(l).value, c.active_length(l), 1e-14);
    EXPECT_NEAR(c.active(l).slope, c.active_length(x).v[0], 1e-12) << l;
    EXPECT_NEAR(c.passive(l).value, c.passive_force(l), 1e-14);
    EXPECT_NEAR(c.passive(l).slope, c.passive_force(x).v[0], 1e-11) << l;
    const double step = 1e-6;
    EXPECT_NEAR((c.active_length(l + step) - c.active_length(l - step)) / (2.0 * step), c.active(l).slope, 1e-8) << l;
  }
  for (double s = 0.9803; s < 1.08; s += 0.0017) {
    EXPECT_NEAR(c.tendon(s).value, c.tendon_force(s), 1e-13);
    EXPECT_NEAR(c.tendon(s).slope, c.tendon_force(Jet1(s, 0)).v[0], 1e-10) << s;
  }
  const auto tendon = [&](double s) { return c.tendon_force(s); };
  const auto passive = [&](double l) { return c.passive_force(l); };
  EXPECT_NEAR(c.tendon_energy(1.06) - c.tendon_energy(1.003), simpson(tendon, 1.003, 1.06), 1e-9);
  EXPECT_NEAR(c.passive_energy(1.71) - c.passive_energy(0.9), simpson(passive, 0.9, 1.71), 1e-8);
  EXPECT_NEAR(c.passive_energy(1.3) - c.passive_energy(1.1), simpson(passive, 1.1, 1.3), 1e-11);
}

}  // namespace veridyn::muscle
