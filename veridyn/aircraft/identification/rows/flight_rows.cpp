#include "veridyn/aircraft/identification/rows/flight_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::RegressionData;

/// `part` after `whole`, its segments numbered on from there.
void append(RegressionData& whole, const RegressionData& part) {
  const Eigen::Index before = whole.rows(), count = part.rows();
  whole.regressors.conservativeResize(before + count, Eigen::NoChange);
  whole.regressors.bottomRows(count) = part.regressors;
  whole.regressand.conservativeResize(before + count);
  whole.regressand.tail(count) = part.regressand;
  const int last = whole.segment.empty() ? 0 : whole.segment.back();
  for (const int id : part.segment) whole.segment.push_back(last + id);
}

}  // namespace

std::span<const TimeSpan> spans_of(const AxisSegments& axis, RowUse use) {
  switch (use) {
    case RowUse::kIdentification:
      return axis.identification;
    case RowUse::kHoldout:
      return axis.holdout;
    case RowUse::kExcited:
      break;
  }
  return axis.excited;
}

std::size_t FlightRows::flights() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i + 1 < first.size(); ++i) count += rows_of(i) > 0 ? 1U : 0U;
  return count;
}

RegressionData FlightRows::of(std::size_t flight) const {
  RegressionData part = data;
  const Eigen::Index begin = first[flight], count = rows_of(flight);
  part.regressors = data.regressors.middleRows(begin, count);
  part.regressand = data.regressand.segment(begin, count);
  part.segment.assign(data.segment.begin() + begin, data.segment.begin() + begin + count);
  return part;
}

FlightRows coefficient_rows(const CoefficientModel& model, std::span<const PreparedFlight> flights, RowUse use,
                            const Subject& subject, const PreparedFlight* replaced, const FlightSignals* by,
                            const Eigen::MatrixXd* errors) {
  const Axis axis = axis_of(model.coefficient);
  FlightRows rows;
  rows.first.push_back(0);
  std::vector<Eigen::MatrixXd> covariances;
  for (const PreparedFlight& flight : flights) {
    const FlightSignals& signals = replaced == &flight ? *by : flight.signals;
    const bool has = flight.usable() && identification_obstacle(model, signals, subject).empty();
    const std::span<const TimeSpan> spans = has ? spans_of(flight.segments.of(axis), use) : std::span<const TimeSpan>();
    RegressionData part = coefficient_data(model, signals, spans, subject, errors);
    covariances.push_back(part.error_covariance);
    if (rows.first.size() == 1)
      rows.data = std::move(part);
    else
      append(rows.data, part);
    rows.first.push_back(rows.data.rows());
  }
  if (rows.data.rows() == 0) return rows;
  const auto n = rows.data.parameters();
  rows.data.error_covariance = Eigen::MatrixXd::Zero(n + 1, n + 1);
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    if (rows.rows_of(i) == 0) continue;
    const double share = static_cast<double>(rows.rows_of(i)) / static_cast<double>(rows.data.rows());
    rows.data.error_covariance += share * covariances[i];
  }
  return rows;
}

std::string identification_obstacle(const CoefficientModel& model, std::span<const PreparedFlight> flights,
                                    const Subject& subject) {
  std::string obstacle;
  for (const PreparedFlight& flight : flights) {
    if (!flight.usable()) continue;
    std::string of_flight = identification_obstacle(model, flight.signals, subject);
    if (of_flight.empty()) return {};
    if (obstacle.empty()) obstacle = std::move(of_flight);
  }
  return obstacle;
}

std::string segments_text(std::span<const PreparedFlight> flights, Axis axis) {
  std::string text;
  for (const PreparedFlight& flight : flights) {
    if (!flight.usable()) continue;
    if (!text.empty()) text += "; ";
    if (!flight.name.empty()) text += fmt::format("{}: ", flight.name);
    text += flight.segments.of(axis).text;
  }
  return text;
}

bool any_excited(std::span<const PreparedFlight> flights, Axis axis) {
  return std::ranges::any_of(flights, [&](const PreparedFlight& f) { return !f.segments.of(axis).excited.empty(); });
}

}  // namespace veridyn::aircraft
