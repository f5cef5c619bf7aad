#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::aircraft {

/// Which part of the excited segments rows are taken from.
enum class RowUse { kIdentification, kHoldout, kExcited };

/// The spans of an axis for a use.
[[nodiscard]] std::span<const TimeSpan> spans_of(const AxisSegments& axis, RowUse use);

/// Rows of one coefficient's regression from several flights, one flight after the other.
struct FlightRows {
  estimation::RegressionData data;  ///< no segment reaches from one flight into the next
  std::vector<Eigen::Index> first;  ///< of each flight, and the number of all

  [[nodiscard]] Eigen::Index rows_of(std::size_t flight) const { return first[flight + 1] - first[flight]; }
  /// Flights with rows.
  [[nodiscard]] std::size_t flights() const;
  /// The rows of one flight alone, with the errors of all.
  [[nodiscard]] estimation::RegressionData of(std::size_t flight) const;
};

/// The rows of a coefficient's model, those of every flight as `coefficient_data` makes them. Flights that lack a
/// signal that the model needs have none. The error covariance is the mean over all rows.
/// @param replaced  signals of one flight in place of its own; null: none are
/// @param errors    the error covariance where it is known; null: it is computed
[[nodiscard]] FlightRows coefficient_rows(const CoefficientModel& model, std::span<const PreparedFlight> flights,
                                          RowUse use, const Subject& subject, const PreparedFlight* replaced = nullptr,
                                          const FlightSignals* by = nullptr, const Eigen::MatrixXd* errors = nullptr);

/// Why the coefficient can be computed from the signals of no flight, as of the first usable one; or empty.
[[nodiscard]] std::string identification_obstacle(const CoefficientModel& model,
                                                  std::span<const PreparedFlight> flights, const Subject& subject);

/// How the segments of an axis were found, each flight's in turn; where there are several, by name.
[[nodiscard]] std::string segments_text(std::span<const PreparedFlight> flights, Axis axis);

/// Whether a flight has excited segments of an axis.
[[nodiscard]] bool any_excited(std::span<const PreparedFlight> flights, Axis axis);

}  // namespace veridyn::aircraft
