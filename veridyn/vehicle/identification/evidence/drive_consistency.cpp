#include "veridyn/vehicle/identification/evidence/drive_consistency.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;
using estimation::row_of;
using recording::ChannelFault;
using recording::ChannelRelation;
using enum recording::InertialChannel;

recording::DriveMotion motion_of(const recording::MappedRecording& mapped, const DriveSignals& signals) {
  recording::DriveMotion motion{.grid = signals.grid};
  motion.names[kGyroZ] = "yaw_rate";
  constexpr std::array<std::pair<recording::InertialChannel, DriveSignal>, 8> kSame{{{kAccelX, DriveSignal::kAccelX},
                                                                                     {kAccelY, DriveSignal::kAccelY},
                                                                                     {kGyroZ, DriveSignal::kYawRate},
                                                                                     {kYaw, DriveSignal::kYaw},
                                                                                     {kSpeed, DriveSignal::kSpeed},
                                                                                     {kSteer, DriveSignal::kSteer},
                                                                                     {kPosX, DriveSignal::kX},
                                                                                     {kPosY, DriveSignal::kY}}};
  const auto find = [&](std::string_view name) {
    const Channel* channel = mapped.recording.find(name);
    return channel != nullptr && channel->size() > 1 ? channel : nullptr;
  };
  for (const auto& [to, from] : kSame) {
    if (!signals[from].available()) continue;
    motion.signals[to] = signals[from].value;
    if (const Channel* channel = find(kDriveSignalNames[from])) motion.take_unit(to, *channel);
  }
  if (const Channel* gyro = find("gyro_z")) motion.take_unit(kGyroZ, *gyro);
  if (const Channel* up = find("accel_z")) {
    motion.signals[kAccelZ] = recording::on_grid(*up, motion.grid);
    motion.take_unit(kAccelZ, *up);
  }
  if (const Channel* course = find("course"); course != nullptr && !motion.has(kYaw)) {
    motion.signals[kYaw] = recording::angle_on_grid(*course, motion.grid);
    motion.take_unit(kYaw, *course);
    motion.course_for_yaw = true;
    motion.names[kYaw] = "course";
  }
  return motion;
}

bool touches(const ChannelFault& fault, const ChannelRelation& relation) {
  return std::ranges::any_of(fault.channels, [&](auto channel) { return relation.power[channel] != 0; });
}

/// Whether the lean that the model knows is what accel_y reads too much.
bool is_lean(const ChannelRelation& r, std::optional<double> roll_gradient, double gravity) {
  // What the sideslip's approximation leaves of the ratio.
  constexpr double kModelError = 0.05;
  return r.check == Check::kLateralAcceleration && roll_gradient && r.outcome() == Outcome::kCare &&
         std::abs(r.middle() - 1.0 - gravity * *roll_gradient) < kModelError;
}

std::string joined(const std::vector<recording::InertialChannel>& channels, const recording::ChannelNames& names) {
  std::vector<std::string_view> said;
  for (const auto channel : channels) said.push_back(names[channel]);
  return fmt::format("{}", fmt::join(said, ", "));
}

/// The relations that are off and that no lean explains.
std::vector<const ChannelRelation*> off_in(const DriveConsistency& drive, std::optional<double> roll_gradient,
                                           double gravity) {
  std::vector<const ChannelRelation*> off;
  for (const ChannelRelation& r : drive.found.relations)
    if (r.outcome() != Outcome::kPassed && !is_lean(r, roll_gradient, gravity)) off.push_back(&r);
  return off;
}

Outcome worst_of(const ChannelFault& fault, const std::vector<const ChannelRelation*>& off) {
  Outcome worst = Outcome::kPassed;
  for (const ChannelRelation* r : off)
    if (touches(fault, *r)) worst = std::max(worst, r->outcome());
  return worst;
}

Evidence fault_row(const ChannelFault& fault, Outcome outcome, const DriveConsistency& drive, double gravity) {
  Evidence row =
      row_of(fault.hand_wheel ? Check::kHandWheel : Check::kWrongChannel, joined(fault.channels, drive.names), outcome);
  const bool leans = fault.cause == Cause::kMissingTerm && fault.factor > 1.0 && !drive.gravity_removed;
  row.cause = fault.cause == Cause::kMissingTerm && !leans ? Cause::kScale : fault.cause;
  row.value = fault.factor;
  row.limit = 1.0;
  const double gradient = (fault.factor - 1.0) / gravity;
  return std::move(row)
      .with("truly", fault.truly)
      .with("taken", fault.taken)
      .with("gradient", gradient)
      .with("lean", gradient * gravity)
      .with("least", fault.least)
      .with("most", fault.most)
      .with("from", joined(fault.from, drive.names));
}

/// What is wrong: a row a fault, or one of all that may be where several sets of faults explain as much.
std::vector<Evidence> fault_rows(const DriveConsistency& drive, const std::vector<const ChannelRelation*>& off,
                                 double gravity) {
  std::vector<Evidence> rows;
  if (drive.found.is_sure()) {
    for (const ChannelFault& fault : drive.found.explanations.front())
      if (const Outcome outcome = worst_of(fault, off); outcome != Outcome::kPassed)
        rows.push_back(fault_row(fault, outcome, drive, gravity));
    return rows;
  }
  std::vector<std::string> names, possible;
  Outcome worst = Outcome::kPassed;
  std::optional<Cause> cause;
  bool same = true;
  for (const std::vector<ChannelFault>& together : drive.found.explanations) {
    for (const ChannelFault& fault : together) {
      worst = std::max(worst, worst_of(fault, off));
      same = same && cause.value_or(fault.cause) == fault.cause;
      cause = fault.cause;
      const std::string name = joined(fault.channels, drive.names);
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
      const bool factor = fault.cause == Cause::kScale || fault.cause == Cause::kMissingTerm;
      possible.push_back(factor ? fmt::format("{} ({:.3g} times the truth)", name, fault.factor)
                         : fault.truly.empty()
                             ? fmt::format("{} ({})", name, to_string(fault.cause))
                             : fmt::format("{} ({}{})", name, fault.hand_wheel ? "hand wheel, " : "", fault.truly));
    }
  }
  if (worst == Outcome::kPassed) return rows;
  Evidence row = row_of(Check::kOneOfChannels, fmt::format("{}", fmt::join(names, ", ")), worst);
  row.cause = same && cause ? *cause : Cause::kNone;
  rows.push_back(std::move(row).with("possible", fmt::format("{}", fmt::join(possible, ", or "))));
  return rows;
}

Evidence relation_row(const ChannelRelation& r, const DriveConsistency& drive, std::optional<double> roll_gradient,
                      double gravity) {
  const bool leans = is_lean(r, roll_gradient, gravity);
  Outcome outcome = leans ? Outcome::kPassed : r.outcome();
  if (!leans && outcome == Outcome::kPassed && !r.verified) outcome = Outcome::kNotVerified;
  Evidence row = row_of(r.check, drive.names[r.channel], outcome);
  row.value = r.middle();
  row.sigma = (r.high - r.low) / (2.0 * estimation::kBeyondChance);
  const bool failed = outcome == Outcome::kFailed, high = r.middle() > 1.0;
  row.limit = failed ? (high ? r.tolerance.highest : r.tolerance.lowest) : (high ? r.tolerance.high : r.tolerance.low);
  if (leans) {
    row.cause = Cause::kMissingTerm;
  } else if (outcome == Outcome::kNotVerified && !r.moved()) {
    row.cause = Cause::kExcitation;
  } else if (!row.passed() && r.unrelated()) {
    row.cause = Cause::kSwap;
  } else if (!row.passed() && drive.found.is_sure()) {
    const auto& faults = drive.found.explanations.front();
    const auto fault = std::ranges::find_if(faults, [&](const ChannelFault& f) { return touches(f, r); });
    if (fault != faults.end()) row.cause = fault->cause;
  }
  return std::move(row)
      .with("against", r.against)
      .with("low", r.low)
      .with("high", r.high)
      .with("correlation", r.correlation)
      .with("lean", roll_gradient.value_or(kNaN) * gravity);
}

}  // namespace

DriveConsistency drive_consistency(const recording::MappedRecording& mapped, const DriveSignals& signals,
                                   std::span<const TimeSpan> spans, double wheelbase) {
  const recording::DriveMotion motion = motion_of(mapped, signals);
  return {
      .found = recording::check_consistency(motion, {.wheelbase = wheelbase, .spans = {spans.begin(), spans.end()}}),
      .names = motion.names,
      .gravity_removed = signals.gravity_removed};
}

std::vector<Evidence> consistency_rows(const DriveConsistency& drive, std::optional<double> roll_gradient,
                                       double gravity) {
  const std::vector<const ChannelRelation*> off = off_in(drive, roll_gradient, gravity);
  std::vector<Evidence> rows = fault_rows(drive, off, gravity);
  for (const ChannelRelation& r : drive.found.relations) rows.push_back(relation_row(r, drive, roll_gradient, gravity));
  return rows;
}

}  // namespace veridyn::vehicle
