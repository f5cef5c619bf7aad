#include "veridyn/muscle/sensitivity/muscle_sampling.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/numerics/moments.hpp"
#include "veridyn/numerics/sensitivity_indices.hpp"

namespace veridyn::muscle {
namespace {

constexpr std::array<const char*, 3> kSampledFields = {"max_isometric_force", "optimal_fiber_length",
                                                       "tendon_slack_length"};
constexpr auto kFieldCount = signed_index(kSampledFields.size());

/// A row for each muscle and sample: factors of all muscles, 1 but for this one's.
Eigen::MatrixXd sampled_points(Eigen::Index muscles, const MuscleSamplingOptions& options) {
  const Eigen::MatrixXd unit = options.scrambled
                                   ? numerics::sobol_points(options.samples, kSampledFields.size(), options.seed)
                                   : numerics::plain_sobol_points(options.samples, kSampledFields.size());
  const Eigen::MatrixXd factors = (1.0 + options.range * (2.0 * unit.array() - 1.0)).matrix();
  Eigen::MatrixXd points = Eigen::MatrixXd::Ones(muscles * factors.rows(), muscles * kFieldCount);
  for (Eigen::Index m = 0; m < muscles; ++m)
    points.block(m * factors.rows(), m * kFieldCount, factors.rows(), kFieldCount) = factors;
  return points;
}

}  // namespace

std::vector<MuscleUnknown> muscle_factors(const Model& model, std::size_t muscle, double range) {
  std::vector<MuscleUnknown> unknowns;
  for (const char* field : kSampledFields) {
    unknowns.push_back(make_unknown(model,
                                    {.muscles = {model.muscles[muscle].name()},
                                     .fields = {field},
                                     .factor = true,
                                     .low = Extent{-100.0 * range, true},
                                     .high = Extent{100.0 * range, true}},
                                    model.name));
  }
  return unknowns;
}

std::vector<MuscleUnknown> muscle_factors(const Model& model, double range) {
  std::vector<MuscleUnknown> all;
  for (std::size_t m = 0; m < model.muscles.size(); ++m) {
    for (MuscleUnknown& u : muscle_factors(model, m, range)) all.push_back(std::move(u));
  }
  return all;
}

MuscleSampling sample_muscles(const TaskResponses& responses, const MuscleSamplingOptions& options,
                              numerics::BlockStore& store, Progress& progress) {
  const Eigen::Index muscles = signed_index(responses.unknowns().size()) / kFieldCount;
  VERIDYN_ASSERT(muscles * kFieldCount == signed_index(responses.unknowns().size()));
  const Eigen::Index n = signed_index(options.samples), tasks = signed_index(responses.tasks());
  std::vector<std::size_t> all(responses.tasks());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto begun = std::chrono::steady_clock::now();
  const ResponseTable table = respond(responses, sampled_points(muscles, options), all, store, "sampling", progress);
  MuscleSampling sampling{.mean = Eigen::MatrixXd::Constant(muscles, tasks, kNaN),
                          .sd = Eigen::MatrixXd::Constant(muscles, tasks, kNaN),
                          .greatest = Eigen::MatrixXd::Constant(muscles, tasks, kNaN),
                          .failed = Eigen::MatrixXi::Zero(muscles, tasks),
                          .samples = options.samples,
                          .simulations = table.simulations,
                          .processor_seconds = table.processor_seconds,
                          .completed = table.completed};
  if (!table.completed) return sampling;
  for (Eigen::Index m = 0; m < muscles; ++m) {
    for (Eigen::Index t = 0; t < tasks; ++t) {
      numerics::Moments errors;
      double most = 0.0;
      for (const double e : table.nrmse.col(t).segment(m * n, n)) {
        if (!std::isfinite(e)) continue;
        errors.add(e);
        most = std::max(most, e);
      }
      sampling.failed(m, t) = static_cast<int>(static_cast<double>(n) - errors.count);
      if (errors.count == 0.0) continue;
      sampling.mean(m, t) = errors.mean();
      sampling.sd(m, t) = errors.sd();
      sampling.greatest(m, t) = most;
    }
  }
  sampling.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return sampling;
}

}  // namespace veridyn::muscle
