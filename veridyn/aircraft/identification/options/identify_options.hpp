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
  std::vector<Coefficient> coefficients;  ///< `coefficients = ["CL", "Cm"]`; empty: all that the subject models
  /// `method`: "auto" (nothing) takes the regression that the comparison recommends; "OLS", "TLS", "GTLS", "PCA-GTLS"
  /// fixes it.
  std::optional<estimation::Method> method = {};
  bool choose_output_error = false;  ///< `method = "output error"`: started at the regression, its estimate is taken
  bool refit_significant = false;    ///< `refit_significant`: drop what fails its t-test and estimate once more
  double signal_to_noise = 1.0;      ///< `signal_to_noise`: S/n of the excitation threshold, 1 to 10
  double significance = 0.05;        ///< `significance`: level of the t-tests
  /// `min_holdout_r2`: a coefficient that explains less of the hold-out's variance is rejected.
  double min_holdout_r2 = estimation::kHoldOutFailed;
  /// `max_unmodelled`: largest share of the coefficient's variance that may be neither modelled nor noise of the
  /// sensors.
  double max_unmodelled = estimation::kMostUnmodelled;
  /// `contradiction_level`: identification and hold-out data, estimated separately, must agree at this level
  /// (chi-square).
  double contradiction_level = estimation::kPartsContradict;
  /// `structure`: "given" (nothing) takes the subject's terms; "stepwise" or "orthogonal" chooses among the candidates
  /// first.
  std::optional<estimation::StructureMethod> structure = {};
  /// `candidates`: terms to choose among, `[identify.candidates] CL = ["1", "alpha", ...]`; coefficients that are not
  /// named choose among `default_candidates`.
  EnumArray<Coefficient, std::vector<Term>, kCoefficients> candidates;
  bool output_error = false;  ///< `output_error`: output-error maximum likelihood in addition to regression
  /// `output_error_gusts`: the reconstructed gust is an input of its simulation; false takes the air to be calm. Where
  /// it is not given: true where a ground velocity is recorded, against which a gust can be told from motion.
  std::optional<bool> output_error_gusts = {};
  bool output_error_biases = false;  ///< `output_error_biases`: constant biases of the accelerometers, per segment
  double frequency_low_Hz = 0.0;     ///< `frequency_band = ["0.1 Hz", "2 Hz"]`: equation error in the frequency domain
  double frequency_high_Hz = 0.0;    ///< 0: none
  std::size_t bootstrap = 0;         ///< `bootstrap`: replicates of a block bootstrap of the chosen regression; 0: none
  std::uint64_t seed = 1;            ///< of the bootstrap; the study's

  /// @throws InputError for values that make no sense.
  [[nodiscard]] static IdentifyOptions read(const StudyTable& table);

  /// Whether the user chose the method.
  [[nodiscard]] bool method_fixed() const { return method.has_value() || choose_output_error; }
  /// `method` as the study has it.
  [[nodiscard]] std::string method_name() const;
};

}  // namespace veridyn::aircraft
