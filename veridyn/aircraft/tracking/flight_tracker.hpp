#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/signals/flight_signals.hpp"
#include "veridyn/aircraft/tracking/coefficient_tracker.hpp"
#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::aircraft {

/// One coefficient of the tracked flight.
struct TrackedCoefficient {
  CoefficientModel model;
  std::string obstacle = {};                       ///< why it cannot be followed at all, or empty
  std::string start = {};                          ///< where it began: "batch estimate", "no estimate"
  std::optional<CoefficientTracker> tracker = {};  ///< from the moment its noise is known
  Eigen::MatrixXd regressor_moment = {};           ///< mean of x x' over the rows of about a memory
};

/// A change that one of the coefficients revealed.
struct FlightChange {
  Coefficient coefficient = Coefficient::kCL;
  estimation::Change change;
};

/// All coefficients of a flight followed on line, from flight signals that come in pieces.
///
/// A row is taken from every stride-th grid point in the air, as in batch identification. The error covariance W of a
/// coefficient's rows is averaged over its first `kLearnSeconds` in the air, whose rows are kept until then, so that
/// nothing is missed. With a batch estimate the tracker starts from it. Every ten seconds what the residual shows
/// beyond the sensors' noise is added to W as equation error, and the effect of deflections that jump between two
/// samples is taken out of the rows, as in batch identification.
class FlightTracker {
 public:
  static constexpr double kLearnSeconds = 20.0;
  /// Rows are prepared together, and the equation error is fitted, over windows of this length by the clock.
  static constexpr double kWindowSeconds = 10.0;

  /// @param start a batch estimate to begin with, or null
  /// @throws InputError when nothing of the subject's model is among `options.coefficients`
  FlightTracker(Subject subject, TrackOptions options, double min_airspeed_mps, const estimation::Estimate* start);

  /// Takes the rows with stamps after the last one taken and within [from, until] [s].
  /// @return the changes that they reveal
  std::vector<FlightChange> feed(const FlightSignals& signals, double from, double until);

  [[nodiscard]] const std::vector<TrackedCoefficient>& coefficients() const { return coefficients_; }
  [[nodiscard]] const std::vector<FlightChange>& changes() const { return changes_; }
  [[nodiscard]] const Subject& subject() const { return subject_; }
  [[nodiscard]] const TrackOptions& options() const { return options_; }
  [[nodiscard]] double last_time() const { return last_; }    ///< of the last row taken; -infinity before
  [[nodiscard]] double row_rate_Hz() const { return rate_; }  ///< 0 before the first row
  [[nodiscard]] std::size_t rows() const { return rows_; }
  /// The estimates as they stand, for estimate.json.
  [[nodiscard]] estimation::Estimate estimate() const;

 private:
  struct Learning {
    std::vector<double> time;
    std::vector<double> rows;  // x and z, row by row
    Eigen::MatrixXd W;
    std::size_t count = 0;
  };

  void take_window(const FlightSignals& signals, const std::vector<std::size_t>& rows,
                   std::vector<FlightChange>& found);
  void take(std::size_t index, const FlightSignals& signals, const std::vector<std::size_t>& grid_points,
            std::vector<FlightChange>& found);
  void take_row(std::size_t index, double time, std::span<const double> x, double z, Eigen::MatrixXd W,
                std::vector<FlightChange>& found);
  void begin(std::size_t index, std::vector<FlightChange>& found);

  Subject subject_;
  TrackOptions options_;
  double min_airspeed_;
  std::optional<estimation::Estimate> start_;
  std::vector<TrackedCoefficient> coefficients_;
  std::vector<Learning> learning_;
  std::vector<double> moment_rows_;  ///< behind `regressor_moment`
  std::vector<FlightChange> changes_;
  std::size_t rows_ = 0;
  double last_;
  double window_;
  double rate_ = 0.0;
  bool obstacles_known_ = false;
};

/// Seconds at either end of signals whose filters still see the end.
[[nodiscard]] double filter_margin(const FlightSignals& signals);

}  // namespace veridyn::aircraft
