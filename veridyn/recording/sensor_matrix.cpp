#include "veridyn/recording/sensor_matrix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::recording {
namespace {

using estimation::Evidence;
using estimation::Outcome;
using estimation::Purpose;
using estimation::Tolerance;

/// Over the nine elements of a gain one in a hundred clean recordings would exceed these by chance alone.
using estimation::kBeyondChance;
/// Share of an axis by which it may answer another one and still be that axis.
constexpr double kOwnAxis = 0.5;

/// By how much an element is off beyond what chance explains.
double excess(const SensorMatrix& m, Eigen::Index i, Eigen::Index j) {
  return std::max(0.0, std::abs(m.gain(i, j) - (i == j ? 1.0 : 0.0)) - kBeyondChance * m.gain_sigma(i, j));
}

struct Element {
  Eigen::Index row = 0, column = 0;
  double excess = 0.0;
};

Element worst_element(const SensorMatrix& m) {
  Element worst;
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

std::string swapped_axes(const SensorMatrix& m, const SensorNames& names) {
  std::string text;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Index j = followed(m, i);
    const bool other = j != i && std::abs(m.gain(i, j)) > kOwnAxis && std::abs(m.gain(i, i)) < kOwnAxis &&
                       m.gain_sigma(i, j) < 0.1 * std::abs(m.gain(i, j));
    if (!other) continue;
    text += fmt::format("{}axis {} reads {}{}", text.empty() ? "" : ", ", axis(names, i),
                        m.gain(i, j) < 0.0 ? "minus " : "", axis(names, j));
  }
  return text;
}

std::string wrong_signs(const SensorMatrix& m, const SensorNames& names) {
  std::vector<std::string> axes;
  for (Eigen::Index i = 0; i < 3; ++i)
    if (m.gain(i, i) < -kBeyondChance * m.gain_sigma(i, i) && m.gain(i, i) < -kOwnAxis * 0.1)
      axes.push_back(axis(names, i));
  if (axes.empty()) return {};
  std::string list = axes.front();
  for (std::size_t k = 1; k < axes.size(); ++k) list += (k + 1 == axes.size() ? " and " : ", ") + axes[k];
  return fmt::format("the sign of {} is reversed", list);
}

/// One factor on all axes that were moved.
std::string common_factor(const SensorMatrix& m) {
  double low = kInfinity, high = 0.0;
  int axes = 0;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double g = std::abs(m.gain(i, i));
    if (!(m.gain_sigma(i, i) < 0.1 * g)) continue;
    ++axes;
    low = std::min(low, g);
    high = std::max(high, g);
  }
  if (axes < 2 || !(high < 1.1 * low)) return {};
  const std::string unit = mistaken_unit(0.5 * (low + high));
  return unit.empty() ? std::string()
                      : fmt::format("all axes read {:.3g} times the truth: {}", 0.5 * (low + high), unit);
}

}  // namespace

std::string mistaken_unit(double factor, double doubt) {
  struct Known {
    double factor;
    const char* text;
  };
  static constexpr std::array<Known, 10> kKnown{{{1.0 / kGravity, "g taken for m/s^2"},
                                                 {kGravity, "m/s^2 taken for g"},
                                                 {1.0 / kDegree, "degrees taken for radians"},
                                                 {kDegree, "radians taken for degrees"},
                                                 {3.6, "km/h taken for m/s"},
                                                 {1.0 / 3.6, "m/s taken for km/h"},
                                                 {1.9438, "knots taken for m/s"},
                                                 {0.51444, "m/s taken for knots"},
                                                 {3.2808, "feet taken for metres"},
                                                 {0.3048, "metres taken for feet"}}};
  constexpr double kNear = 0.03, kMostDoubt = 0.15;
  const auto distance = [factor](const Known& known) { return std::abs(factor / known.factor - 1.0); };
  const Known& nearest = *std::ranges::min_element(kKnown, {}, distance);
  if (distance(nearest) < std::clamp(doubt, kNear, kMostDoubt)) return nearest.text;
  for (const double power : {1e-3, 1e-2, 1e2, 1e3})
    if (std::abs(factor / power - 1.0) < 0.05) return fmt::format("a factor of {:g} between units", power);
  return {};
}

std::optional<std::string> gain_fault(const SensorMatrix& m, const SensorNames& names, double tolerance) {
  const Element worst = worst_element(m);
  if (!(worst.excess > tolerance)) return std::nullopt;
  if (const std::string text = swapped_axes(m, names); !text.empty()) return text;
  if (const std::string text = common_factor(m); !text.empty()) return text;
  if (const std::string text = wrong_signs(m, names); !text.empty()) return text;
  const double value = m.gain(worst.row, worst.column), sigma = m.gain_sigma(worst.row, worst.column);
  if (worst.row == worst.column) {
    const std::string unit = mistaken_unit(value);
    return fmt::format("axis {} reads {:.3g} +- {:.2g} times the truth{}{}", axis(names, worst.row), value, sigma,
                       unit.empty() ? "" : ": ", unit);
  }
  return fmt::format(
      "axis {} answers {:.3g} +- {:.2g} of {}: the axes of the two are {:.1f} deg apart or the sensor is "
      "cross-sensitive",
      axis(names, worst.row), value, sigma, axis(names, worst.column), std::atan(std::abs(value)) / kDegree);
}

std::vector<Evidence> sensor_matrix_evidence(const SensorMatrix& m, const SensorNames& names,
                                             const SensorTolerance& tolerance) {
  const Element worst = worst_element(m);
  const std::optional<std::string> fault = gain_fault(m, names, tolerance.gain_care);
  std::vector<Evidence> rows;
  rows.push_back(
      {.name = fmt::format("gain of the {}", names.sensor),
       .about = names.sensor,
       .outcome =
           estimation::outcome_of(worst.excess, 0.0, Tolerance::about(0.0, tolerance.gain_care, tolerance.gain_failed)),
       .value = m.gain(worst.row, worst.column),
       .limit = tolerance.gain_care,
       .scale = "reading over truth",
       .text = fault ? fmt::format("the {} contradicts {}: {}", names.sensor, names.against, *fault)
                     : fmt::format(
                           "the {} agrees with {}: scale factors {:.3f} +- {:.3f}, {:.3f} +- {:.3f}, {:.3f} +- {:.3f}",
                           names.sensor, names.against, m.gain(0, 0), m.gain_sigma(0, 0), m.gain(1, 1),
                           m.gain_sigma(1, 1), m.gain(2, 2), m.gain_sigma(2, 2)),
       .bears_on = estimation::kAllPurposes,
       .advice = fault ? fmt::format("check unit, sign, axis and calibration of the {} in [data.map]", names.sensor)
                       : std::string()});
  Eigen::Index i = 0;
  const Eigen::Vector3d off = (m.bias.cwiseAbs() - kBeyondChance * m.bias_sigma).cwiseMax(0.0);
  const double largest = off.maxCoeff(&i);
  const Outcome outcome =
      estimation::outcome_of(largest, 0.0, Tolerance::about(0.0, tolerance.bias_care, tolerance.bias_failed));
  rows.push_back(
      {.name = fmt::format("bias of the {}", names.sensor),
       .about = names.sensor,
       .outcome = outcome,
       .value = m.bias(i),
       .limit = tolerance.bias_care,
       .scale = names.unit,
       .text = outcome == Outcome::kPassed
                   ? fmt::format("the {} has no bias beyond {:.2g} {}", names.sensor, tolerance.bias_care, names.unit)
                   : fmt::format("axis {} of the {} is off by {:.2g} +- {:.1g} {} against {}", axis(names, i),
                                 names.sensor, m.bias(i), m.bias_sigma(i), names.unit, names.against),
       .bears_on = estimation::kAllPurposes,
       .advice = outcome == Outcome::kPassed
                     ? std::string()
                     : fmt::format("calibrate the {}, or let the reconstruction estimate its bias", names.sensor)});
  return rows;
}

}  // namespace veridyn::recording
