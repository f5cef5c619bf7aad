#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/regression/structure_search.hpp"

namespace veridyn::aircraft {

/// What identification may do and what it demands of its result. Study table `[identify]`.
struct IdentifyOptions {
  std::vector<Coefficient> coefficients;          ///< empty: all that the subject models
  std::optional<estimation::Method> method = {};  ///< nothing: the regression that the comparison recommends
  bool choose_output_error = false;               ///< started at the regression, its estimate is taken
  bool refit_significant = false;
  double signal_to_noise = 1.0;
  double significance = 0.05;
  double min_holdout_r2 = estimation::kHoldOutFailed;
  double max_unmodelled = estimation::kMostUnmodelled;
  double contradiction_level = estimation::kPartsContradict;
  std::optional<estimation::StructureMethod> structure = {};  ///< nothing: the subject's terms
  /// Coefficients that have none choose among `default_candidates`.
  EnumArray<Coefficient, std::vector<Term>, kCoefficients> candidates;
  bool output_error = false;
  std::optional<bool> output_error_gusts = {};  ///< nothing: where a ground velocity is recorded
  bool output_error_biases = false;
  double frequency_low_Hz = 0.0;   ///< of the equation error in the frequency domain
  double frequency_high_Hz = 0.0;  ///< 0: none
  std::size_t bootstrap = 0;
  std::uint64_t seed = 1;  ///< of the bootstrap; the study's

  [[nodiscard]] static const KeyTable<IdentifyOptions>& keys();

  /// Whether the user chose the method.
  [[nodiscard]] bool method_fixed() const { return method.has_value() || choose_output_error; }
  /// `method` as the study has it.
  [[nodiscard]] std::string method_name() const;
};

}  // namespace veridyn::aircraft
