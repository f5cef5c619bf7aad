#include "veridyn/muscle/actuator/musculotendon.hpp"

#include <fmt/format.h>

#include <string_view>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

class Rules {
 public:
  explicit Rules(const MuscleParameters& p) : place_(fmt::format("muscle {}", p.name)) {}

  void positive(std::string_view element, double value) const {
    if (!(value > 0.0) || !std::isfinite(value)) fail(element, value, "must be > 0");
  }
  void between(std::string_view element, double value, double low, double high) const {
    if (!(value >= low && value <= high)) fail(element, value, fmt::format("must be from {:.6g} to {:.6g}", low, high));
  }
  void below(std::string_view element, double value, double high) const {
    if (!(value < high)) fail(element, value, fmt::format("must be less than {:.6g}", high));
  }

 private:
  [[noreturn]] void fail(std::string_view element, double value, std::string_view rule) const {
    throw InputError(place_, fmt::format("{} is {:.6g}; {}", element, value, rule));
  }
  std::string place_;
};

void check_curves(const Rules& r, const ThelenCurves& c) {
  r.positive("FmaxTendonStrain", c.tendon_strain);
  r.positive("FmaxMuscleStrain", c.passive_strain);
  r.positive("KshapeActive", c.active_width);
  r.positive("KshapePassive", c.passive_exponent);
  r.positive("Af", c.Af);
  r.between("Flen", c.Flen, 1.0 + 1e-6, 100.0);
  r.between("fv_linear_extrap_threshold", c.extrapolation_threshold, 1.0 / c.Flen, 1.0 - 1e-6);
}

void check_curves(const Rules& r, const DeprecatedThelenCurves& c) {
  r.positive("FmaxTendonStrain", c.tendon_strain);
  r.positive("FmaxMuscleStrain", c.passive_strain);
  r.positive("KshapeActive", c.active_width);
  r.positive("KshapePassive", c.passive_exponent);
  r.positive("Af", c.Af);
  r.between("Flen", c.Flen, 1.0 / 0.95 + 1e-6, 100.0);
  r.positive("damping", c.damping);
  r.positive("Vmax0", c.Vmax0);
}

void check_curves(const Rules& r, const MillardCurves& c) {
  r.between("min_norm_active_fiber_length", c.min_norm_active_fiber_length, 0.0, 1.0);
  r.between("transition_norm_fiber_length", c.transition_norm_fiber_length, c.min_norm_active_fiber_length, 1.0);
  r.between("max_norm_active_fiber_length", c.max_norm_active_fiber_length, 1.1, 10.0);
  r.between("minimum_value", c.minimum_value, 0.0, 1.0);
  r.between("concentric_curviness", c.concentric_curviness, 0.0, 1.0);
  r.between("eccentric_curviness", c.eccentric_curviness, 0.0, 1.0);
  r.between("isometric_slope", c.isometric_slope, 1.0 + 1e-6, 1e3);
  r.positive("concentric_slope_near_vmax", c.concentric_slope_near_vmax);
  r.positive("eccentric_slope_near_vmax", c.eccentric_slope_near_vmax);
  r.between("max_eccentric_velocity_force_multiplier", c.max_eccentric_velocity_force_multiplier, 1.0 + 1e-6, 100.0);
  r.between("strain_at_zero_force", c.strain_at_zero_force, -0.9, 10.0);
  r.between("strain_at_one_norm_force", c.strain_at_one_norm_force, c.strain_at_zero_force + 1e-6, 10.0);
  r.between("FiberForceLengthCurve curviness", std::max(0.0, c.fiber_curviness), 0.0, 1.0);
  r.positive("TendonForceLengthCurve strain_at_one_norm_force", c.tendon_strain_at_one_norm_force);
  r.between("TendonForceLengthCurve curviness", std::max(0.0, c.tendon_curviness), 0.0, 1.0);
}

void check_curves(const Rules& r, const DeGrooteFregly2016Curves& c) {
  r.positive("active_force_width_scale", c.active_force_width_scale);
  r.positive("passive_fiber_strain_at_one_norm_force", c.passive_fiber_strain_at_one_norm_force);
  r.positive("tendon_strain_at_one_norm_force", c.tendon_strain_at_one_norm_force);
  r.positive("activation smoothing", c.activation_smoothing);
}

void check_curves(const Rules& r, const SchutteCurves& c) { r.positive("damping", c.damping); }

CompiledCurves compiled(const ThelenCurves& c, const MuscleParameters&) { return Thelen2003(c); }
CompiledCurves compiled(const DeprecatedThelenCurves& c, const MuscleParameters&) { return Thelen2003Deprecated(c); }
CompiledCurves compiled(const MillardCurves& c, const MuscleParameters& p) {
  return Millard2012(c, p.rigid_tendon || p.fiber_damping >= Millard2012::kDampingThreshold);
}
CompiledCurves compiled(const DeGrooteFregly2016Curves& c, const MuscleParameters&) { return DeGrooteFregly2016(c); }
CompiledCurves compiled(const SchutteCurves& c, const MuscleParameters&) { return Schutte1993(c); }

}  // namespace

void check(const MuscleParameters& p) {
  const Rules r(p);
  const MusculotendonParameters<double>& m = p.musculotendon;
  r.positive("max_isometric_force", m.max_isometric_force);
  r.positive("optimal_fiber_length", m.optimal_fiber_length);
  r.positive("tendon_slack_length", m.tendon_slack_length);
  r.between("pennation_angle_at_optimal", m.pennation_angle_at_optimal, 0.0, p.maximum_pennation_angle);
  r.positive("max_contraction_velocity", m.max_contraction_velocity);
  r.positive("activation_time_constant", m.activation_time_constant);
  r.positive("deactivation_time_constant", m.deactivation_time_constant);
  r.between("fiber_damping", p.fiber_damping, 0.0, 1e3);
  r.between("minimum_activation", p.minimum_activation, 0.0, 1.0);
  r.positive("maximum_pennation_angle", p.maximum_pennation_angle);
  r.below("maximum_pennation_angle", p.maximum_pennation_angle, kPi / 2.0);
  std::visit([&](const auto& c) { check_curves(r, c); }, p.curves);
}

CompiledCurves compile_curves(const MuscleParameters& p) {
  try {
    return std::visit([&](const auto& c) { return compiled(c, p); }, p.curves);
  } catch (const InputError& error) {
    throw InputError(fmt::format("muscle {}", p.name), error.what());
  }
}

double minimum_norm_length(const CompiledCurves& curves) {
  return std::visit([](const auto& c) { return minimum_norm_length(c); }, curves);
}

}  // namespace veridyn::muscle
