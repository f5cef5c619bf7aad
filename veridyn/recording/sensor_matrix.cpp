#include "veridyn/recording/sensor_matrix.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/recording/consistency.hpp"

namespace veridyn::recording {
namespace {

using estimation::Cause;
using estimation::Evidence;
using estimation::Outcome;
using estimation::row_of;

/// Over the nine elements of a gain one in a hundred clean recordings would exceed these by chance alone.
using estimation::kBeyondChance;
/// Share of an axis by which it may answer another one and still be that axis.
constexpr double kOwnAxis = 0.5;

/// By how much an element is off beyond what chance explains; not at all where one of its axes did not move.
double excess(const SensorMatrix& m, Eigen::Index i, Eigen::Index j) {
  if (!m.moved[i] || !m.moved[j]) return 0.0;
  return std::max(0.0, std::abs(m.gain(i, j) - (i == j ? 1.0 : 0.0)) - kBeyondChance * m.gain_sigma(i, j));
}

struct Element {
  Eigen::Index row = 0, column = 0;
  double excess = 0.0;
};

Element worst_element(const SensorMatrix& m) {
  Element worst;
  worst.row = worst.column = std::ranges::find(m.moved, true) - m.moved.begin();
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j)
      if (const double e = excess(m, i, j); e > worst.excess) worst = {i, j, e};
  }
  return worst;
}

const std::string& axis(const SensorNames& names, Eigen::Index i) { return names.axes[i]; }

/// The axis whose truth this reading follows.
Eigen::Index followed(const SensorMatrix& m, Eigen::Index i) {
  Eigen::Index j = 0;
  // In standard errors, so that an axis that did not move does not count as followed.
  (m.gain.row(i).cwiseAbs().array() / (1.0 + m.gain_sigma.row(i).array() / kOwnAxis)).maxCoeff(&j);
  return j;
}

std::optional<GainFault> swapped_axes(const SensorMatrix& m, const SensorNames& names) {
  std::vector<std::string> pairs;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Index j = followed(m, i);
    const bool other = j != i && std::abs(m.gain(i, j)) > kOwnAxis && std::abs(m.gain(i, i)) < kOwnAxis &&
                       m.gain_sigma(i, j) < 0.1 * std::abs(m.gain(i, j));
    if (other)
      pairs.push_back(fmt::format("{} reads {}{}", axis(names, i), m.gain(i, j) < 0.0 ? "minus " : "", axis(names, j)));
  }
  if (pairs.empty()) return std::nullopt;
  return GainFault{.cause = Cause::kAxis, .axes = fmt::format("{}", fmt::join(pairs, ", "))};
}

std::optional<GainFault> wrong_signs(const SensorMatrix& m, const SensorNames& names) {
  std::vector<std::string> axes;
  for (Eigen::Index i = 0; i < 3; ++i)
    if (m.gain(i, i) < -kBeyondChance * m.gain_sigma(i, i) && m.gain(i, i) < -kOwnAxis * 0.1)
      axes.push_back(axis(names, i));
  if (axes.empty()) return std::nullopt;
  return GainFault{.cause = Cause::kSign, .axes = fmt::format("{}", fmt::join(axes, " and "))};
}

/// One factor on all axes that were moved.
std::optional<GainFault> common_unit(const SensorMatrix& m, const SensorNames& names) {
  double low = kInfinity, high = 0.0, sigma = 0.0;
  std::vector<std::string> axes;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double g = std::abs(m.gain(i, i));
    if (!m.moved[i] || !(m.gain_sigma(i, i) < 0.1 * g)) continue;
    axes.push_back(axis(names, i));
    low = std::min(low, g);
    high = std::max(high, g);
    sigma = std::max(sigma, m.gain_sigma(i, i));
  }
  if (axes.size() < 2 || !(high < 1.1 * low)) return std::nullopt;
  const double factor = 0.5 * (low + high);
  std::string unit = mistaken_unit(names.unit, factor);
  if (unit.empty()) return std::nullopt;
  return GainFault{Cause::kUnit, fmt::format("{}", fmt::join(axes, " and ")), factor, sigma, std::move(unit)};
}

/// "x 1.002 +- 0.003, z 0.998 +- 0.001", of what moved.
std::string scale_factors(const SensorMatrix& m, const SensorNames& names) {
  std::vector<std::string> each;
  for (Eigen::Index i = 0; i < 3; ++i)
    if (m.moved[i])
      each.push_back(fmt::format("{} {:.3f} +- {:.3f}", axis(names, i), m.gain(i, i), m.gain_sigma(i, i)));
  return fmt::format("{}", fmt::join(each, ", "));
}

}  // namespace

std::optional<GainFault> gain_fault(const SensorMatrix& m, const SensorNames& names, double tolerance) {
  const Element worst = worst_element(m);
  if (!(worst.excess > tolerance)) return std::nullopt;
  if (auto fault = swapped_axes(m, names)) return fault;
  if (auto fault = common_unit(m, names)) return fault;
  if (auto fault = wrong_signs(m, names)) return fault;
  const double value = m.gain(worst.row, worst.column), sigma = m.gain_sigma(worst.row, worst.column);
  if (worst.row != worst.column)
    return GainFault{
        .cause = Cause::kPlace,
        .axes = fmt::format("{} reads {:.2g} {}", axis(names, worst.row), value, axis(names, worst.column)),
        .factor = value,
        .sigma = sigma};
  std::string unit = mistaken_unit(names.unit, value);
  return GainFault{unit.empty() ? Cause::kScale : Cause::kUnit, axis(names, worst.row), value, sigma, std::move(unit)};
}

std::vector<Evidence> sensor_matrix_evidence(const SensorMatrix& m, const SensorNames& names) {
  std::vector<Evidence> rows;
  if (m.moved[0] || m.moved[1] || m.moved[2]) {
    const Element worst = worst_element(m);
    Evidence row = row_of(names.gain, names.sensor, m.gain(worst.row, worst.column) - (worst.row == worst.column),
                          m.gain_sigma(worst.row, worst.column));
    row.with("against", names.against).with("scales", scale_factors(m, names));
    if (const auto fault = gain_fault(m, names, estimation::info_of(names.gain).tolerance.high)) {
      row.cause = fault->cause;
      row.with("axes", fault->axes).with("factor", fault->factor).with("unit", fault->unit);
    }
    rows.push_back(std::move(row));
  }
  std::vector<std::string> still;
  for (std::size_t i = 0; i < 3; ++i)
    if (!m.moved[i]) still.push_back(names.axes[i]);
  if (!still.empty()) {
    Evidence row = row_of(names.gain, names.sensor, Outcome::kNotVerified);
    row.cause = Cause::kExcitation;
    row.with("against", names.against).with("axes", fmt::format("{}", fmt::join(still, " and ")));
    rows.push_back(std::move(row));
  }
  Eigen::Index i = 0;
  (m.bias.cwiseAbs() - kBeyondChance * m.bias_sigma).maxCoeff(&i);
  Evidence bias = row_of(names.bias, names.sensor, m.bias(i) / names.bias_unit, m.bias_sigma(i) / names.bias_unit);
  bias.with("axis", axis(names, i)).with("against", names.against);
  if (!bias.passed()) bias.cause = Cause::kZero;
  rows.push_back(std::move(bias));
  return rows;
}

}  // namespace veridyn::recording
