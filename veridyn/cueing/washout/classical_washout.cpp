#include "veridyn/cueing/washout/classical_washout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

using numerics::TransferFunction;
using recording::MotionSample;

/// 1 / (s^2 + 2 zeta w s + w^2): a high-pass of second order, twice integrated.
TransferFunction twice_integrated(double omega, double zeta) {
  return {{1.0}, {1.0, 2.0 * zeta * omega, omega * omega}};
}

/// s / (s^2 + 2 zeta w s + w^2): the same, once.
TransferFunction once_integrated(double omega, double zeta) {
  return {{1.0, 0.0}, {1.0, 2.0 * zeta * omega, omega * omega}};
}

TransferFunction also_recentred(const TransferFunction& t, double omega) {
  return omega > 0.0 ? t * numerics::high_pass(omega) : t;
}

double step_towards(double from, double to, double most) { return from + std::clamp(to - from, -most, most); }

std::array<double, 3> three(const StudyTable& table, std::string_view key, std::string_view unit,
                            const std::array<double, 3>& otherwise) {
  if (!table.has(key)) return otherwise;
  const std::vector<double> values = table.numbers(key, unit);
  if (values.size() != 3) table.fail(key, fmt::format("has {} values; takes three", values.size()));
  return {values[0], values[1], values[2]};
}

}  // namespace

ClassicalOptions ClassicalOptions::read(const StudyTable& table) {
  ClassicalOptions o;
  o.force_gain = three(table, "force_gain", "1", o.force_gain);
  o.rate_gain = three(table, "rate_gain", "1", o.rate_gain);
  o.onset = three(table, "onset", "rad/s", o.onset);
  o.recentre = three(table, "recentre", "rad/s", o.recentre);
  o.tilt = table.number_or("tilt", "rad/s", o.tilt);
  o.tilt_rate = table.number_or("tilt_rate", "rad/s", o.tilt_rate);
  o.turn = three(table, "turn", "rad/s", o.turn);
  o.zeta = table.number_or("zeta", "1", o.zeta);
  o.validate();
  return o;
}

void ClassicalOptions::validate() const {
  const auto check = [](const char* key, double value, bool zero) {
    if (!(std::isfinite(value) && (value > 0.0 || (zero && value == 0.0))))
      throw InputError(fmt::format("washout.{}", key),
                       fmt::format("is {}; must be {} 0", value, zero ? "at least" : "above"));
  };
  for (std::size_t i = 0; i < 3; ++i) {
    check("force_gain", force_gain[i], true);
    check("rate_gain", rate_gain[i], true);
    check("onset", onset[i], false);
    check("recentre", recentre[i], true);
    check("turn", turn[i], false);
  }
  check("tilt", tilt, false);
  check("tilt_rate", tilt_rate, false);
  check("zeta", zeta, false);
}

ClassicalWashout::Channel ClassicalWashout::shift_channel(const ClassicalOptions& o, std::size_t axis) {
  const double omega = o.onset[axis], recentre = o.recentre[axis];
  return {Filter(also_recentred(twice_integrated(omega, o.zeta), recentre)),
          Filter(also_recentred(numerics::high_pass(omega, o.zeta), recentre))};
}

ClassicalWashout::Channel ClassicalWashout::turn_channel(const ClassicalOptions& o, std::size_t axis) {
  return {Filter(once_integrated(o.turn[axis], o.zeta)), Filter(numerics::high_pass(o.turn[axis], o.zeta))};
}

ClassicalWashout::ClassicalWashout(const ClassicalOptions& o)
    : options_((o.validate(), o)),
      shift_{shift_channel(o, 0), shift_channel(o, 1), shift_channel(o, 2)},
      turn_{turn_channel(o, 0), turn_channel(o, 1), turn_channel(o, 2)},
      low_pass_{Filter(numerics::low_pass(o.tilt, o.zeta)), Filter(numerics::low_pass(o.tilt, o.zeta))} {}

PlatformCommand ClassicalWashout::reset(const MotionSample& sample) {
  tilt_ = {0.0, 0.0};
  return filtered(sample, std::nullopt);
}

PlatformCommand ClassicalWashout::step(const MotionSample& sample, double step) {
  return filtered(sample, step >= 0.0 && std::isfinite(step) ? step : 0.0);
}

PlatformCommand ClassicalWashout::filtered(const MotionSample& given, std::optional<double> step) {
  const MotionSample sample = recording::in_frame(given, Frame::kFrd);
  const auto next = [&](Filter& filter, double input) {
    return step ? filter.step(input, *step) : filter.reset(input);
  };
  const Eigen::Vector3d a = recording::acceleration(sample);
  Eigen::Vector3d shift, change;
  PlatformCommand command;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    shift(axis) = next(shift_[i].place, options_.force_gain[i] * a(axis));
    change(axis) = next(shift_[i].change, options_.force_gain[i] * a(axis));
    command.angle(axis) = next(turn_[i].place, options_.rate_gain[i] * sample.rate(axis));
    command.rate(axis) = next(turn_[i].change, options_.rate_gain[i] * sample.rate(axis));
  }
  command.shift = shift_from_frd(shift);
  command.acceleration = shift_from_frd(change);
  // A force to the right is felt with the left side up, one forward with the nose up.
  const double force[2] = {-options_.force_gain[1] * sample.force.y(), options_.force_gain[0] * sample.force.x()};
  const double most = step ? options_.tilt_rate * *step : 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double before = tilt_[i];
    const double wanted = std::asin(std::clamp(next(low_pass_[i], force[i]) / kGravity, -1.0, 1.0));
    tilt_[i] = step_towards(before, wanted, most);
    command.angle(axis) += tilt_[i];
    if (step && *step > 0.0) command.rate(axis) += (tilt_[i] - before) / *step;
  }
  return command;
}

}  // namespace veridyn::cueing
