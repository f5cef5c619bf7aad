#include "veridyn/aircraft/identification/fit/accelerometer_place.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/regression/regression.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::RegressionEstimate;

/// CY_da of an aircraft, 1/rad: chosen; of the built-in ones 0.043 at most, of most 0.
constexpr double kSideForceOfAilerons = 0.04;

struct Height {
  double value = kNaN, sigma = kNaN;  ///< [m]
};

Height height_by_ailerons(const PreparedFlight& flight, const Subject& subject) {
  const CoefficientModel* model = subject.model.find(Coefficient::kCY);
  if (model == nullptr || !identification_obstacle(*model, flight.signals, subject).empty()) return {};
  const auto aileron = std::ranges::find_if(
      model->terms, [](const Term& term) { return term.uses(AeroVariable::kDa) && term.expression == "da"; });
  if (aileron == model->terms.end()) return {};
  const Eigen::Index place = aileron - model->terms.begin();
  const auto of = [&](const FlightSignals& signals) {
    estimation::RegressionData data =
        coefficient_data(*model, signals, flight.segments.of(Axis::kLateral).excited, subject);
    if (data.rows() < 20 * data.parameters()) return RegressionEstimate{};
    return estimation::estimate(data, estimation::Method::kOls);
  };
  constexpr double kStep_m = 0.05;
  const RegressionEstimate as_is = of(flight.signals);
  const RegressionEstimate moved =
      of(with_error(flight.signals, BudgetSensor::kAccelerometer, SensorErrorKind::kPlaceZ, kStep_m));
  if (!as_is.usable() || !moved.usable()) return {};
  const double per_metre = (moved.theta(place) - as_is.theta(place)) / kStep_m;
  if (per_metre == 0.0) return {};
  return {as_is.theta(place) / per_metre,
          std::hypot(std::sqrt(as_is.covariance(place, place)), kSideForceOfAilerons) / std::abs(per_metre)};
}

}  // namespace

std::vector<SensorError> accelerometer_place(const PreparedFlight& flight, const Subject& subject,
                                             const KnownSensors& known) {
  using enum SensorErrorKind;
  const Height height = height_by_ailerons(flight, subject);
  std::vector<SensorError> errors;
  for (const SensorErrorKind kind : {kPlaceX, kPlaceY, kPlaceZ})
    errors.push_back(prior_of(BudgetSensor::kAccelerometer, kind, known));
  errors.back() = updated(errors.back(), height.value, height.sigma);
  return errors;
}

}  // namespace veridyn::aircraft
