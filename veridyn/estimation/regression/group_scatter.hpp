#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::estimation {

/// Estimates of the same parameters from several groups of rows (flights, days, persons): do they differ by more than
/// their error bars, and what is their mean?
///
/// The parameters of group g are theta + d_g, with d_g independent from group to group; what is looked for is theta,
/// the mean of groups like these. Rows of all groups in one regression take d_g for zero: their error bars shrink with
/// the number of rows, however few the groups, and what the groups have of their own (constants by sensors' biases,
/// effects of large terms that cancel) is left in the residual.
///
/// Is there scatter? By Cochran (1954),
///     Q = sum_g (theta_g - m)' P_g^-1 (theta_g - m),  m the mean weighted by P_g^-1,
/// is chi-square with (G - 1) n_p degrees of freedom where all d_g are zero; below `kLevel` it is taken that they
/// are not.
///
/// The mean, parameter by parameter: weights w_g = 1/(sigma_g^2 + tau^2) with tau, the standard deviation between
/// groups, of DerSimonian & Laird (1986); its standard error from the scatter itself,
///     s^2 = sum_g w_g (theta_g - mean)^2 / ((G - 1) sum_g w_g),
/// and its interval by Student's t with G - 1 degrees of freedom (Hartung & Knapp 2001). It holds the mean in 95 % of
/// cases whether there is scatter or not, and is wide for few groups, of which nothing better is known.
struct GroupScatter {
  std::size_t groups = 0;         ///< with rows
  std::size_t compared = 0;       ///< of these, those that determine all parameters by themselves
  double q = 0.0;                 ///< Cochran's Q of all parameters together
  double freedom = 0.0;           ///< its degrees of freedom; 0: there was nothing to compare
  double p = 1.0;                 ///< of "the parameters are the same in all groups"
  Eigen::VectorXd mean;           ///< over the groups that are compared; empty with fewer than two
  Eigen::VectorXd sigma;          ///< its standard error
  Eigen::VectorXd between_sigma;  ///< tau

  /// Whether the parameters differ between groups, so that what is estimated is their mean.
  [[nodiscard]] bool found() const { return freedom > 0.0 && p < kLevel; }
  /// Of Student's t.
  [[nodiscard]] double degrees_of_freedom() const { return static_cast<double>(compared) - 1.0; }
  /// p below which groups are taken to differ.
  static constexpr double kLevel = kPartsDiffer;
};

/// Of each group's estimate by itself, of the same parameters in the same order; one that is not usable does not
/// determine them, and neither does one with directions that are not excited.
[[nodiscard]] GroupScatter group_scatter(std::span<const RegressionEstimate> groups);

/// Mean and error bars of the groups in place of those of all rows together; the covariance keeps its correlations.
/// What is then not distinguishable from zero becomes insignificant.
void take_mean(RegressionEstimate& estimate, const GroupScatter& scatter, double significance);

}  // namespace veridyn::estimation
