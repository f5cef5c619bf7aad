#include "veridyn/cueing/washout/lap_foresight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

constexpr double kLapStep = 0.02;                // of the lap as it is kept [s]
constexpr double kLongestGap = 1.0;              // in its stamps [s]
constexpr double kSmoothed = 0.4;                // two drives do not meet a bump at the same moment [s]
constexpr double kShortestLap = 50.0;            // [m]
constexpr double kOffTheLap = 15.0;              // [m]
constexpr double kBehind = 0.5, kAheadOf = 3.0;  // of the last place, where the next one is looked for [s]
constexpr double kBetweenSearches = 0.1;         // [s]
constexpr double kMoved = 0.5;                   // far enough to have a direction [m]
constexpr double kPaceFollows = 0.5;             // [s]
constexpr double kMostPace = 3.0;

/// Means over `width` values, twice: a triangle.
void smooth(std::vector<Eigen::Vector3d>& values, std::size_t half) {
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<Eigen::Vector3d> before = values;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const std::size_t reach = std::min({half, k, values.size() - 1 - k});
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (std::size_t i = k - reach; i <= k + reach; ++i) sum += before[i];
      values[k] = sum / static_cast<double>(2 * reach + 1);
    }
  }
}

}  // namespace

LapForesight::LapForesight(const std::vector<recording::MotionSample>& samples) {
  if (samples.empty() || samples.front().position_from == recording::Origin::kAbsent)
    throw InputError("lap", "has no positions: channels pos_x and pos_y are needed");
  Lap lap;
  double length = 0.0;
  std::size_t k = 0;
  for (double t = samples.front().time; t < samples.back().time; t += kLapStep) {
    while (samples[k + 1].time <= t) ++k;
    const recording::MotionSample a = recording::in_frame(samples[k], Frame::kFrd),
                                  b = recording::in_frame(samples[k + 1], Frame::kFrd);
    if (b.time - a.time > kLongestGap)
      throw InputError("lap", fmt::format("has a gap of {:.3g} s at {:.6g} s", b.time - a.time, a.time));
    const double part = (t - a.time) / (b.time - a.time);
    lap.position.emplace_back(a.position + part * (b.position - a.position));
    lap.force.emplace_back(a.force + part * (b.force - a.force));
    if (lap.position.size() > 1) length += (lap.position.back() - lap.position[lap.position.size() - 2]).norm();
  }
  if (!(length > kShortestLap))
    throw InputError("lap", fmt::format("is {:.3g} m long; takes {:g} m or more", length, kShortestLap));
  smooth(lap.force, static_cast<std::size_t>(0.5 * kSmoothed / kLapStep));
  lap_ = std::make_shared<const Lap>(std::move(lap));
}

void LapForesight::reset() {
  at_ = -1.0;
  pace_ = 1.0;
  direction_.setZero();
  has_last_ = false;
  since_search_ = kBetweenSearches;
}

double LapForesight::nearest(const Eigen::Vector2d& position, std::size_t begin, std::size_t end) const {
  const std::vector<Eigen::Vector2d>& track = lap_->position;
  double at = -1.0, least = kOffTheLap * kOffTheLap;
  for (std::size_t k = begin; k + 1 < std::min(end, track.size()); ++k) {
    const Eigen::Vector2d along = track[k + 1] - track[k];
    if (along.dot(direction_) < 0.0) continue;
    const double length = along.squaredNorm();
    const double part = length > 0.0 ? std::clamp((position - track[k]).dot(along) / length, 0.0, 1.0) : 0.0;
    const double distance = (track[k] + part * along - position).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    at = (static_cast<double>(k) + part) * kLapStep;
  }
  return at;
}

Eigen::Vector3d LapForesight::force(double at) const {
  const double last = static_cast<double>(lap_->force.size() - 1), i = std::clamp(at / kLapStep, 0.0, last);
  const auto k = std::min(static_cast<std::size_t>(i), lap_->force.size() - 2);
  return lap_->force[k] + (i - static_cast<double>(k)) * (lap_->force[k + 1] - lap_->force[k]);
}

void LapForesight::follow(const recording::MotionSample& sample, double step) {
  since_search_ += step;
  if (!has_last_) {
    last_ = sample.position;
    has_last_ = true;
  } else if ((sample.position - last_).norm() > kMoved) {
    direction_ = sample.position - last_;
    last_ = sample.position;
  }
  const auto index = [](double t) { return static_cast<std::size_t>(std::max(t, 0.0) / kLapStep); };
  if (at_ >= 0.0) {
    const double before = at_;
    at_ = nearest(sample.position, index(before - kBehind), index(before + kAheadOf + kMostPace * step));
    if (at_ >= 0.0) {
      if (step > 0.0)
        pace_ += (1.0 - std::exp(-step / kPaceFollows)) * (std::clamp((at_ - before) / step, 0.0, kMostPace) - pace_);
      return;
    }
  }
  // Without a direction the way back could be taken for the way there.
  if (direction_.isZero(0.0) || since_search_ < kBetweenSearches) return;
  since_search_ = 0.0;
  at_ = nearest(sample.position, 0, lap_->position.size());
  pace_ = 1.0;
}

bool LapForesight::look(const recording::MotionSample& sample, double step, Foreseen& foreseen) {
  if (sample.position_from == recording::Origin::kAbsent) return false;
  follow(sample, step);
  if (at_ < 0.0) return false;
  const auto driven = [&](double ahead) {
    Eigen::Vector3d f = force(at_ + pace_ * ahead);
    f.y() *= pace_ * pace_;
    return f;
  };
  foreseen.now = driven(0.0);
  for (std::size_t k = 0; k < kForeseenSteps; ++k) foreseen.then[k] = driven(foreseen_middle(k));
  return true;
}

}  // namespace veridyn::cueing
