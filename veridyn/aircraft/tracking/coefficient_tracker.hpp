#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/recursive/regression_tracker.hpp"

namespace veridyn::aircraft {

using estimation::TrackHistory;

/// Where airspeed and flow angles of a tracked flight come from.
enum class AirDataSource {
  kFilter,  ///< airspeed of the causal state estimate; vanes, or where there are none the estimate's flow angles
  kSensors  ///< pitot and vanes
};
[[nodiscard]] std::string_view to_string(AirDataSource source);

/// Which filter estimates the motion through the air of a tracked flight.
enum class TrackFilter {
  kModelFree,  ///< no aerodynamics
  kGuarded     ///< a model-based filter with the tracked coefficients alongside, as long as its innovations allow
};
/// "model-free", "guarded".
[[nodiscard]] std::string_view to_string(TrackFilter filter);

/// How a coefficient is followed on line. Study table `[track]`. Rows come at the rate of `FlightSignals::stride`.
struct TrackOptions : estimation::TrackerOptions {
  std::vector<Coefficient> coefficients = {};  ///< empty: all that the subject models
  std::string estimate_file;                   ///< estimate.json to start from (hybrid start)
  AirDataSource air_data = AirDataSource::kFilter;
  TrackFilter filter = TrackFilter::kModelFree;
  bool starts_from_study = true;  ///< whether the guarded filter has a model before anything is tracked

  [[nodiscard]] static const KeyTable<TrackOptions>& keys();
};

/// One aerodynamic coefficient followed row by row, watched for changes, with its history.
class CoefficientTracker : public estimation::RegressionTracker {
 public:
  /// @param error_covariance W of a row [x, z], (n + 1) x (n + 1)
  /// @param rate_Hz of rows
  /// @param names of the parameters; empty: those of the model
  CoefficientTracker(const CoefficientModel& model, const Eigen::MatrixXd& error_covariance,
                     const TrackOptions& options, double rate_Hz, std::vector<std::string> names = {});

  [[nodiscard]] const CoefficientModel& model() const { return model_; }

 private:
  CoefficientModel model_;
};

}  // namespace veridyn::aircraft
