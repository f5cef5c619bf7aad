#include "veridyn/muscle/actuator/millard2012.hpp"

namespace veridyn::muscle {
namespace {

// A value below zero stands for the one that is derived from the others.
double given_or(double value, double derived) { return value < 0.0 ? derived : value; }

QuinticBezierCurve active_curve(const MillardCurves& c, double minimum) {
  const double x0 = c.min_norm_active_fiber_length, x1 = c.transition_norm_fiber_length, x2 = 1.0;
  const double x3 = c.max_norm_active_fiber_length, slope = c.shallow_ascending_slope, plateau = 0.05 * x2;
  const double xs = x2 - plateau, y1 = 1.0 - slope * (xs - x1), steep = 1.25 * y1 / (x1 - x0);
  const double x01 = x0 + 0.5 * (x1 - x0), y01 = 0.5 * y1;
  const double x1s = x1 + 0.5 * (xs - x1), y1s = y1 + 0.5 * (1.0 - y1);
  const double x23 = x2 + plateau + 0.5 * (x3 - (x2 + plateau)), descent = -1.0 / ((x3 - plateau) - (x2 + plateau));
  return {
      {quintic_corner(x0, minimum, 0.0, x01, y01, steep, 1.0), quintic_corner(x01, y01, steep, x1s, y1s, slope, 1.0),
       quintic_corner(x1s, y1s, slope, x2, 1.0, 0.0, 1.0), quintic_corner(x2, 1.0, 0.0, x23, 0.5, descent, 1.0),
       quintic_corner(x23, 0.5, descent, x3, minimum, 0.0, 1.0)},
      0.0,
      0.0};
}

QuinticBezierCurve velocity_curve(const MillardCurves& c, double concentric_end, double eccentric_end) {
  const double f = c.max_eccentric_velocity_force_multiplier;
  const double near_c = c.concentric_slope_near_vmax, near_e = c.eccentric_slope_near_vmax;
  const double y_c = 0.05 * near_c + 0.05 * concentric_end, y_e = f - 0.05 * near_e - 0.05 * eccentric_end;
  return {{quintic_corner(-1.0, 0.0, concentric_end, -0.9, y_c, near_c, c.concentric_curviness),
           quintic_corner(-0.9, y_c, near_c, 0.0, 1.0, c.isometric_slope, c.concentric_curviness),
           quintic_corner(0.0, 1.0, c.isometric_slope, 0.9, y_e, near_e, c.eccentric_curviness),
           quintic_corner(0.9, y_e, near_e, 1.0, f, eccentric_end, c.eccentric_curviness)},
          concentric_end,
          eccentric_end};
}

QuinticBezierCurve passive_curve(const MillardCurves& c) {
  const double e0 = c.strain_at_zero_force, e1 = c.strain_at_one_norm_force;
  const double stiffness = given_or(c.stiffness_at_one_norm_force, 2.0 / (e1 - e0));
  const double low = given_or(c.stiffness_at_low_force, 0.2), curviness = given_or(c.fiber_curviness, 0.75);
  const double dx = std::min(0.1 / stiffness, 0.1 * (e1 - e0));
  const double x_low = 1.0 + e0 + dx, y_low = low * (x_low - (1.0 + e0 + 0.5 * dx));
  return {{quintic_corner(1.0 + e0, 0.0, 0.0, x_low, y_low, low, curviness),
           quintic_corner(x_low, y_low, low, 1.0 + e1, 1.0, stiffness, curviness)},
          0.0,
          stiffness};
}

QuinticBezierCurve tendon_curve(const MillardCurves& c) {
  const double e1 = c.tendon_strain_at_one_norm_force;
  const double stiffness = given_or(c.tendon_stiffness_at_one_norm_force, 1.375 / e1);
  const double toe_force = given_or(c.norm_force_at_toe_end, 2.0 / 3.0), curviness = given_or(c.tendon_curviness, 0.5);
  const double x_toe = 1.0 + e1 + (toe_force - 1.0) / stiffness, x_foot = 1.0 + (x_toe - 1.0) / 10.0;
  const double y_mid = 0.5 * toe_force, x_mid = 1.0 + e1 + (y_mid - 1.0) / stiffness;
  const double slope_mid = y_mid / (x_mid - x_foot);
  const double x_control = x_foot + 0.5 * (x_mid - x_foot), y_control = slope_mid * (x_control - x_foot);
  return {{quintic_corner(1.0, 0.0, 0.0, x_control, y_control, slope_mid, curviness),
           quintic_corner(x_control, y_control, slope_mid, x_toe, toe_force, stiffness, curviness)},
          0.0,
          stiffness};
}

}  // namespace

Millard2012::Millard2012(const MillardCurves& c, bool damped) : isometric_slope_(c.isometric_slope), damped_(damped) {
  // OpenSim: level ends when damped, an end slope of at least 0.1 on either side else.
  const bool steep = !damped && c.concentric_slope_at_vmax >= 0.1 && c.eccentric_slope_at_vmax >= 0.1;
  const double concentric = damped ? 0.0 : steep ? c.concentric_slope_at_vmax : 0.5 * c.concentric_slope_near_vmax;
  const double eccentric = damped ? 0.0 : steep ? c.eccentric_slope_at_vmax : 0.5 * c.eccentric_slope_near_vmax;
  QuinticBezierCurve velocity = veridyn::muscle::velocity_curve(c, concentric, eccentric);
  QuinticBezierCurve inverse = damped ? QuinticBezierCurve{} : velocity.inverse();
  curves_ = std::make_shared<const Curves>(Curves{
      veridyn::muscle::active_curve(c, damped ? 0.0 : std::max(0.1, c.minimum_value)),
      veridyn::muscle::passive_curve(c), veridyn::muscle::tendon_curve(c), std::move(velocity), std::move(inverse)});
}

}  // namespace veridyn::muscle
