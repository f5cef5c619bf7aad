#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/evidence/coefficient_evidence.hpp"
#include "veridyn/aircraft/identification/fit/sensor_width.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"
#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/estimation/regression/group_scatter.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/regression/structure_search.hpp"
#include "veridyn/estimation/result/analysis.hpp"

namespace veridyn::aircraft {

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
  /// The same per standard deviation of each sensor's error, in the places of `place_of`; see sensor_sensitivity.
  Eigen::MatrixXd sensor_sensitivity;
  IntervalParts interval_parts;  ///< what the intervals of `chosen` consist of
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

}  // namespace veridyn::aircraft
