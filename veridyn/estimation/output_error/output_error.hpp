#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/parametric_model.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {

/// What is estimated of the covariance R of the output noise.
enum class OutputNoise {
  kDiagonal,  ///< outputs' noises independent of each other. The default
  kFull,      ///< correlations between outputs too
  kGiven      ///< R = diag(noise_start^2), known
};

/// How an output-error estimation ended. With the first two there is an estimate; with `kInterrupted` too, where the
/// search had taken a step.
enum class OutputErrorTermination {
  kConverged,  ///< a relaxation moved no parameter by more than `tolerance` sigma and no noise by ten times that share
  kRelaxations,        ///< `max_relaxations` were used up first
  kInterrupted,        ///< the caller's progress asked to stop
  kDivergedAtStart,    ///< the simulation diverges at the starting values; the message names the segment
  kTooFewSamples,      ///< fewer measured values than unknowns
  kNothingToEstimate,  ///< the data determine no direction of the parameters
  kSolverFailed        ///< the optimiser could not go on: every step diverged or was not finite
};
[[nodiscard]] std::string_view to_string(OutputErrorTermination termination);

/// How many samples after each are looked at for what is coloured in a residual.
inline constexpr Eigen::Index kColourLags = 5;

/// What noise of recorded inputs gives each output; empty: nothing.
struct InputNoise {
  Eigen::VectorXd variance = {};        ///< [unit^2]
  Eigen::VectorXd autocovariance = {};  ///< its mean over the next kColourLags samples [unit^2]
  Eigen::VectorXd memory = {};          ///< in how many samples it is one observation
};

/// What is estimated besides the parameters, and when the search ends.
struct OutputErrorOptions {
  OutputNoise noise = OutputNoise::kDiagonal;
  /// Standard deviation of each output's noise to begin with; empty takes the residuals at the start. Needed with
  /// `kGiven`.
  Eigen::VectorXd noise_start = {};
  /// Error bars: inverse information (kWhite: Cramer-Rao, too small when the model is incomplete) or corrected for the
  /// autocorrelation of the residuals (kAutocorrelated, the default).
  CovarianceKind covariance = CovarianceKind::kAutocorrelated;
  /// Take what is coloured in the residual for an error of the model, which is as large along the parameters as in any
  /// direction beside: see `output_error`.
  bool model_error = false;
  InputNoise input_noise = {};                  ///< coloured too, and no error of the model
  bool free_initial_conditions = true;          ///< estimate the initial conditions of every segment
  std::vector<std::string> output_biases = {};  ///< outputs with a constant bias per segment, estimated
  double significance = 0.05;                   ///< two-sided level of the t-tests
  int max_relaxations = 30;                     ///< alternations between parameters and R
  int max_steps = 50;       ///< Levenberg-Marquardt steps per relaxation; 0: what the data say where the search begins
  double tolerance = 1e-3;  ///< of a relaxation's parameter change [sigma]
  /// A combination of parameters whose sensitivity is below this share of the largest one's (columns of the information
  /// matrix's root scaled to unit length) is reported as not identifiable.
  double identifiable = 1e-6;
  /// Hold what the data do not determine: along combinations of parameters whose standard deviation is larger than that
  /// of a value known only to lie within the bounds (their width over sqrt(12)) the parameters stay where they start,
  /// in each relaxation again; they are reported as `held` and not identifiable. Without it such a search ends wherever
  /// noise drives it along its valley. Needs finite bounds of every free parameter.
  bool hold_undetermined = false;
  /// Where the search begins instead of at the parameters' `start`, one value a parameter, within the bounds: for
  /// searches from several points. Priors and `hold_undetermined` keep to `start`, fixed parameters stay there.
  Eigen::VectorXd search_start = {};
  Eigen::Index max_lag = 500;  ///< longest lag of residual correlation that is looked for [samples]
  int threads = 0;             ///< 0: those of the progress; any number gives identical bits

  /// @throws InputError naming the option, its value and its rule.
  void validate(const ParametricModel& model) const;
};

/// One output over all segments.
struct OutputFit {
  std::string name;
  std::string unit;
  numerics::FitMeasures fit;
  double noise_sd = 0.0;  ///< sqrt(R_jj)
  double lag1 = 0.0;      ///< autocorrelation of the residual at one sample: 0 when white
};

/// Value of an unknown of one segment.
struct SegmentParameter {
  std::size_t segment = 0;
  std::string name;  ///< the model's, or "bias of <output>"
  std::string unit;
  double value = 0.0;
};

/// Simulations of segments that a search took.
struct SimulationCount {
  std::size_t values = 0;            ///< of outputs alone
  std::size_t with_derivatives = 0;  ///< of outputs and their sensitivities to all unknowns
  SimulationCount& operator+=(const SimulationCount& more) {
    values += more.values;
    with_derivatives += more.with_derivatives;
    return *this;
  }
};

/// Maximum-likelihood estimate of a model's parameters from its outputs.
struct OutputErrorEstimate {
  OutputErrorTermination termination = OutputErrorTermination::kTooFewSamples;
  std::string message;                ///< one sentence
  std::vector<Parameter> parameters;  ///< those that all segments share, in the model's order
  Eigen::VectorXd theta;              ///< their values
  Eigen::MatrixXd covariance;         ///< of the chosen kind; 0 for fixed, infinite variance for not identifiable ones
  Eigen::MatrixXd covariance_by_model;  ///< what an error of the model adds, with `model_error`; 0 without
  Eigen::MatrixXd covariance_white;     ///< inverse information (Cramer-Rao bound)
  double degrees_of_freedom = 0.0;      ///< of the t-tests
  Eigen::Index lag_window = 0;          ///< lags at which residual correlation counts in full [samples]
  std::vector<SegmentParameter> segment_parameters;
  Eigen::MatrixXd noise_covariance;  ///< R
  std::vector<OutputFit> outputs;
  std::vector<RowMatrix> predicted;       ///< per segment, samples x outputs, bias included
  std::vector<Direction> unidentifiable;  ///< combinations that the data (and priors) do not determine
  std::vector<Direction> held;    ///< of these, along which `hold_undetermined` kept the parameters at their start
  double autocorrelation = 1.0;   ///< by how much it widens what the data say: the median over the parameters
  double samples_as_one = 1.0;    ///< D: so many samples count as one against priors, with `model_error`
  double condition_number = 0.0;  ///< of the information's root over the shared parameters, columns of unit length
  /// Share of each parameter's variance before the data that the data removed: 1 - (sigma/prior_sigma)^2; 1 without a
  /// prior.
  Eigen::VectorXd learned_share;

  double negative_log_likelihood = 0.0;  ///< without the constant N p/2 log(2 pi)
  Eigen::Index values = 0;               ///< measured values used
  int relaxations = 0;
  int steps = 0;                 ///< Levenberg-Marquardt steps, all relaxations
  int accepted_steps = 0;        ///< of these, taken
  int diverged_steps = 0;        ///< of these, refused because a simulation diverged
  std::string diverged_segment;  ///< the segment that diverged last; empty when none did
  SimulationCount simulations;

  [[nodiscard]] bool usable() const {
    return termination == OutputErrorTermination::kConverged || termination == OutputErrorTermination::kRelaxations;
  }
  /// Whether values and error bars are there: of a search that ended, or of where an interrupted one stood. The error
  /// bars of the latter are those of a minimum, which it had not reached.
  [[nodiscard]] bool has_estimate() const {
    return usable() || (termination == OutputErrorTermination::kInterrupted && accepted_steps > 0);
  }
  [[nodiscard]] const Parameter* find(std::string_view name) const;
  /// Of noise and of the model's error.
  [[nodiscard]] Eigen::MatrixXd total_covariance() const {
    return covariance_by_model.size() > 0 ? Eigen::MatrixXd(covariance + covariance_by_model) : covariance;
  }
};

/// Output-error maximum likelihood (Klein & Morelli 2006, chapter 6): z_k = y_k(theta) + nu_k, nu ~ N(0, R), minimises
///
///     J = 1/2 sum_k nu_k' R^-1 nu_k + N/2 ln det R + 1/2 sum ((theta_i - start_i)/prior_sigma_i)^2
///
/// by relaxation: Levenberg-Marquardt (Ceres) over the parameters of all segments and the unknowns of each, then R from
/// the residuals, until neither moves. Process noise (turbulence) is not modelled: its effect on the residual is
/// autocorrelated, which is why the default error bars are corrected for that.
///
/// `measured[s]` is samples x outputs; NaN is a missing value. With `kFull` R and missing values the relaxation is the
/// EM algorithm. Each segment is reduced to a triangle by orthogonal transformations, its own unknowns eliminated
/// exactly, so memory does not grow with the number of segments' samples.
///
/// Covariance: P = (sum S' R^-1 S + prior)^-1 (white), and P [sum_ij S_i' R^-1 Rnu(i-j) R^-1 S_j] P (Morelli & Klein
/// 1997, J. Guidance 20(1), eq. 14) with Rnu the residuals' auto- and cross-covariance under a flat-top lag window; S
/// with the part that the segment's own unknowns explain taken out.
///
/// With `model_error` the likelihood is taken to the power 1/D against priors that count in full, and E/p P S'R^-1S
/// P is added to the covariance: D = M + E/p with E the coloured power of the whitened residual (its autocovariance
/// over the next five samples, what exceeds two standard errors and 1.1 times that of `input_noise`, which is known no
/// better), p the number of shared unknowns and M in how many samples noise, coloured by that
/// of the inputs, is one observation (1 without). A
/// coarsened posterior (Miller & Dunson 2019, J. American Statistical Association 114) whose power is that of what the
/// model misses: the samples are as wrong along the p parameters as they show to be beside.
/// @throws InputError when sizes do not fit or an option is wrong.
[[nodiscard]] OutputErrorEstimate output_error(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                               const OutputErrorOptions& options = {});
/// The same, interruptible.
[[nodiscard]] OutputErrorEstimate output_error(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                               const OutputErrorOptions& options, Progress& progress);

}  // namespace veridyn::estimation
