#include "veridyn/vehicle/identification/structure/drive_effects.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "veridyn/numerics/modulating_kernel.hpp"
#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"

namespace veridyn::vehicle {
namespace {

/// Of each segment.
std::vector<double> means_beyond_turning(const DriveSignals& signals, std::span<const TimeSpan> spans) {
  const std::vector<double>&a = signals[DriveSignal::kAccelY].value, &r = signals[DriveSignal::kYawRate].value,
        &u = signals[DriveSignal::kSpeed].value;
  std::vector<double> means;
  for (const TimeSpan& span : spans) {
    const auto [begin, end] = signals.indices(span);
    double sum = 0.0, count = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      const double beyond = a[k] - r[k] * u[k];
      if (!std::isfinite(beyond)) continue;
      sum += beyond;
      count += 1.0;
    }
    if (count > 0.0) means.push_back(sum / count);
  }
  return means;
}

bool tells_bank(const VehicleProblem& problem) {
  if (!problem.signals[DriveSignal::kAccelY].available()) return false;
  const std::vector<double> means = means_beyond_turning(problem.signals, problem.segments.identification);
  if (means.size() < 2) return false;
  const auto [low, high] = std::ranges::minmax(means);
  return high - low > kTellingBank_mps2;
}

/// Of the identification segments, where it is a number.
std::vector<double> there(const VehicleProblem& problem, const std::vector<double>& series) {
  std::vector<double> out;
  for (const TimeSpan& span : problem.segments.identification) {
    const auto [begin, end] = problem.signals.indices(span);
    for (std::size_t k = begin; k < end; ++k)
      if (std::isfinite(series[k])) out.push_back(series[k]);
  }
  return out;
}

bool tells_downforce(const VehicleProblem& problem) {
  std::vector<double> u = there(problem, problem.signals[DriveSignal::kSpeed].value);
  if (u.empty()) return false;
  std::ranges::sort(u);
  // A twentieth to either side may be anything.
  const double slow = u[u.size() / 20], fast = u[u.size() - 1 - u.size() / 20];
  return kDownforceSigma * (fast * fast - slow * slow) > kTellingDownforce;
}

/// rms, of the axle that has more of it.
double share_moved_by_pedals(const VehicleProblem& problem) {
  const double rate_Hz = problem.signals.grid.rate_Hz();
  const numerics::ModulatingKernel kernel =
      numerics::modulating_kernel(rate_Hz, std::min(kPedalBand_Hz, 0.1 * rate_Hz));
  const std::vector<double> rate =
      there(problem, numerics::filter(problem.signals[DriveSignal::kSpeed].value, kernel.first));
  if (rate.empty()) return 0.0;
  double power = 0.0;
  for (const double x : rate) power += x * x / static_cast<double>(rate.size());
  const VehicleParameters<double>& p = problem.start;
  return std::sqrt(power) * p.cg_height / (problem.signal_options.gravity * std::min(p.a, p.b));
}

}  // namespace

DriveEffects distinguishable_effects(const VehicleProblem& problem) {
  DriveEffects effects{};
  effects[DriveEffect::kBank] = tells_bank(problem);
  effects[DriveEffect::kDownforce] = tells_downforce(problem);
  // Changes of speed are what both act through: neither is to pass for the other.
  effects[DriveEffect::kPedals] =
      share_moved_by_pedals(problem) > (effects[DriveEffect::kDownforce] ? kPedalsBesideDownforce : kTellingPedals);
  return effects;
}

}  // namespace veridyn::vehicle
