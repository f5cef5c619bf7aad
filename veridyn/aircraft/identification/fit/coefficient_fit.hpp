#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "veridyn/aircraft/identification/evidence/coefficient_evidence.hpp"
#include "veridyn/aircraft/identification/options/identify_options.hpp"
#include "veridyn/aircraft/identification/rows/flight_rows.hpp"
#include "veridyn/estimation/regression/group_scatter.hpp"

/// Inside of identification: the regressions of a coefficient and the figures by which they are judged.
namespace veridyn::aircraft::internal {

/// View of what coefficients are identified from, and how.
struct FlightView {
  std::span<const PreparedFlight> flights;
  const Subject& subject;
  const IdentifyOptions& options;

  [[nodiscard]] FlightRows rows(const CoefficientModel& model, RowUse use) const {
    return coefficient_rows(model, flights, use, subject);
  }
  [[nodiscard]] estimation::RegressionOptions regression_options() const {
    estimation::RegressionOptions regression;
    regression.significance = options.significance;
    regression.signal_to_noise = options.signal_to_noise;
    return regression;
  }
};

/// The parameters of a model by all methods on the identification rows.
struct CoefficientFit {
  CoefficientModel model;  ///< values are the chosen estimate's, where there is one
  FlightRows rows;
  estimation::RegressionComparison comparison;
  std::optional<estimation::RegressionEstimate> chosen;
  Eigen::VectorXd of_rows;  ///< parameters from all rows together, whatever was taken then
  double error_ratio = 0.0;
  double unmodelled_share = 0.0;  ///< see CoefficientResult
  bool enough_rows = false;
  bool by_output_error = false;                              ///< `chosen` is output error's, see take_output_error
  std::optional<estimation::RegressionEstimate> of_holdout;  ///< then: the same from the hold-out, where it has any
};

/// Of all rows of all flights together.
[[nodiscard]] CoefficientFit fit_coefficient(CoefficientModel model, const FlightView& view);

/// What several flights say of a coefficient, each by itself.
struct FlightFits {
  std::vector<CoefficientFit> fits;  ///< of each flight; without rows where it has none
  estimation::GroupScatter scatter;  ///< of those whose methods agree
};

/// Each flight of `fit` by itself. Where their parameters differ, `fit` becomes their mean: estimate, error bars,
/// choice of the method and checks of it (the worst of the flights), and what is in the residual beyond the sensors
/// (over the rows of the flights, each by its own parameters).
[[nodiscard]] FlightFits fit_each_flight(CoefficientFit& fit, const FlightView& view);

/// Share of the variance of the identification rows that `chosen` leaves neither modelled nor noise of the sensors.
[[nodiscard]] double unmodelled_share_of(const CoefficientFit& fit);

/// The figures by which a fit is judged.
/// @param each  of several flights; null: there is one
[[nodiscard]] CoefficientChecks check_fit(const CoefficientFit& fit, double row_interval_s, const FlightFits* each,
                                          const FlightView& view);

}  // namespace veridyn::aircraft::internal
