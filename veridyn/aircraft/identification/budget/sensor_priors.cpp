#include "veridyn/aircraft/identification/budget/sensor_priors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace veridyn::aircraft {
namespace {

std::string unit_of(BudgetSensor sensor, SensorErrorKind kind) {
  for (const SensorPrior& prior : sensor_priors())
    if (prior.sensor == sensor && prior.kind == kind) return std::string(prior.unit);
  return {};
}

void read_error(const StudyTable& table, BudgetSensor sensor, SensorErrorKind kind, KnownSensors& known) {
  const std::string key(kSensorErrorKindNames[kind]);
  if (!table.has(key)) return;
  if (!table.is_table(key))
    table.fail(key,
               fmt::format("is what is known of the sensor that recorded {}: {{ value = {}, sigma = ... }}; errors "
                           "of simulated sensors are in the tables of these, such as [sensors.alpha_vane]",
                           kBudgetSensorNames[sensor], kind == SensorErrorKind::kScale ? "1.0" : "0"));
  const StudyTable own = table.table(key);
  const std::string unit = unit_of(sensor, kind);
  if (unit.empty()) table.fail(key, "is not among the errors that this sensor has");
  const bool scale = kind == SensorErrorKind::kScale;
  const double value = own.number_or("value", unit, scale ? 1.0 : 0.0);
  const double sigma = own.number("sigma", unit);
  if (!(sigma >= 0.0)) own.fail("sigma", "must be >= 0");
  if (scale && !(value > 0.1)) own.fail("value", "is reading over truth and must be above 0.1");
  known.errors.push_back({sensor, kind, scale ? value - 1.0 : value, sigma});
}

KeyTable<KnownSensors> keys_of(BudgetSensor sensor) {
  std::vector<std::string_view> others(kBudgetSensorNames.begin(), kBudgetSensorNames.end());
  std::erase(others, kBudgetSensorNames[sensor]);
  KeyTable<KnownSensors> table(
      fmt::format("sensors.{}", kBudgetSensorNames[sensor]),
      fmt::format("What is known of the real sensor that recorded a channel, with one standard deviation: in place of "
                  "what is taken of ordinary ones. Likewise {}.",
                  fmt::join(others, ", ")));
  for (const SensorErrorKind kind : enumerators<SensorErrorKind, kSensorErrorKinds>()) {
    const bool of_all = kind <= SensorErrorKind::kDelay;
    const std::string unit = unit_of(sensor, kind);
    if (!of_all && unit.empty()) continue;
    const std::string_view range = kind == SensorErrorKind::kScale ? "`{ value = 1.0, sigma = 0.02 }`"
                                   : unit == "rad"                 ? "`{ value = \"0 deg\", sigma = \"0.2 deg\" }`"
                                   : unit == "s"                   ? "`{ value = \"30 ms\", sigma = \"3 ms\" }`"
                                                                   : "`{ value = 0, sigma = 0.01 }`";
    table.other({std::string(kSensorErrorKindNames[kind]), unit, std::string(range),
                 "as `veridyn priors aircraft` prints", std::string(kSensorErrorKindMeanings[kind]), true},
                [sensor, kind](const StudyTable& t, const std::string&, KnownSensors& known) {
                  read_error(t, sensor, kind, known);
                });
  }
  return table;
}

}  // namespace

const KeyTable<KnownSensors>& known_sensor_keys() {
  static const auto table = keys_of(BudgetSensor::kAlpha);
  return table;
}

KnownSensors read_known_sensors(const StudyTable& sensors) {
  KnownSensors known;
  for (const BudgetSensor sensor : enumerators<BudgetSensor, kBudgetSensors>())
    keys_of(sensor).read(sensors.table_or_empty(kBudgetSensorNames[sensor]), known);
  return known;
}

std::span<const SensorPrior> sensor_priors() {
  static constexpr auto kPriors = std::to_array<SensorPrior>({
#define VERIDYN_SENSOR_PRIOR(sensor, kind, sigma, unit, source) \
  {BudgetSensor::sensor, SensorErrorKind::kind, sigma, unit, source},
#include "veridyn/aircraft/identification/budget/sensor_priors.inc"
#undef VERIDYN_SENSOR_PRIOR
  });
  return kPriors;
}

const SensorError* KnownSensors::find(BudgetSensor sensor, SensorErrorKind kind) const {
  const auto found =
      std::ranges::find_if(errors, [&](const SensorError& e) { return e.sensor == sensor && e.kind == kind; });
  return found == errors.end() ? nullptr : &*found;
}

SensorError prior_of(BudgetSensor sensor, SensorErrorKind kind, const KnownSensors& known) {
  if (const SensorError* given = known.find(sensor, kind)) return *given;
  SensorError prior{.sensor = sensor, .kind = kind};
  for (const SensorPrior& line : sensor_priors())
    if (line.sensor == sensor && line.kind == kind) prior.sigma = line.sigma;
  return prior;
}

SensorError updated(SensorError prior, double value, double sigma) {
  if (!std::isfinite(value) || !std::isfinite(sigma) || !(prior.sigma > 0.0)) return prior;
  const double before = prior.sigma * prior.sigma, weight = before / (before + sigma * sigma);
  prior.mean += weight * (value - prior.mean);
  prior.sigma = std::sqrt(weight) * sigma;
  return prior;
}

}  // namespace veridyn::aircraft
