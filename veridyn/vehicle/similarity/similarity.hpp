#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/numerics/dimensional_analysis.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

namespace veridyn::vehicle {

/// A quantity on which the motion of a vehicle depends, with its value.
struct SimilarityParameter {
  std::string name;       ///< as in studies: "C_f"
  std::string symbol;     ///< as in formulas: "C_f"; the name when it is empty
  double value = 0.0;     ///< SI
  Unit unit;              ///< SI
  std::string affects{};  ///< which part of the behaviour, in words
};

/// A vehicle driven at a speed on a planet, and whatever else the user finds relevant.
struct SimilaritySubject {
  VehicleParameters<double> parameters;
  double speed = 20.0;                         ///< u [m/s]
  double gravity = kGravity;                   ///< g [m/s^2]
  std::optional<double> steer{};               ///< amplitude of the manoeuvre [rad]; no group of it when absent
  std::vector<SimilarityParameter> further{};  ///< given by the user; names must be new
};

/// All quantities of a subject: the numbers of `kVehicleFields` (mu only where it is finite), wheelbase L = a + b,
/// speed u, gravity g, steer delta, then `further`. Symbols: m, M_w, W_f, W_r, c for mass, unsprung_mass, track_f,
/// track_r, cg_height; otherwise the names. With L both a/L and b/L are listed though their sum is 1: a mismatch shows
/// at the axle that has it.
/// @throws InputError naming a number that no vehicle has, a speed or gravity that is not > 0, or a name of `further`
/// that is taken or has no finite value.
[[nodiscard]] std::vector<SimilarityParameter> similarity_parameters(const SimilaritySubject& subject);

/// The repeating variables by default: "m", "L", "u".
[[nodiscard]] std::span<const std::string> default_repeating_variables();

/// A dimensionless group with its value.
struct SimilarityGroup {
  std::string parameter;                      ///< name of the quantity it is about
  std::string formula;                        ///< "C_f L/(m u^2)"
  std::vector<numerics::Fraction> exponents;  ///< of the repeating variables
  double value = 0.0;
};
/// @throws InputError as `similarity_parameters` and `numerics::pi_groups`.
[[nodiscard]] std::vector<SimilarityGroup> similarity_groups(
    const SimilaritySubject& subject, std::span<const std::string> repeating = default_repeating_variables());

/// By what a quantity of the model is obtained from that of the prototype.
struct ScaleFactors {
  double length = 1.0;
  double mass = 1.0;
  double speed = 1.0;

  /// Model over prototype, as the three above.
  [[nodiscard]] double time() const { return length / speed; }
  [[nodiscard]] double acceleration() const { return speed * speed / length; }
  [[nodiscard]] double force() const { return mass * acceleration(); }
  /// Of any unit made of m, kg and s; angles are unchanged. @throws InputError for temperatures and currents.
  [[nodiscard]] double of(const Unit& unit) const;
  [[nodiscard]] double of(std::string_view unit) const { return of(parse_unit(unit)); }
  /// From the model back to the prototype.
  [[nodiscard]] ScaleFactors inverse() const { return {1.0 / length, 1.0 / mass, 1.0 / speed}; }
};
/// Wheelbase, mass and speed of the model over those of the prototype.
[[nodiscard]] ScaleFactors scale_factors(const SimilaritySubject& prototype, const SimilaritySubject& model);

/// What a scaled vehicle should have; at least one of the three.
struct ScaleRequest {
  std::optional<double> length_ratio{};  ///< model/prototype: 0.2 for 1:5; by default the cube root of the mass ratio,
                                         ///< or with speed alone what keeps the time axis (Froude: (speed ratio)^2)
  std::optional<double> mass{};          ///< of the model [kg]; by default length_ratio^3: same density
  std::optional<double> speed{};         ///< of the model [m/s]; by default length_ratio: same time axis
  /// Speed scales by sqrt(length_ratio) by default: then gravity scales as well, while time shrinks by the same root.
  bool froude = false;

  /// Of the table `[scale]`.
  [[nodiscard]] static const KeyTable<ScaleRequest>& keys();
};

/// A dynamically similar vehicle of another size.
struct ScaledVehicle {
  SimilaritySubject model;
  ScaleFactors factors;
  /// The gravity under which even loads, lift-off and the friction limit would be similar [m/s^2]; that of the
  /// prototype for a Froude twin. `model.gravity` is that of the prototype: one cannot build another.
  double similar_gravity = kGravity;
  std::vector<std::string> chosen{};  ///< which of the three ratios were not given and how they were chosen, in words
};
/// The exactly similar vehicle: every number times the factor of its unit, also those of `further`.
/// @throws InputError when nothing is given or a ratio, mass or speed is not > 0 and finite.
[[nodiscard]] ScaledVehicle scale(const SimilaritySubject& prototype, const ScaleRequest& request);

/// Every number of the vehicle times the factor of its unit.
[[nodiscard]] VehicleParameters<double> scaled(const VehicleParameters<double>& parameters,
                                               const ScaleFactors& factors);
/// A motion in the lengths, times and forces of the other size: with `factors.inverse()` the model's, to be laid over
/// the prototype's.
[[nodiscard]] VehicleTrajectory scaled(const VehicleTrajectory& trajectory, const ScaleFactors& factors);

/// One row of the table of groups.
struct GroupComparison {
  std::string parameter;
  std::string formula;
  double prototype = 0.0;
  double model = 0.0;
  double mismatch_percent = 0.0;  ///< (model/prototype - 1) 100; infinite where only one of them is 0 or infinite
  std::string affects;            ///< which dimension of the behaviour suffers
};

/// A number of the behaviour of both, in the prototype's scale.
struct BehaviourComparison {
  std::string name;
  std::string unit;
  double prototype = 0.0;
  double model = 0.0;  ///< scaled to the prototype's size
  double change_percent = 0.0;
};

/// How similar two vehicles are.
struct SimilarityReport {
  ScaleFactors factors;  ///< model over prototype
  std::vector<std::string> repeating;
  std::size_t parameters = 0, rank = 0;  ///< groups = parameters - rank
  std::vector<GroupComparison> groups;   ///< all but gravity
  /// g L/u^2, reported separately: it is the one group that building a model of other size at equal times cannot keep.
  GroupComparison gravity;
  /// What a mismatch of gravity changes, in sentences with figures; empty when it is within the tolerance.
  std::vector<std::string> gravity_changes;
  /// What the mismatches do to the response: understeer gradient, yaw response, ride frequencies and the like.
  std::vector<BehaviourComparison> behaviour;
  double tolerance_percent = 0.1;

  /// Groups whose mismatch is above the tolerance, largest first.
  [[nodiscard]] std::vector<GroupComparison> mismatches() const;
  /// All groups but gravity are within the tolerance: motions that do not depend on weight are similar.
  [[nodiscard]] bool similar_without_gravity() const;
  /// All groups, gravity too, are within the tolerance.
  [[nodiscard]] bool similar() const;
  /// One sentence.
  [[nodiscard]] std::string message() const;
};
/// Quantities that only one of the two has (mu, those of `further`) make a group with an infinite mismatch.
/// @throws InputError as `similarity_groups`.
[[nodiscard]] SimilarityReport compare(const SimilaritySubject& prototype, const SimilaritySubject& model,
                                       std::span<const std::string> repeating = default_repeating_variables(),
                                       double tolerance_percent = 0.1);

/// Reads `[[scale.parameter]]`: name, value (a number with unit as text, or plain with `unit`), symbol, affects.
[[nodiscard]] std::vector<SimilarityParameter> read_similarity_parameters(const StudyTable& scale);

namespace internal {

/// As the public functions, but mu may be infinite when it is `with_friction`, and with the rank.
[[nodiscard]] std::vector<SimilarityParameter> similarity_parameters(const SimilaritySubject& subject,
                                                                     bool with_friction);
/// Groups, and the rank of the dimensional matrix.
struct RankedGroups {
  std::vector<SimilarityGroup> groups;
  std::size_t rank = 0;
};
[[nodiscard]] RankedGroups similarity_groups(const std::vector<SimilarityParameter>& parameters,
                                             std::span<const std::string> repeating);

}  // namespace internal

}  // namespace veridyn::vehicle
