#include "veridyn/estimation/uncertainty/result_indices.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::estimation {
namespace {

/// A total order from which an input moves a result.
constexpr double kInfluential = 0.05;

/// Indices of a result with wide intervals.
struct WideCount {
  std::size_t indices = 0, wide = 0;
  std::size_t influential = 0;  ///< of the wide ones, those of influential inputs
  std::string names;            ///< of these inputs
};
WideCount count_wide(const ResultIndices& r, const std::vector<std::string>* inputs) {
  WideCount count;
  for (std::size_t i = 0; i < r.variance.inputs.size(); ++i) {
    const numerics::SensitivityIndex& s = r.variance.inputs[i];
    const std::size_t wide = (wide_interval(s.first, s.first_low, s.first_high) ? 1U : 0U) +
                             (wide_interval(s.total, s.total_low, s.total_high) ? 1U : 0U);
    count.indices += 2;
    count.wide += wide;
    if (wide == 0 || !(s.total >= kInfluential)) continue;
    count.influential += wide;
    if (inputs != nullptr) count.names += (count.names.empty() ? "" : ", ") + (*inputs)[i];
  }
  return count;
}

}  // namespace

const KeyTable<IndexOptions>& IndexOptions::keys() {
  using O = IndexOptions;
  constexpr long long kMaxSamples = 10000000;
  const auto variance = [](auto member) {
    return [member](O & o) -> auto& { return o.variance.*member; };
  };
  using V = numerics::SensitivityOptions;
  static const auto table =
      KeyTable<O>("sensitivity")
          .choice(
              "method", &O::method,
              {{"variance", IndexMethod::kVariance}, {"morris", IndexMethod::kMorris}, {"none", IndexMethod::kNone}},
              "`variance`: first and total order with intervals; `morris`: elementary effects, a screening at a "
              "small share of the cost")
          .count("index_samples", variance(&V::samples), 2, kMaxSamples,
                 "N of the N (inputs + 2) points at which results are needed; a power of two is best")
          .count("replicates", variance(&V::replicates), 2, kMaxSamples,
                 "independent parts of these samples, whose spread makes the intervals")
          .number("level", variance(&V::level), "1", between(0.0, 1.0), "of these intervals")
          .count("trajectories", &O::morris_trajectories, 1, kMaxSamples, "of Morris: trajectories (inputs + 1) points")
          .count("levels", &O::morris_levels, 2, kMaxSamples, "of Morris' grid; even")
          .check([](const StudyTable& t, O& o) {
            if (o.morris_levels % 2 != 0) t.fail("levels", fmt::format("= {} must be even", o.morris_levels));
          });
  return table;
}

IndexOptions read_index_options(const StudyTable& table, std::uint64_t seed) {
  IndexOptions options = IndexOptions::keys().read(table);
  options.variance.seed = seed;
  return options;
}

bool wide_interval(double index, double low, double high) { return !(high - low <= kWideInterval * std::abs(index)); }

Eigen::MatrixXd index_design(std::size_t inputs, const IndexOptions& options) {
  switch (options.method) {
    case IndexMethod::kVariance:
      return numerics::variance_design(inputs, options.variance);
    case IndexMethod::kMorris:
      return numerics::morris_design(inputs, options.morris_trajectories, options.morris_levels, options.variance.seed);
    case IndexMethod::kNone:
      break;
  }
  return Eigen::MatrixXd(0, inputs);
}

ResultIndices result_indices(std::string result, const Eigen::VectorXd& values, const Eigen::MatrixXd& design,
                             const IndexOptions& options, std::vector<std::string>& warnings) {
  ResultIndices r{.result = std::move(result)};
  for (const double v : values) r.failed += std::isfinite(v) ? 0U : 1U;
  if (options.method == IndexMethod::kMorris) {
    r.morris = numerics::morris_effects(design, values);
    return r;
  }
  try {
    r.variance = numerics::variance_indices(values, at(design.cols()), options.variance);
  } catch (const InputError&) {
    warnings.push_back(
        fmt::format("{}: no indices, {} of {} points could not be simulated", r.result, r.failed, values.size()));
  }
  return r;
}

std::string wide_interval_warning(const ResultIndices& r, const std::vector<std::string>& inputs, std::size_t samples) {
  const WideCount wide = count_wide(r, &inputs);
  if (wide.wide == 0) return {};
  std::string text = fmt::format("{}: {} of {} indices have an interval wider than {:g} % of the index", r.result,
                                 wide.wide, wide.indices, 100.0 * kWideInterval);
  if (!wide.names.empty()) text += fmt::format(", of influential inputs {}", wide.names);
  return text + fmt::format("; with {} instead of {} samples they are half as wide or less", 4 * samples, samples);
}

std::string wide_interval_warning(std::span<const ResultIndices> results, std::size_t samples) {
  WideCount sum;
  for (const ResultIndices& r : results) {
    const WideCount one = count_wide(r, nullptr);
    sum.indices += one.indices;
    sum.wide += one.wide;
    sum.influential += one.influential;
  }
  if (sum.wide == 0) return {};
  return fmt::format(
      "{} of {} indices have an interval wider than {:g} % of the index, {} of them of inputs that move their result "
      "by {:g} % or more; with {} instead of {} samples intervals are half as wide or less",
      sum.wide, sum.indices, 100.0 * kWideInterval, sum.influential, 100.0 * kInfluential, 4 * samples, samples);
}

}  // namespace veridyn::estimation
