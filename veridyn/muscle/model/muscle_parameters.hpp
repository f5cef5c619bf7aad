#pragma once

#include <array>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <variant>

#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::muscle {

/// Shape of the curves of Thelen (2003). Defaults are the class defaults of OpenSim; arm26 sets all of them otherwise.
struct ThelenCurves {
  double tendon_strain = 0.04;            ///< FmaxTendonStrain, strain of the tendon at F0
  double passive_strain = 0.6;            ///< FmaxMuscleStrain, passive fibre strain at F0
  double active_width = 0.45;             ///< KshapeActive, gamma
  double passive_exponent = 5.0;          ///< KshapePassive
  double Af = 0.25;                       ///< shape of the force-velocity curve
  double Flen = 1.4;                      ///< greatest force of a lengthening fibre, of F0
  double extrapolation_threshold = 0.95;  ///< fv_linear_extrap_threshold
};

/// The form of OpenSim <= 2 (`Thelen2003Muscle_Deprecated`): constant time constants, damping, an older tendon.
struct DeprecatedThelenCurves {
  double tendon_strain = 0.033;
  double passive_strain = 0.6;
  double active_width = 0.5;
  double passive_exponent = 4.0;
  double Af = 0.3;
  double Flen = 1.8;
  double damping = 0.05;
  double Vmax0 = 5.0;  ///< greatest shortening speed at zero activation [L0/s]
};

/// Corner values of the curves of Millard et al. (2013) as OpenSim's four curve classes name them.
struct MillardCurves {
  // ActiveForceLengthCurve
  double min_norm_active_fiber_length = 0.4441;
  double transition_norm_fiber_length = 0.73;
  double max_norm_active_fiber_length = 1.8123;
  double shallow_ascending_slope = 0.8616;
  double minimum_value = 0.1;  ///< used by the undamped form only; 0 when damped
  // ForceVelocityCurve
  double concentric_slope_at_vmax = 0.0;
  double concentric_slope_near_vmax = 0.25;
  double isometric_slope = 5.0;
  double eccentric_slope_at_vmax = 0.0;
  double eccentric_slope_near_vmax = 0.15;
  double max_eccentric_velocity_force_multiplier = 1.4;
  double concentric_curviness = 0.6;
  double eccentric_curviness = 0.9;
  // FiberForceLengthCurve; a value < 0 stands for "derived from the strains"
  double strain_at_zero_force = 0.0;
  double strain_at_one_norm_force = 0.7;
  double stiffness_at_low_force = -1.0;
  double stiffness_at_one_norm_force = -1.0;
  double fiber_curviness = -1.0;
  // TendonForceLengthCurve
  double tendon_strain_at_one_norm_force = 0.049;
  double tendon_stiffness_at_one_norm_force = -1.0;
  double norm_force_at_toe_end = -1.0;
  double tendon_curviness = -1.0;

  [[nodiscard]] bool operator==(const MillardCurves&) const = default;
};

/// De Groote et al. (2016) as OpenSim adjusts it.
struct DeGrooteFregly2016Curves {
  double active_force_width_scale = 1.0;
  double passive_fiber_strain_at_one_norm_force = 0.6;
  double tendon_strain_at_one_norm_force = 0.049;
  bool ignore_passive_fiber_force = false;
  double activation_smoothing = 0.1;  ///< b of the activation law's tanh
};

/// Schutte et al. (1993) as OpenSim has it (`Schutte1993Muscle_Deprecated`): curves by splines.
struct SchutteCurves {
  /// Force over strain, and active force over length [L0]: OpenSim's own where the file gives none.
  numerics::PiecewisePolynomial tendon = default_tendon();
  numerics::PiecewisePolynomial active = default_active();
  std::optional<numerics::PiecewisePolynomial> passive;  ///< over length [L0]; none: exponential
  double damping = 0.1;                                  ///< of F0 per L0/time_scale

  [[nodiscard]] static numerics::PiecewisePolynomial default_tendon();
  [[nodiscard]] static numerics::PiecewisePolynomial default_active();
};

/// Curves of a muscle by the model that they belong to.
using MuscleCurves =
    std::variant<ThelenCurves, DeprecatedThelenCurves, MillardCurves, DeGrooteFregly2016Curves, SchutteCurves>;

/// The parameters of one musculotendon unit that can be estimated; a template, so that automatic differentiation gives
/// derivatives with respect to them.
template <typename Scalar>
struct MusculotendonParameters {
  Scalar max_isometric_force{1000.0};        ///< F0 [N]
  Scalar optimal_fiber_length{0.1};          ///< L0 [m]
  Scalar tendon_slack_length{0.2};           ///< LS [m]
  Scalar pennation_angle_at_optimal{0.0};    ///< phi0 [rad]
  Scalar max_contraction_velocity{10.0};     ///< Vmax [L0/s]
  Scalar activation_time_constant{0.015};    ///< [s]
  Scalar deactivation_time_constant{0.050};  ///< [s]
  /// Strains of the tendon's curve in units of the model's: 1.1 means 10 % more strain at F0. All curves here depend on
  /// the strain over that at F0 only, so that this is the class's own strain at F0, relative to the model's.
  Scalar tendon_strain_factor{1.0};

  template <typename Other>
  [[nodiscard]] MusculotendonParameters<Other> cast() const {
    return {Other(max_isometric_force),        Other(optimal_fiber_length),     Other(tendon_slack_length),
            Other(pennation_angle_at_optimal), Other(max_contraction_velocity), Other(activation_time_constant),
            Other(deactivation_time_constant), Other(tendon_strain_factor)};
  }
};

/// A number of `MusculotendonParameters` as OpenSim's files, studies and estimates name it.
struct MusculotendonField {
  const char* name;
  const char* unit;
};
/// All of them, in the order of the struct.
inline constexpr std::array<MusculotendonField, 7> kMusculotendonFields{{{"max_isometric_force", "N"},
                                                                         {"optimal_fiber_length", "m"},
                                                                         {"tendon_slack_length", "m"},
                                                                         {"pennation_angle_at_optimal", "rad"},
                                                                         {"max_contraction_velocity", "1/s"},
                                                                         {"activation_time_constant", "s"},
                                                                         {"deactivation_time_constant", "s"}}};

/// Numbers that can be estimated: those, and the tendon's strain factor, which files give as a curve's strain.
inline constexpr std::size_t kEstimableFields = kMusculotendonFields.size() + 1;
/// One of them. Throws nothing; `field` must be below `kEstimableFields`.
[[nodiscard]] constexpr MusculotendonField estimable_field(std::size_t field) {
  return field < kMusculotendonFields.size() ? kMusculotendonFields[field]
                                             : MusculotendonField{"tendon_strain_factor", "1"};
}

/// The number that `estimable_field(field)` names.
template <typename Scalar>
[[nodiscard]] Scalar& field_of(MusculotendonParameters<Scalar>& p, std::size_t field) {
  Scalar* const fields[] = {&p.max_isometric_force,        &p.optimal_fiber_length,     &p.tendon_slack_length,
                            &p.pennation_angle_at_optimal, &p.max_contraction_velocity, &p.activation_time_constant,
                            &p.deactivation_time_constant, &p.tendon_strain_factor};
  return *fields[field];
}
/// A parameter by its place in the list of fields.
template <typename Scalar>
[[nodiscard]] const Scalar& field_of(const MusculotendonParameters<Scalar>& p, std::size_t field) {
  return field_of(const_cast<MusculotendonParameters<Scalar>&>(p), field);
}

/// One muscle as a file describes it, without its path.
struct MuscleParameters {
  std::string name;
  MusculotendonParameters<double> musculotendon;
  MuscleCurves curves;
  double fiber_damping = 0.0;  ///< beta, of F0 per Vmax L0 (Millard, De Groote)
  double minimum_activation = 0.01;
  double maximum_pennation_angle = 1.4706289056333368;  ///< acos(0.1) [rad]
  double default_activation = 0.05;
  double default_fiber_length = 0.1;  ///< [m]
  double min_control = 0.01;
  double max_control = 1.0;
  bool rigid_tendon = false;                ///< ignore_tendon_compliance
  bool ignore_activation_dynamics = false;  ///< activation = excitation
};

}  // namespace veridyn::muscle
