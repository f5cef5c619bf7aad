// Segments of a drive's parametric model: how finely each is integrated, and what is known of where it begins.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"

namespace veridyn::vehicle {
namespace {

constexpr double kLongestStep_s = 10e-3;
/// Step times the fastest decay rate of the bicycle: RK4 then errs by less than 3e-4 of that rate.
constexpr double kStepTimesRate = 0.4;
constexpr int kMostSubsteps = 40;

/// How far roll, roll rate and lagging slips may be from those of steady cornering where a segment begins [rad, rad/s].
constexpr double kInitialRoll = 0.01, kInitialRollRate = 0.05, kInitialSlip = 0.005;

}  // namespace

DriveParametricModel::Segment DriveParametricModel::make_segment(std::size_t begin, std::size_t end) const {
  const double C_f = options_.start[DriveUnknown::kCf], C_r = options_.start[DriveUnknown::kCr];
  const double I_z = options_.start[DriveUnknown::kIz];
  const double slowest = *std::min_element(speed_.begin() + begin, speed_.begin() + end);
  const double rate =
      2.0 / slowest * ((C_f + C_r) / start_.mass + (start_.a * start_.a * C_f + start_.b * start_.b * C_r) / I_z);
  const double step = grid_.step;
  Segment out;
  out.begin = begin;
  out.samples = static_cast<Eigen::Index>(end - begin);
  out.substeps = static_cast<int>(
      std::clamp(std::ceil(options_.finer_steps * std::max(step / kLongestStep_s, step * rate / kStepTimesRate) - 1e-9),
                 1.0, options_.finer_steps * kMostSubsteps));
  // Steady cornering at the measured yaw rate, averaged over a tenth of a second.
  const std::size_t few = std::min(end - begin, static_cast<std::size_t>(std::max(1.0, 0.1 / step)));
  double r0 = 0.0;
  for (std::size_t k = 0; k < few; ++k) r0 += compared_.front().value[begin + k] / static_cast<double>(few);
  const double u0 = speed_[begin];
  const double v0 = r0 * (start_.b - start_.a * start_.mass * u0 * u0 / (2.0 * C_r * start_.wheelbase()));
  out.initial = {{.name = "lateral_velocity", .unit = "m/s", .start = v0},
                 {.name = "yaw_rate", .unit = "rad/s", .start = r0}};
  if (has_roll(options_.structure)) {
    out.initial.push_back({.name = "roll", .unit = "rad", .prior_sigma = kInitialRoll});
    out.initial.push_back({.name = "roll_rate", .unit = "rad/s", .prior_sigma = kInitialRollRate});
  }
  if (has_relaxation(options_.structure)) {
    out.initial.push_back({.name = "slip_front", .unit = "rad", .prior_sigma = kInitialSlip});
    out.initial.push_back({.name = "slip_rear", .unit = "rad", .prior_sigma = kInitialSlip});
  }
  if (options_.effects[DriveEffect::kBank])
    out.initial.push_back({.name = std::string(kSegmentBank), .unit = "rad", .prior_sigma = kBankSigma});
  for (const DriveUnknown bias : options_.offsets)
    out.initial.push_back({.name = std::string(kDriveUnknownNames[bias]),
                           .unit = std::string(kDriveUnknownUnits[bias]),
                           .prior_sigma = options_.prior[bias]});
  return out;
}

TimeSpan DriveParametricModel::segment_span(std::size_t segment) const {
  const Segment& s = segments_[segment];
  return {grid_.at(s.begin), grid_.at(s.begin + static_cast<std::size_t>(s.samples) - 1)};
}

void DriveParametricModel::shorten(std::size_t segment, Eigen::Index samples) {
  VERIDYN_ASSERT(samples >= 1 && samples <= segments_[segment].samples);
  segments_[segment].samples = samples;
}

std::string DriveParametricModel::segment_name(std::size_t segment) const {
  const TimeSpan span = segment_span(segment);
  return fmt::format("segment {} ({:.1f} to {:.1f} s)", segment + 1, span.begin, span.end);
}

}  // namespace veridyn::vehicle
