#include "veridyn/numerics/sensitivity_indices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::numerics {
namespace {

/// View of the results by rows of the design: at A, at B, and at A with each column of B in turn.
struct Rows {
  std::vector<std::size_t> kept;
  const Eigen::VectorXd* y = nullptr;
  std::size_t samples = 0;

  [[nodiscard]] double A(std::size_t row) const { return (*y)(row); }
  [[nodiscard]] double B(std::size_t row) const { return (*y)(samples + row); }
  [[nodiscard]] double mixed(std::size_t input, std::size_t row) const { return (*y)((2 + input) * samples + row); }
};

/// The replicate of the sequence that a row belongs to.
std::size_t replicate_of(std::size_t row, const SensitivityOptions& options) {
  return row * options.used_replicates() / options.samples;
}

/// Sums of the estimators over the rows of one replicate.
struct ReplicateSums {
  std::size_t rows = 0;
  double variance = 0.0;
  std::vector<double> first, total;  ///< by input
};

/// Saltelli's and Jansen's estimators, summed by replicate about the mean of all rows.
std::vector<ReplicateSums> sums_of(const Rows& rows, double mean, std::size_t inputs,
                                   const SensitivityOptions& options) {
  std::vector<ReplicateSums> sums(options.used_replicates());
  for (ReplicateSums& s : sums) {
    s.first.assign(inputs, 0.0);
    s.total.assign(inputs, 0.0);
  }
  for (const std::size_t r : rows.kept) {
    ReplicateSums& s = sums[replicate_of(r, options)];
    const double a = rows.A(r) - mean, b = rows.B(r) - mean;
    ++s.rows;
    s.variance += 0.5 * (a * a + b * b);
    for (std::size_t i = 0; i < inputs; ++i) {
      const double m = rows.mixed(i, r) - mean;
      // The mean is taken off: without it the products' own variance would hide small indices.
      s.first[i] += b * (m - a);
      s.total[i] += 0.5 * (a - m) * (a - m);
    }
  }
  std::erase_if(sums, [](const ReplicateSums& s) { return s.rows == 0; });
  return sums;
}

/// A ratio of two sums over replicates with its interval.
struct Ratio {
  double value = 0.0, low = 0.0, high = 0.0;
};

/// The ratio of sums of `part` and variance; the interval is Student's for the spread of the replicates, linear in
/// their deviations.
template <typename Part>
Ratio ratio_of(const std::vector<ReplicateSums>& sums, const Part& part, double level) {
  double above = 0.0, below = 0.0, squares = 0.0;
  for (const ReplicateSums& s : sums) {
    above += part(s);
    below += s.variance;
  }
  if (!(below > 0.0)) return {};
  const double value = above / below;
  for (const ReplicateSums& s : sums) squares += std::pow((part(s) - value * s.variance) / below, 2);
  const auto n = static_cast<double>(sums.size());
  if (n < 2.0) return {value, kNaN, kNaN};
  const double half = student_t_quantile(0.5 * (1.0 + level), n - 1.0) * std::sqrt(n / (n - 1.0) * squares);
  return {value, value - half, value + half};
}

std::vector<std::uint64_t> random_shift(std::size_t dimensions, RandomStream& random) {
  std::vector<std::uint64_t> shift(dimensions);
  for (std::uint64_t& s : shift) s = random.index(std::uint64_t{1} << 32) << 32 | random.index(std::uint64_t{1} << 32);
  return shift;
}

/// Points whose bits are exchanged where those of `shift` are set, by dimension.
Eigen::MatrixXd shifted_sobol_points(std::size_t points, const std::vector<std::uint64_t>& shift) {
  constexpr std::size_t kMostDimensions = 1000;
  if (shift.empty() || shift.size() > kMostDimensions)
    throw InputError("sobol sequence", fmt::format("{} dimensions; must be 1 to {}", shift.size(), kMostDimensions));
  boost::random::sobol sequence(shift.size());
  Eigen::MatrixXd x(points, shift.size());
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    for (Eigen::Index j = 0; j < x.cols(); ++j) {
      // The sequence's first point, the origin, which Boost leaves out: without it 2^m points are not balanced.
      const std::uint64_t point = i == 0 ? 0 : sequence();
      const std::uint64_t bits = point ^ shift[j];
      x(i, j) = static_cast<double>(bits >> 11) * 0x1.0p-53;
    }
  }
  return x;
}

}  // namespace

void SensitivityOptions::validate() const {
  if (samples < 2) throw InputError("sensitivity.samples", fmt::format("is {}; must be >= 2", samples));
  if (replicates < 2) throw InputError("sensitivity.replicates", fmt::format("is {}; must be >= 2", replicates));
  if (!(level > 0.0 && level < 1.0))
    throw InputError("sensitivity.level", fmt::format("is {}; must be in (0, 1)", level));
}

std::size_t SensitivityOptions::used_replicates() const {
  constexpr std::size_t kLeastRows = 4;
  return std::clamp<std::size_t>(samples / kLeastRows, 2, replicates);
}

Eigen::MatrixXd sobol_points(std::size_t points, std::size_t dimensions, std::uint64_t seed) {
  RandomStream random(seed, "digital shift of a Sobol sequence");
  return shifted_sobol_points(points, random_shift(dimensions, random));
}

Eigen::MatrixXd plain_sobol_points(std::size_t points, std::size_t dimensions) {
  return shifted_sobol_points(points, std::vector<std::uint64_t>(dimensions, 0));
}

Eigen::MatrixXd variance_design(std::size_t inputs, const SensitivityOptions& options) {
  options.validate();
  const auto k = static_cast<Eigen::Index>(inputs), n = static_cast<Eigen::Index>(options.samples);
  Eigen::MatrixXd both(n, 2 * k);
  RandomStream random(options.seed, "digital shifts of replicates of a Sobol sequence");
  for (std::size_t from = 0; from < options.samples;) {
    std::size_t end = from;
    while (end < options.samples && replicate_of(end, options) == replicate_of(from, options)) ++end;
    both.middleRows(from, end - from) = shifted_sobol_points(end - from, random_shift(2 * inputs, random));
    from = end;
  }
  Eigen::MatrixXd design(n * (k + 2), k);
  design.topRows(n) = both.leftCols(k);
  design.middleRows(n, n) = both.rightCols(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    design.middleRows((2 + i) * n, n) = both.leftCols(k);
    design.block((2 + i) * n, i, n, 1) = both.col(k + i);
  }
  return design;
}

SensitivityIndices variance_indices(const Eigen::VectorXd& results, std::size_t inputs,
                                    const SensitivityOptions& options) {
  options.validate();
  const std::size_t expected = options.samples * (inputs + 2);
  if (static_cast<std::size_t>(results.size()) != expected)
    throw InputError("sensitivity indices", fmt::format("{} results for a design of {}", results.size(), expected));
  Rows rows{{}, &results, options.samples};
  for (std::size_t r = 0; r < options.samples; ++r) {
    bool finite = std::isfinite(rows.A(r)) && std::isfinite(rows.B(r));
    for (std::size_t i = 0; i < inputs; ++i) finite = finite && std::isfinite(rows.mixed(i, r));
    if (finite) rows.kept.push_back(r);
  }
  if (rows.kept.size() < 2)
    throw InputError("sensitivity indices",
                     fmt::format("of {} rows {} have finite results; needs 2", options.samples, rows.kept.size()));
  SensitivityIndices result;
  result.evaluations = expected;
  result.dropped = options.samples - rows.kept.size();
  for (const std::size_t r : rows.kept)
    result.mean += 0.5 * (rows.A(r) + rows.B(r)) / static_cast<double>(rows.kept.size());
  const std::vector<ReplicateSums> sums = sums_of(rows, result.mean, inputs, options);
  for (const ReplicateSums& s : sums) result.variance += s.variance / static_cast<double>(rows.kept.size());
  for (std::size_t i = 0; i < inputs; ++i) {
    const Ratio first = ratio_of(
        sums, [&](const ReplicateSums& s) { return s.first[i]; }, options.level);
    const Ratio total = ratio_of(
        sums, [&](const ReplicateSums& s) { return s.total[i]; }, options.level);
    result.inputs.push_back({first.value, total.value, first.low, first.high, total.low, total.high});
  }
  return result;
}

Eigen::MatrixXd morris_design(std::size_t inputs, std::size_t trajectories, std::size_t levels, std::uint64_t seed) {
  if (inputs < 1 || trajectories < 1) throw InputError("morris", "needs at least one input and one trajectory");
  if (levels < 2 || levels % 2 != 0)
    throw InputError("morris.levels", fmt::format("is {}; must be even and at least 2", levels));
  RandomStream random(seed, "trajectories of Morris");
  const double spacing = 1.0 / static_cast<double>(levels - 1);
  const double step = 0.5 * static_cast<double>(levels) * spacing;
  Eigen::MatrixXd design(trajectories * (inputs + 1), static_cast<Eigen::Index>(inputs));
  std::vector<std::size_t> order(inputs);
  for (std::size_t t = 0; t < trajectories; ++t) {
    auto row = static_cast<Eigen::Index>(t * (inputs + 1));
    for (std::size_t i = 0; i < inputs; ++i) {
      order[i] = i;
      // Of the lower half of the grid, so that a step up stays inside; half of the walks' inputs step down instead.
      const double low = static_cast<double>(random.index(levels / 2)) * spacing;
      design(row, i) = random.index(2) == 0 ? low : low + step;
    }
    for (std::size_t i = inputs; i-- > 1;) std::swap(order[i], order[random.index(i + 1)]);
    for (const std::size_t i : order) {
      design.row(row + 1) = design.row(row);
      ++row;
      design(row, i) += design(row, i) < 0.5 ? step : -step;
    }
  }
  return design;
}

std::vector<MorrisEffect> morris_effects(const Eigen::MatrixXd& design, const Eigen::VectorXd& results) {
  const Eigen::Index k = design.cols(), walks = k > 0 ? design.rows() / (k + 1) : 0;
  if (design.rows() != results.size() || walks * (k + 1) != design.rows())
    throw InputError("morris", fmt::format("{} results for a design of {} points", results.size(), design.rows()));
  std::vector<std::vector<double>> effects(static_cast<std::size_t>(k));
  for (Eigen::Index w = 0; w < walks; ++w) {
    const Eigen::Index first = w * (k + 1);
    if (!results.segment(first, k + 1).allFinite()) continue;
    for (Eigen::Index row = first; row < first + k; ++row) {
      Eigen::Index moved = 0;
      (design.row(row + 1) - design.row(row)).cwiseAbs().maxCoeff(&moved);
      const double step = design(row + 1, moved) - design(row, moved);
      effects[moved].push_back((results(row + 1) - results(row)) / step);
    }
  }
  std::vector<MorrisEffect> result(effects.size());
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const auto n = static_cast<double>(effects[i].size());
    for (const double e : effects[i]) {
      result[i].mean += e / n;
      result[i].absolute += std::abs(e) / n;
    }
    for (const double e : effects[i]) result[i].sd += std::pow(e - result[i].mean, 2) / std::max(1.0, n - 1.0);
    result[i].sd = std::sqrt(result[i].sd);
  }
  return result;
}

}  // namespace veridyn::numerics
