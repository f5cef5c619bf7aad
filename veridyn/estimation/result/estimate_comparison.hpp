#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::estimation {

/// An estimate and what it is called: of a flight, a method, a program.
struct NamedEstimate {
  std::string name;
  Estimate estimate = {};
};

/// One parameter in several estimates.
struct ComparedParameter {
  std::string name, unit = {};
  std::vector<const Parameter*> by = {};  ///< in the order of the estimates; null: not there, or without an interval
  double mean = 0.0, sigma = 0.0;         ///< weighted by the inverse variances
  double q = 0.0;                         ///< Cochran's Q: sum of ((value - mean)/sigma)^2
  double p = 1.0;                         ///< of "all are of one value": chi-square with one less than the estimates
  double between_sigma = 0.0;  ///< standard deviation between the estimates beyond their own (DerSimonian-Laird)
};

/// Two estimates of the parameters that both have, as a whole.
struct ComparedPair {
  std::size_t first = 0, second = 0;
  std::size_t parameters = 0;
  double chi_square = 0.0;  ///< of the difference by the sum of both covariances
  double p = 1.0;
  std::string largest = {};     ///< the parameter that differs most in its standard errors
  double largest_sigmas = 0.0;  ///< by how many
};

/// Estimates side by side, taken as independent of each other: estimates of the same rows agree better than that.
struct EstimateComparison {
  std::vector<ComparedParameter> parameters;  ///< that at least two have, in the order of the first
  std::vector<ComparedPair> pairs;            ///< all that share a parameter
  std::vector<Evidence> evidence;             ///< a row a pair and a row a parameter that differs
  std::vector<std::string> notes;             ///< what could not be compared, and why
  std::string text;                           ///< one sentence
};

/// Compares values that estimators gave with an interval: rejected, unexcited and fixed parameters are left out. The
/// estimates must outlive the result.
/// @throws InputError where there are fewer than two, or no two share a parameter; where units differ
[[nodiscard]] EstimateComparison compare_estimates(std::span<const NamedEstimate> estimates);

}  // namespace veridyn::estimation
