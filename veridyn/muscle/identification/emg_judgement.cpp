#include "veridyn/muscle/identification/emg_judgement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::muscle {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::info_of;
using estimation::Outcome;
using estimation::passed_or;
using estimation::row_of;

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
  double worst = kNaN;
  std::vector<std::string> opposite;
  for (std::size_t o = 0; o < f.outputs.size(); ++o) {
    if (f.outputs[o].kind != MuscleOutputKind::kMoment) continue;
    const double correlation = moments_of(f, o, true).correlation();
    if (std::isnan(correlation)) continue;
    if (std::isnan(worst) || correlation < worst) worst = correlation;
    if (correlation < info_of(Check::kMomentSign).tolerance.lowest)
      opposite.push_back(std::string(f.model.outputs()[o].name));
  }
  if (std::isnan(worst)) return row_of(Check::kMomentSign, "", Outcome::kNotVerified);
  Evidence row = row_of(Check::kMomentSign, "", worst);
  if (!row.passed()) row.cause = Cause::kSign;
  return std::move(row).with("outputs", fmt::format("{}", fmt::join(opposite, ", ")));
}

Evidence check_explained(const EmgFindings& f) {
  double least = kNaN;
  std::string output;
  for (std::size_t o = 0; o < f.outputs.size(); ++o) {
    const Moments m = moments_of(f, o, false);
    const double share = 1.0 - m.error / m.measured;
    if (!(m.measured > 0.0) || share >= least) continue;
    least = share;
    output = f.model.outputs()[o].name;
  }
  Evidence row = row_of(Check::kExplainedByEmg, "", least);
  if (!row.passed()) row.cause = Cause::kMissingTerm;
  return std::move(row).with("output", output);
}

Evidence check_saturation(const EmgFindings& f) {
  double most = 0.0;
  std::string muscle, task;
  for (std::size_t s = 0; s < f.model.segments(); ++s) {
    const std::vector<double> share = f.model.saturation(s, f.theta);
    for (std::size_t m = 0; m < share.size(); ++m) {
      if (share[m] <= most) continue;
      most = share[m];
      muscle = f.system.model().muscles[m].name();
      task = f.model.segment_name(s);
    }
  }
  Evidence row = row_of(Check::kBeyondMaximum, "", most);
  if (!row.passed()) row.cause = Cause::kSaturation;
  return std::move(row).with("muscle", muscle).with("task", task);
}

Evidence check_error(const EmgFindings& f) {
  Evidence row = row_of(Check::kEmgError, "", passed_or(f.error.any(), Outcome::kCare));
  row.value = f.error.relative;
  if (!row.passed()) row.cause = Cause::kMissing;
  return std::move(row).with("alike_s", f.error.slow_s);
}

Evidence check_error_found(const EmgFindings& f) {
  if (!f.error.any()) return row_of(Check::kEmgErrorFound, "", Outcome::kNotVerified);
  Evidence row = row_of(Check::kEmgErrorFound, "", f.error_factors.norm());
  if (!row.passed()) row.cause = Cause::kMissingTerm;
  return row;
}

}  // namespace

std::vector<Evidence> judge_emg(const EmgFindings& f) {
  return {check_sign(f), check_explained(f), check_saturation(f), check_error(f), check_error_found(f)};
}

}  // namespace veridyn::muscle
