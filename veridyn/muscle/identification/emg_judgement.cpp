#include "veridyn/muscle/identification/emg_judgement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using estimation::passed_or;
using estimation::Purpose;

/// Correlation of measured and predicted moments below which they go against each other.
constexpr double kOpposite = -0.5;
/// Share of the moments' variance that the estimate leaves, from which on the EMG hardly explains them.
constexpr double kUnexplained = 0.5;
/// Share of samples at which an excitation may stand at its limit.
constexpr double kSaturated = 0.05;

/// Sums over the trained tasks of an output, about each task's own mean where `centred`.
struct Moments {
  double measured = 0.0, predicted = 0.0, cross = 0.0, error = 0.0, count = 0.0;
  [[nodiscard]] double correlation() const {
    const double product = measured * predicted;
    return product > 0.0 ? cross / std::sqrt(product) : kNaN;
  }
};

Moments moments_of(const EmgFindings& f, Eigen::Index output, bool of_standard) {
  double sum_z = 0.0, sum_y = 0.0, count = 0.0;
  const auto for_each = [&](const auto& use) {
    for (const TaskOutcome& t : f.tasks) {
      const estimation::RowMatrix& y = of_standard ? t.standard : t.estimated;
      if (t.hold_out || y.size() == 0) continue;
      for (Eigen::Index k = 0; k < y.rows(); ++k)
        if (!std::isnan(t.measured(k, output))) use(t.measured(k, output), y(k, output));
    }
  };
  for_each([&](double z, double y) {
    sum_z += z;
    sum_y += y;
    count += 1.0;
  });
  Moments m{.count = count};
  for_each([&](double z, double y) {
    const double a = z - sum_z / count, b = y - sum_y / count;
    m.measured += a * a;
    m.predicted += b * b;
    m.cross += a * b;
    m.error += (y - z) * (y - z);
  });
  return m;
}

/// One row for all moments: the worst decides.
Evidence check_sign(const EmgFindings& f) {
  Evidence row{.name = "sign of the moments",
               .value = kNaN,
               .limit = kOpposite,
               .scale = "correlation with the standard model's",
               .bears_on = Purpose::kData | Purpose::kParameters | Purpose::kPrediction};
  std::vector<std::string> opposite;
  for (std::size_t o = 0; o < f.outputs.size(); ++o) {
    if (f.outputs[o].kind != MuscleOutputKind::kMoment) continue;
    const double correlation = moments_of(f, o, true).correlation();
    if (std::isnan(correlation)) continue;
    if (std::isnan(row.value) || correlation < row.value) row.value = correlation;
    if (correlation < kOpposite) opposite.push_back(std::string(f.model.outputs()[o].name));
  }
  if (std::isnan(row.value)) {
    row.outcome = Outcome::kNotVerified;
    row.text = "no moment was measured that changes";
    return row;
  }
  row.outcome = passed_or(opposite.empty(), Outcome::kFailed);
  row.text = opposite.empty()
                 ? "measured moments go with what the standard model's muscles make of the EMG"
                 : fmt::format(
                       "{} measured against what the muscles make of the EMG (correlation {:.2f}): the sign of "
                       "the moments is the other way round, or electrodes of flexors and extensors are swapped",
                       fmt::join(opposite, ", "), row.value);
  if (!opposite.empty())
    row.advice =
        "moments are those of OpenSim's inverse dynamics, positive where the coordinate grows; check "
        "[emg.columns]";
  return row;
}

Evidence check_explained(const EmgFindings& f) {
  Evidence row{.name = "what the EMG explains",
               .value = 1.0,
               .limit = 1.0 - kUnexplained,
               .scale = "share of the measured variance",
               .bears_on = Purpose::kParameters | Purpose::kPrediction};
  std::string worst;
  for (std::size_t o = 0; o < f.outputs.size(); ++o) {
    const Moments m = moments_of(f, o, false);
    if (!(m.measured > 0.0)) continue;
    const double share = 1.0 - m.error / m.measured;
    if (!worst.empty() && share >= row.value) continue;
    row.value = share;
    worst = f.model.outputs()[o].name;
  }
  row.outcome = passed_or(row.value >= row.limit, Outcome::kCare);
  row.text = fmt::format("with the estimate the recorded EMG explains {:.0f} % of what is measured{}",
                         100.0 * std::max(0.0, row.value), worst.empty() ? "" : " (least of " + worst + ")");
  if (!row.passed()) {
    row.text += ": most of it comes from something else, or the recordings do not belong together";
    row.advice = "check clocks, electrodes, and whether the model has the muscles that move this joint";
  }
  return row;
}

Evidence check_saturation(const EmgFindings& f) {
  double most = 0.0;
  std::string where;
  for (std::size_t s = 0; s < f.model.segments(); ++s) {
    const std::vector<double> share = f.model.saturation(s, f.theta);
    for (std::size_t m = 0; m < share.size(); ++m) {
      if (share[m] <= most) continue;
      most = share[m];
      where = fmt::format("{} in {}", f.system.model().muscles[m].name(), f.model.segment_name(s));
    }
  }
  Evidence row{.name = "excitations beyond the maximum",
               .outcome = passed_or(most <= kSaturated, Outcome::kCare),
               .value = most,
               .limit = kSaturated,
               .scale = "share of samples",
               .text = "gain times EMG stays within 0 .. 1",
               .bears_on = Purpose::kParameters};
  if (most > 0.0)
    row.text = fmt::format("gain times EMG is above 1, where it is cut off, in {:.2g} % of the samples ({})",
                           100.0 * most, where);
  if (!row.passed())
    row.advice =
        "the EMG's maximum is not that of a maximum contraction, or the muscle is stronger than the model's: "
        "estimate max_isometric_force in place of the gain";
  return row;
}

Evidence check_error(const EmgFindings& f) {
  Evidence row{.name = "error of the EMG",
               .value = f.error.relative,
               .limit = kNaN,
               .scale = "of its value",
               .bears_on = Purpose::kParameters};
  if (f.error.any()) {
    row.text = fmt::format("intervals hold the error of {:.3g} % that is stated of the envelopes, alike over {:.2g} s",
                           100.0 * f.error.relative, 2.0 * f.error.spacing());
    return row;
  }
  row.outcome = Outcome::kCare;
  row.text = "the EMG is taken as exact: what its error makes of the moments is in no interval";
  row.advice = "state it: emg.noise = \"10 %\"";
  return row;
}

}  // namespace

std::vector<Evidence> judge_emg(const EmgFindings& f) {
  return {check_sign(f), check_explained(f), check_saturation(f), check_error(f)};
}

}  // namespace veridyn::muscle
