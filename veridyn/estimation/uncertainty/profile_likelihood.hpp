#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"

namespace veridyn::estimation {

/// How a profile is followed.
struct ProfileOptions {
  double confidence = 0.95;  ///< of the interval, in (0, 1)
  /// Noise, initial conditions, biases and tolerance as those of the estimate; its covariance, `search_start` and
  /// `hold_undetermined` are not used. With `kGiven` noise the same R everywhere; else R is fitted at every point.
  OutputErrorOptions output_error = {};
  /// The statistic is divided by it: the normalised chi-square of a residual that is larger than the stated noise
  /// (Birge 1932); at least 1.
  double dispersion = 1.0;
  /// The statistic of a model's parameter is divided by this too, one value a parameter, at least 1; empty: 1. The
  /// ratio of its variance corrected for autocorrelated residuals to the uncorrected one makes the profile of a linear
  /// model as wide as the corrected error bar (magnitude adjustment of Pace, Salvan & Sartori 2011, Stat Sinica 21:129,
  /// for a scalar parameter).
  std::vector<double> inflation = {};
  int max_fits = 12;  ///< re-optimisations on each side of the estimate

  /// @throws InputError naming option, value and rule.
  void validate() const;
};

/// What ends an interval on one side.
enum class ProfileEnd {
  kClosed,   ///< the statistic crosses its threshold
  kOpen,     ///< it is below the threshold even at the parameter's bound: the data and priors exclude nothing there
  kNotFound  ///< simulations diverge on the way, `max_fits` was used up, or the work was interrupted
};
/// "closed", "open", "not found".
[[nodiscard]] std::string_view to_string(ProfileEnd end);

/// The best fit with one parameter fixed.
struct ProfilePoint {
  double value = 0.0;  ///< of that parameter
  /// 2 (J - J of the estimate)/(dispersion inflation), J the negative log posterior of `output_error`.
  double statistic = 0.0;
  Eigen::VectorXd theta;  ///< all shared parameters there
};

/// Likelihood-ratio statistic of one parameter, all other unknowns fitted again at every value.
struct ParameterProfile {
  std::size_t parameter = 0;  ///< of the model
  std::string name = {}, unit = {};
  double value = 0.0;  ///< where the statistic is zero
  double low_bound = -kInfinity, high_bound = kInfinity;
  std::vector<ProfilePoint> points = {};  ///< by value, the estimate among them
  double low = kNaN, high = kNaN;         ///< ends of the interval; NaN unless closed
  ProfileEnd low_end = ProfileEnd::kNotFound, high_end = ProfileEnd::kNotFound;

  /// "0.94 .. 1.08", "open below .. 1.08".
  [[nodiscard]] std::string text() const;
};

/// Profiles of several parameters.
struct ProfileResult {
  std::vector<ParameterProfile> profiles;  ///< in the order asked for
  double threshold = 0.0;                  ///< of the statistic: quantile of chi-square with one degree of freedom
  Eigen::VectorXd theta;                   ///< where the statistic is zero
  /// By how much the statistic's minimum lies below that at the estimate given: larger than about 0.1, the search that
  /// gave it had not arrived.
  double gain = 0.0;
  int fits = 0;  ///< re-optimisations
  bool interrupted = false;
  std::string message;  ///< why there is none; empty otherwise

  [[nodiscard]] bool usable() const { return message.empty() && !interrupted; }
};

/// Profile likelihood (Raue et al. 2009, Bioinformatics 25:1923) of an output-error estimate: each parameter is fixed
/// at values to both sides of the estimate, all others, starts of segments and (unless given) the noise are fitted
/// again from where the neighbouring value left them, and the interval holds the values whose likelihood ratio stays
/// below the quantile of chi-square. Priors belong to the likelihood. Steps follow the signed root of the statistic,
/// which is a straight line where the model is linear: there the interval is estimate +- quantile * sigma and takes two
/// fits a side. Where a lower minimum is found on the way, all begins again from there.
///
/// Sides of parameters are followed on the progress' threads, with the same bits on any number of them.
/// @param estimate usable; where profiles begin, with `covariance_white` for the first steps
/// @param parameters indices of free parameters of the model
/// @throws InputError when an option is wrong or a parameter is fixed.
[[nodiscard]] ProfileResult profile_likelihood(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                                               const OutputErrorEstimate& estimate,
                                               const std::vector<std::size_t>& parameters,
                                               const ProfileOptions& options, Progress& progress);

}  // namespace veridyn::estimation
