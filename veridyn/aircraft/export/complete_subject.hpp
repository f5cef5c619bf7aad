#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/export/flight_condition.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::aircraft {

/// Where a number of an exported aircraft is from.
enum class ValueOrigin {
  kFlight,    ///< identified
  kStudy,     ///< stated by the study, or of the built-in aircraft that it names
  kHandbook,  ///< estimated from the geometry: see `handbook_value`
  kZero,      ///< not known, and no simple method gives it
};
inline constexpr std::size_t kValueOrigins = 4;  ///< values of ValueOrigin
/// "the flight", "the study", "an estimate", "left zero".
inline constexpr EnumArray<ValueOrigin, std::string_view, kValueOrigins> kValueOriginNames{
    {"the flight", "the study", "an estimate", "left zero"}};

/// A number of the exported aircraft and where it is from.
struct SourcedValue {
  std::string name;  ///< parameter ("CL_alpha"), "inertia", "thrust at full throttle"
  double value = 0.0;
  ValueOrigin origin = ValueOrigin::kZero;
  /// For people, in the file: "identified, 95 %: 3.1 to 4.2", "estimate: DATCOM ...".
  std::string text;
  bool parameter = true;  ///< of the aerodynamic model
};

/// An aircraft that a simulator can fly.
struct CompletedSubject {
  Subject subject;                   ///< each parameter has a value; with inertia and an engine, without downwash lag
  std::vector<SourcedValue> values;  ///< of the model in its order, then inertia and thrust
  ExportCondition condition;

  /// Whether nothing is an estimate or left zero.
  [[nodiscard]] bool all_known() const;
};

/// What is known of an aircraft, made complete:
/// - a coefficient of which every value is known stays as it is;
/// - of another one, what is missing is the study's value, else the handbook's, else zero, and terms that every
///   aircraft has (`handbook_terms`) are added, but none of a surface that its axis does nowhere use;
/// - without inertia: of the handbook, and moments that were identified per unit of inertia ("Cl/Jx_p") are multiplied
///   by it, so that the body turns as it was measured to;
/// - without an engine: thrust proportional to throttle, in level flight at the condition half of the full one.
/// @param known  the study's subject with the identified values, unknown where there are none
/// @param study  as the study states it
/// @param estimate  what the identified values are from; null: `known` is the study's
/// @throws InputError where no coefficient of the model has a value: that would not be this aircraft at all
[[nodiscard]] CompletedSubject complete_subject(const Subject& known, const Subject& study,
                                                const estimation::Estimate* estimate, const ExportCondition& condition);

/// What was taken from where, a line for each origin that occurs: how many numbers, and which. A coefficient that is
/// identified or stated as a whole is named as one.
[[nodiscard]] std::vector<std::string> origin_lines(const CompletedSubject& completed);

}  // namespace veridyn::aircraft
