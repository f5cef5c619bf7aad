#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/aircraft/model/downwash.hpp"
#include "veridyn/aircraft/model/propulsion.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// Inertia of an aircraft that is symmetric about its xz plane: J = [Jx 0 -Jxz; 0 Jy 0; -Jxz 0 Jz] [kg m^2], body
/// axes, about the centre of gravity.
struct Inertia {
  double Jx = 0.0, Jy = 0.0, Jz = 0.0, Jxz = 0.0;

  [[nodiscard]] Eigen::Matrix3d matrix() const;
  /// Why no body can have this inertia, empty when all is well. Two rules: the matrix is positive definite (without it
  /// the equations of motion are meaningless), and no principal moment exceeds the sum of the other two (a body of
  /// positive mass density; tables break this more often than one would think: the published Skywalker X8 does).
  [[nodiscard]] std::string inadmissible() const;
  [[nodiscard]] bool positive_definite() const;

  friend bool operator==(const Inertia&, const Inertia&) = default;
};

/// A servo with what it moves, or the engine's throttle: output follows the command through delay, first-order lag,
/// rate limit and stops, and for surfaces through the play of the linkage.
struct Actuator {
  double lower = -0.35;           ///< stop [rad]; throttle: 0
  double upper = 0.35;            ///< stop [rad]; throttle: 1
  double rate_limit = kInfinity;  ///< [rad/s]; throttle [1/s]
  double time_constant = 0.0;     ///< [s]; 0 follows at once
  double delay = 0.0;             ///< [s]
  double free_play = 0.0;         ///< what the servo moves after a reversal before the surface does [rad]

  friend bool operator==(const Actuator&, const Actuator&) = default;
};

/// Standard deviations of the aircraft's constants, as known from scales, drawings and swing tests: errors that all
/// samples share. Zero: exact. Study table `[subject.sigma]`.
struct BodySigma {
  double mass = 0.0;                               ///< [kg]
  double wing_area = 0.0;                          ///< [m^2]
  double span = 0.0, chord = 0.0;                  ///< [m]
  double Jx = 0.0, Jy = 0.0, Jz = 0.0, Jxz = 0.0;  ///< [kg m^2]

  [[nodiscard]] bool any() const { return !(*this == BodySigma{}); }
  friend bool operator==(const BodySigma&, const BodySigma&) = default;
};

/// Lengths that make moments and rates dimensionless where they are not span and chord: l = qbar S L_roll Cl,
/// p_n = L_roll p/(2 Va), and so for pitch and yaw. Study table `[subject.reference_lengths]`.
struct ReferenceLengths {
  std::optional<double> roll, pitch, yaw;  ///< [m]; without: span, chord, span

  [[nodiscard]] bool any() const { return roll || pitch || yaw; }
  friend bool operator==(const ReferenceLengths&, const ReferenceLengths&) = default;
};

/// The physical aircraft: what is measured on the bench, and its model of aerodynamics as far as known.
struct Subject {
  std::string name;
  std::string description;         ///< source of the numbers, in words
  std::string sign_convention;     ///< of deflections, in words: "positive deflection gives positive moment"
  double mass = 0.0;               ///< [kg]
  std::optional<Inertia> inertia;  ///< without it forces are identified and moments are not
  BodySigma sigma;                 ///< how well mass, geometry and inertia are known
  double wing_area = 0.0;          ///< S [m^2]
  double span = 0.0;               ///< b [m]
  double chord = 0.0;              ///< c, mean aerodynamic chord [m]
  ReferenceLengths lengths;
  std::array<double, 3> force_point = {0, 0, 0};   ///< where the aerodynamic force acts, from the centre of gravity [m]
  std::array<double, 3> imu_position = {0, 0, 0};  ///< from the centre of gravity, body axes [m]
  AeroModel model;
  Downwash downwash;
  Propulsion propulsion;
  Actuator elevator, aileron, rudder;
  Actuator throttle{.lower = 0.0, .upper = 1.0};
  std::vector<std::string> warnings;  ///< what is questionable about the numbers; not written to files

  /// Of Cl and p_n, Cm and q_n, Cn and r_n [m].
  [[nodiscard]] double roll_length() const { return lengths.roll.value_or(span); }
  [[nodiscard]] double pitch_length() const { return lengths.pitch.value_or(chord); }
  [[nodiscard]] double yaw_length() const { return lengths.yaw.value_or(span); }

  /// b^2 / S.
  [[nodiscard]] double aspect_ratio() const { return span * span / wing_area; }

  /// Equal but for `warnings`.
  friend bool operator==(const Subject& a, const Subject& b);
};

/// Study table `[subject]`: what it leaves out is as in the object, or as in the built-in subject that it names.
/// Inertia that is not positive definite is refused; one that breaks the triangle inequality is kept with a warning.
[[nodiscard]] const KeyTable<Subject>& subject_keys();
[[nodiscard]] Subject read_subject(const StudyTable& table);

/// The subject as TOML, `[subject]` and its tables, complete and without reference to a built-in one; reading it gives
/// an equal subject, to the last bit.
[[nodiscard]] std::string write_subject_toml(const Subject& subject);

}  // namespace veridyn::aircraft
