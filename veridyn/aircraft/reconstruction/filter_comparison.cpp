#include "veridyn/aircraft/reconstruction/filter_comparison.hpp"

#include <array>
#include <cmath>

#include "veridyn/aircraft/reconstruction/information_bound.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kSettle_s = 10.0;

struct Quantity {
  const char* name;   ///< in the results
  const char* truth;  ///< in the truth
};
constexpr std::array<Quantity, 6> kQuantities{{{"airspeed", "airspeed"},
                                               {"alpha", "alpha"},
                                               {"beta", "beta"},
                                               {"wind_total_north", "wind_north"},
                                               {"wind_total_east", "wind_east"},
                                               {"wind_total_down", "wind_down"}}};

struct Moments {
  double sum = 0.0, squares = 0.0, count = 0.0;
  void add(double x) {
    sum += x;
    squares += x * x;
    count += 1.0;
  }
  [[nodiscard]] double mean() const { return count > 0.0 ? sum / count : 0.0; }
  [[nodiscard]] double rms() const { return count > 0.0 ? std::sqrt(squares / count) : 0.0; }
  [[nodiscard]] double sd() const { return std::sqrt(std::max(0.0, rms() * rms() - mean() * mean())); }
};

/// Errors of a channel, and the truth that it is compared with.
struct Comparison {
  Moments errors, truth;
};

/// Against the interpolated truth.
Comparison compare_channel(const Recording& estimate, const Recording& truth, const Quantity& q) {
  Comparison comparison;
  const Channel* e = estimate.find(q.name);
  const Channel* t = truth.find(q.truth);
  if (e == nullptr || t == nullptr || t->size() < 2 || e->empty()) return comparison;
  const auto times = e->times();
  const auto true_times = t->times();
  std::size_t j = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] < times[0] + kSettle_s) continue;
    while (j + 2 < true_times.size() && true_times[j + 1] <= times[i]) ++j;
    if (true_times[j] > times[i] || true_times[j + 1] < times[i] || !std::isfinite(e->value[i])) continue;
    const double share = (times[i] - true_times[j]) / (true_times[j + 1] - true_times[j]);
    const double expected = (1.0 - share) * t->value[j] + share * t->value[j + 1];
    comparison.errors.add(e->value[i] - expected);
    comparison.truth.add(expected);
  }
  return comparison;
}

}  // namespace

std::vector<FilterError> compare_filters(const Recording& mapped, const Recording& truth,
                                         const ReconstructOptions& options, const Subject& subject,
                                         Progress& progress) {
  ReconstructOptions o = options;
  o.keep_filter = true;
  o.filter = FilterKind::kModelFree;
  const Reconstruction free = reconstruct(mapped, o, progress, &subject);
  o.filter = FilterKind::kModelBased;
  const Reconstruction based = reconstruct(mapped, o, progress, &subject);

  const auto rate_of = [&](const char* channel) {
    const Channel* c = mapped.find(channel);
    return c != nullptr ? c->rate_Hz() : 0.0;
  };
  double airspeed = 0.0, density = 1.225;
  const Channel& speed = free.smoothed.at("airspeed");
  for (const double v : speed.value) airspeed += v / static_cast<double>(speed.size());
  const Channel& rho = free.smoothed.at("air_density");
  if (!rho.empty()) density = rho.value[rho.size() / 2];
  BoundSensors sensors{
      .alpha = rate_of("alpha") > 0.0 && o.use_alpha ? free.sigma.alpha : 0.0,
      .beta = rate_of("beta") > 0.0 && o.use_beta ? free.sigma.beta : 0.0,
      .accelerometer = free.sigma.accelerometer,
      .dynamic_pressure = rate_of("dynamic_pressure") > 0.0 && o.use_pitot ? free.sigma.dynamic_pressure : 0.0,
      .rate_Hz = rate_of("accel_x")};
  InformationBound kinematic;
  if (sensors.alpha > 0.0)
    kinematic.alpha = information_bound(free.turbulence, airspeed, sensors.alpha, rate_of("alpha")).alpha;
  if (sensors.beta > 0.0)
    kinematic.beta = information_bound(free.turbulence, airspeed, sensors.beta, rate_of("beta")).beta;
  ModelBound model;
  if (!free.turbulence.calm()) model = information_bound(free.turbulence, subject, airspeed, sensors, density);

  std::vector<FilterError> result;
  for (const Quantity& q : kQuantities) {
    FilterError error;
    error.quantity = q.name;
    error.unit = std::string_view(q.name) == "alpha" || std::string_view(q.name) == "beta" ? "rad" : "m/s";
    const auto of = [&](const Reconstruction& r) {
      const Moments smoothed = compare_channel(r.smoothed, truth, q).errors;
      return FilterError::Of{.filter_rms = compare_channel(r.filtered, truth, q).errors.rms(),
                             .smoother_rms = smoothed.rms(),
                             .smoother_bias = smoothed.mean()};
    };
    error.model_free = of(free);
    error.model_based = of(based);
    error.signal_sd = compare_channel(based.smoothed, truth, q).truth.sd();
    const auto bounds = [](FilterError::Of& filter, const AngleBound& b) {
      filter.filter_bound = b.filter;
      filter.smoother_bound = b.smoother;
    };
    if (error.quantity == "alpha") bounds(error.model_free, kinematic.alpha);
    if (error.quantity == "beta") bounds(error.model_free, kinematic.beta);
    if (model.usable) {
      if (error.quantity == "alpha") bounds(error.model_based, model.angles.alpha);
      if (error.quantity == "beta") bounds(error.model_based, model.angles.beta);
      if (error.quantity == "airspeed") bounds(error.model_based, model.airspeed);
    }
    result.push_back(std::move(error));
  }
  return result;
}

}  // namespace veridyn::aircraft
