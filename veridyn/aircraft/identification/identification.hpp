#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/output_error/axis_output_error.hpp"
#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/analysis.hpp"
#include "veridyn/estimation/estimate.hpp"
#include "veridyn/estimation/regression/group_scatter.hpp"
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
  double min_holdout_r2 = 0.3;
  /// `max_unmodelled`: largest share of the coefficient's variance that may be neither modelled nor noise of the
  /// sensors.
  double max_unmodelled = 0.1;
  /// `contradiction_level`: identification and hold-out data, estimated separately, must agree at this level
  /// (chi-square).
  double contradiction_level = 1e-3;
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

/// How well a coefficient is predicted in one of several flights.
struct FlightFit {
  std::string flight;
  numerics::FitMeasures fit = {};
};

/// The parameters of a coefficient by one of several flights alone.
struct FlightEstimate {
  std::string flight;
  std::vector<estimation::Parameter> parameters = {};
};

/// One coefficient: the estimates of all methods, what was chosen, and whether it may be used.
struct CoefficientResult {
  Coefficient coefficient = Coefficient::kCL;
  std::string name;               ///< "Cm", or "Cm/Jy" where the subject has no inertia
  bool per_unit_inertia = false;  ///< then the model's values are no aerodynamic coefficients
  Axis axis = Axis::kLongitudinal;
  estimation::GroupVerdict verdict = estimation::GroupVerdict::kSkipped;
  std::string reason;                           ///< one sentence
  CoefficientModel model;                       ///< terms; values are the chosen estimate's where there is one
  estimation::RegressionData data;              ///< identification rows, for further analysis
  estimation::RegressionComparison comparison;  ///< OLS, TLS, GTLS, PCA-GTLS on the same rows
  std::optional<estimation::RegressionEstimate> chosen;
  std::string method;  ///< that gave `chosen`: "GTLS", or "output error"
  /// Where that is output error: factors on the standard deviations of its run, see make_estimate; else empty.
  Eigen::VectorXd output_error_widening;
  /// Of several flights: how much the parameters differ between them. Where they do, `chosen` is their mean, with error
  /// bars from the scatter.
  std::optional<estimation::GroupScatter> scatter;
  std::vector<FlightEstimate> flight_estimates;          ///< of several flights, each by itself
  std::optional<estimation::StructureSearch> structure;  ///< how its terms were chosen, where they were
  double error_ratio = 0.0;  ///< residual variance over what sensor noise explains; 1 when the model is complete
  /// Share of the coefficient's variance that is neither modelled nor explained by twice the sensors' noise:
  /// (1 - R^2) (1 - 4 / error_ratio).
  double unmodelled_share = 0.0;
  /// Change of the parameters per standard deviation of mass, geometry and inertia; see body_sensitivity.
  Eigen::MatrixXd body_sensitivity;
  /// Standard deviation of each parameter for what the recording leaves in doubt of airspeed and vanes, alongside its
  /// interval; empty unless identified.
  Eigen::VectorXd air_data_doubt;
  numerics::FitMeasures identification_fit;
  numerics::FitMeasures holdout_fit;
  std::vector<FlightFit> flight_fits;  ///< the same flight by flight, where there are several
  double contradiction_p = 1.0;        ///< of identification against hold-out estimates
  /// Measured and modelled coefficient at every stride-th grid point in the air, for the report; NaN outside. Of
  /// several flights one after the other (PreparedFlight::shift_s).
  std::vector<double> time, measured, modelled;
  numerics::Autocorrelation residual_autocorrelation;  ///< on the identification rows
  double row_interval_s = 0.0;                         ///< between the rows of a segment
  std::vector<estimation::Evidence> evidence;          ///< its own rows, and those of the recording that bear on it
  estimation::Judgement judgement;                     ///< of these; what was not estimated is not judged
};

/// What identification found.
struct Identification {
  std::vector<CoefficientResult> coefficients;
  std::vector<AxisOutputError> output_error;  ///< of both axes, where that is the chosen method
};

/// Estimates every coefficient of `subject.model` on its axis's segments of all flights together. Regressor errors are
/// propagated from the signals' noise by automatic differentiation; the variance of z that they leave unexplained is
/// equation error. The checks of the recordings bear on the coefficients too. With `choose_output_error` the estimates
/// of output error are taken and judged in place of the regressions that they start from; what mass, geometry, inertia
/// and air data leave in doubt is then still found by regression.
[[nodiscard]] Identification identify_coefficients(std::span<const PreparedFlight> flights, const Subject& subject,
                                                   const IdentifyOptions& options, Progress& progress);

/// Why a coefficient is rejected whose residual is more than the sensors' noise: one clause, without its name. The
/// arguments are those of CoefficientResult.
[[nodiscard]] std::string unmodelled_text(double error_ratio, double unmodelled_share);

/// Terms that a structure search chooses among by default: those of `model`, the coefficient's usual linear
/// ones, and second-order ones: alpha^2, alpha q_n, alpha de, de^2 (longitudinal), alpha beta,
/// alpha p_n, alpha r_n, alpha da, alpha dr, beta^3 (lateral).
[[nodiscard]] std::vector<Term> default_candidates(const CoefficientModel& model);

/// The axis on which a coefficient is identified: CL, CD, Cm longitudinal, the others lateral.
[[nodiscard]] Axis axis_of(Coefficient coefficient);

/// Why the coefficient cannot be computed from these signals at all, or empty.
[[nodiscard]] std::string identification_obstacle(const CoefficientModel& model, const FlightSignals& signals,
                                                  const Subject& subject);

/// W of the coefficient's row [x, z] at grid point k: J Sigma J' of the signals' classical errors; those of Berkson
/// kind enter through z alone.
[[nodiscard]] Eigen::MatrixXd row_error_covariance(const CoefficientModel& model, const FlightSignals& signals,
                                                   std::size_t k, const Subject& subject);

/// Regression rows of a coefficient in the given spans: stride-thinned, rows that miss a signal left out, one segment
/// id a gapless stretch of a span, W from the signals' noise.
[[nodiscard]] estimation::RegressionData coefficient_data(const CoefficientModel& model, const FlightSignals& signals,
                                                          std::span<const TimeSpan> spans, const Subject& subject);

/// The subject with the identified values in its model; parameters of all other coefficients are unknown, so that
/// nothing can be simulated with what this flight does not support.
[[nodiscard]] Subject identified_subject(const Subject& subject, std::span<const CoefficientResult> results);

/// The coefficients that may be used.
[[nodiscard]] std::vector<Coefficient> identified_coefficients(std::span<const CoefficientResult> results);

/// An estimate from elsewhere against all excited segments of these flights: a coefficient is identified when it
/// explains at least `min_holdout_r2` of the measured one there, else rejected. Parameters that the estimate rejected
/// are not tried.
/// @throws InputError when the estimate has no parameter that the subject's model names.
[[nodiscard]] std::vector<CoefficientResult> evaluate_estimate(std::span<const PreparedFlight> flights,
                                                               const Subject& subject, const IdentifyOptions& options,
                                                               const estimation::Estimate& estimate);

/// The parameters of all coefficients, for estimate.json. Regressed coefficients share the errors of mass, geometry and
/// inertia; those of one axis by output error those of their run too.
/// @param runs  of output error, where that is the chosen method
[[nodiscard]] estimation::Estimate make_estimate(const Subject& subject, std::span<const CoefficientResult> results,
                                                 std::span<const AxisOutputError> runs = {});

}  // namespace veridyn::aircraft
