#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/estimation/output_error/parametric_model.hpp"
#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/model/muscle_parameters.hpp"

namespace veridyn::muscle {

/// A parameter of a muscle: "BIClong.optimal_fiber_length".
struct MuscleParameterName {
  /// Beyond `estimable_field`: of the muscle's excitation, u(t) = gain e(t - delay).
  static constexpr std::size_t kGain = kEstimableFields, kDelay = kEstimableFields + 1;
  static constexpr std::size_t kCount = kEstimableFields + 2;

  int muscle = 0;
  std::size_t field = 0;

  [[nodiscard]] bool of_excitation() const { return field >= kEstimableFields; }
  [[nodiscard]] bool operator==(const MuscleParameterName&) const = default;
};

/// Name and unit of a field, those of the excitation included: "excitation_gain", "excitation_delay".
[[nodiscard]] MusculotendonField parameter_field(std::size_t field);

/// Bound or width of an unknown as a study states it: in the unknown's unit, or in percent of its start.
struct Extent {
  double value = 0.0;
  bool percent = false;
};

/// An unknown as a study or a program asks for it.
struct MuscleUnknownSpec {
  std::string name = {};                  ///< empty: of the only parameter, else of the first with "..."
  std::vector<std::string> muscles = {};  ///< names; "all": every muscle
  std::vector<std::string> fields = {};   ///< "max_isometric_force", ..., "excitation_delay"
  /// One factor of the model's own values for all of them, starting at 1. Else one value that all of them take.
  bool factor = false;
  std::optional<double> start = {};           ///< default: the model's value, or 1 for a factor
  std::optional<Extent> low = {}, high = {};  ///< default: 50 % below and above; of a delay -0.1 and 0.1 s
  std::optional<Extent> prior = {};           ///< standard deviation about the start; none: no prior
  bool fixed = false;
};

/// An unknown of a muscle model: one number that one or several parameters follow.
struct MuscleUnknown {
  std::string name;
  std::string unit;
  std::vector<MuscleParameterName> parameters;
  bool factor = false;  ///< parameter = unknown x the model's value; else parameter = unknown
  double start = 0.0, low = 0.0, high = 0.0;
  double prior_sigma = 0.0;  ///< infinite: none
  bool fixed = false;

  /// Of excitations; all parameters of an unknown are then delays.
  [[nodiscard]] bool is_delay() const { return parameters.front().field == MuscleParameterName::kDelay; }
};

/// The unknown that `spec` describes. @throws InputError at `place`, in one line, naming the nearest muscle or field;
/// for bounds that cross or leave out the start, a prior that is not positive, values of several parameters that
/// differ in the model or in their units.
[[nodiscard]] MuscleUnknown make_unknown(const Model& model, const MuscleUnknownSpec& spec, std::string_view place);

/// One field of one muscle as its own unknown, within half and one and a half of the model's value.
[[nodiscard]] MuscleUnknown unknown_of(const Model& model, const MuscleParameterName& name);

/// As estimators see them.
[[nodiscard]] std::vector<estimation::ModelParameter> model_parameters(std::span<const MuscleUnknown> unknowns);

/// @throws InputError when two unknowns set the same parameter, or have the same name.
void check_unknowns(const Model& model, std::span<const MuscleUnknown> unknowns, std::string_view place);

}  // namespace veridyn::muscle
