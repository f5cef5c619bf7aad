#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "veridyn/aircraft/reconstruction/reconstruct_solve.hpp"

/// Inside of reconstruct_solve: errors of vanes and pitot tube by maximum likelihood.
namespace veridyn::aircraft::internal {

/// Constant errors of the air data: which are estimated (AirDataErrorIndex), their values and covariance.
struct AirDataErrors {
  std::vector<int> index;
  Eigen::Matrix<double, 5, 1> value = Eigen::Matrix<double, 5, 1>::Zero();  ///< 0 where not estimated
  Eigen::MatrixXd covariance;                                               ///< in the order of `index`
  DrydenSettings spectrum;                                                  ///< with intensities as they fit best
  std::vector<Eigen::Index> applied;  ///< positions in `index` of those that are taken off the sensors
  int iterations = 0;
  bool converged = true;

  /// `value` of those that are applied, 0 elsewhere.
  [[nodiscard]] Eigen::Matrix<double, 5, 1> correction() const {
    Eigen::Matrix<double, 5, 1> result = Eigen::Matrix<double, 5, 1>::Zero();
    for (const Eigen::Index i : applied) {
      const int at = index[i];
      result(at) = value(at);
    }
    return result;
  }
};

/// 1 sigma of each before the flight; see kVaneBiasPrior and its like.
[[nodiscard]] std::array<double, 5> air_data_error_priors();
/// Indices (AirDataErrorIndex) of those that the options estimate.
[[nodiscard]] std::vector<int> estimated_air_data_errors(const ReconstructOptions& options);

/// The errors theta that maximise likelihood times prior, after the filter-error method (Maine & Iliff 1985;
/// Jategaonkar 2006, chapter 5): for a given theta the filter runs with the air data corrected, and
///
///     ln L(theta) = -1/2 sum [nu^2 / S + ln S] - 1/2 sum (theta / prior)^2
///
/// over all innovations nu with predicted variance S. For the model-based filter only: without a model of the aircraft
/// the motion with which pilot and airframe answer a gust is taken for an error of the sensor (a clean flight's pitot
/// tube came out 34 +- 2 % low), see `check_air_data_errors`. Fisher scoring with
///
///     I = sum [nu_i nu_j / S + S_i S_j / (2 S^2)] + prior^-2
///
/// (nu_i, S_i: derivatives by theta_i, by differences of filters that run alongside); I^-1 is the covariance.
///
/// Why not as states of the filter: an extended filter multiplies uncertain scale factors with uncertain gusts, and its
/// linearisation points scatter with the estimates; what looks like information about a constant is in part that
/// scatter, and its sigmas come out three to eight times too small. For the same reason the most likely trajectory
/// (an iterated smoother) is no way out: gain and gust only appear as a product, and their joint mode runs away. With
/// theta fixed the filter's innovations are as they should be, and the gusts are integrated out, not maximised over.
///
/// The intensities of the gusts along the three axes are estimated along with theta, within a factor e^0.3 (1 sigma):
/// otherwise an angle's fluctuation, sigma_w / Va, would determine the airspeed to a percent as soon as sigma_w is
/// taken as known to a percent.
[[nodiscard]] AirDataErrors estimate_air_data_errors(const FilterEngine& engine, const RunSetting& base,
                                                     const SolveTask& task);

}  // namespace veridyn::aircraft::internal
