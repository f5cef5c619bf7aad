#include "veridyn/camera/tracking/car_tracker.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::camera {

void TrackerOptions::validate() const {
  blobs.validate();
  layout.validate();
  if (!(motion.forward > 0.0 && motion.left > 0.0 && motion.yaw > 0.0))
    throw InputError("tracker", "the densities of the motion must be > 0");
  if (!(gate_probability > 0.9 && gate_probability < 1.0))
    throw InputError("tracker", "gate_probability must be between 0.9 and 1");
  if (!(lost_after_s > 0.0 && lost_sigma_m > 0.0 && longest_step_s > 0.0))
    throw InputError("tracker", "lost_after, lost_sigma and longest_step must be > 0");
  if (layout.markers.size() == 2 && !first_heading)
    throw InputError("tracker", "two markers look the same from both ends: the heading at the start must be given");
  if (first_heading && !std::isfinite(*first_heading)) throw InputError("tracker", "first_heading must be finite");
}

const KeyTable<TrackerOptions>& TrackerOptions::keys() {
  using O = TrackerOptions;
  const auto sigma = [](O& o) -> double& { return o.layout.sigma; };
  const auto contrast = [](O& o) -> double& { return o.blobs.contrast; };
  static const auto table =
      KeyTable<O>("tracker", "How a car is followed by its markers; in a study `[live.camera.tracker]`.")
          .other({"markers_x", "m", "two or three numbers", "[0.1, -0.08, -0.06]",
                  "of the markers, forward of the car's reference point"},
                 [](const StudyTable& t, const std::string& key, O& o) {
                   const std::vector<double> x = t.numbers(key, "m"), y = t.numbers("markers_y", "m");
                   if (x.size() != y.size())
                     t.fail("markers_y", fmt::format("has {} numbers, markers_x {}", y.size(), x.size()));
                   o.layout.markers.clear();
                   for (std::size_t i = 0; i < x.size(); ++i) o.layout.markers.emplace_back(x[i], y[i]);
                 })
          .elsewhere({"markers_y", "m", "as many", "[0, 0.05, -0.04]", "left of it"})
          .number("marker_sigma", sigma, "m", kPositive, "error of a coordinate of a marker on the car")
          .number("first_heading", &O::first_heading, "rad", kAnyNumber,
                  "within 90 deg at the start; two markers look the same from both ends")
          .otherwise("not known; required with two markers")
          .number("contrast", contrast, "1", kPositive,
                  "least height of a marker's peak above the picture's median [grey levels]")
          .number("lost_after", &O::lost_after_s, "s", kPositive,
                  "without a measurement; then the car is looked for everywhere again")
          .number("lost_sigma", &O::lost_sigma_m, "m", kPositive,
                  "lost as well when the predicted position is less certain than this")
          .number("longest_step", &O::longest_step_s, "s", kPositive, "between frames; a longer one is a break")
          .check([](const StudyTable& t, O&) {
            if (t.has("markers_y") && !t.has("markers_x")) t.fail("markers_x", "is missing");
          });
  return table;
}

CarTracker::CarTracker(const Calibration& calibration, const TrackerOptions& options)
    : calibration_(calibration), options_(options), finder_((options.validate(), options.blobs)) {
  if (!calibration_.covariance.allFinite())
    throw InputError("calibration", "its error is unknown (four points only), and so would be that of the poses");
  for (std::size_t n = 2; n <= 3; ++n)
    fit_gate_[n] = numerics::chi_square_quantile(options_.gate_probability, 2.0 * static_cast<double>(n) - 3.0);
  pose_gate_ = numerics::chi_square_quantile(options_.gate_probability, 3.0);
}

TrackedPose CarTracker::add(double time, const GreyView& frame) { return add(time, finder_.find(frame)); }

void CarTracker::begin(double time) {
  if (!std::isfinite(time) || (begun_ && !(time > time_)))
    throw InputError("frame", fmt::format("its time {:.6f} s does not follow {:.6f} s", time, time_));
  const double step = time - time_;
  if (begun_ && step > options_.longest_step_s) following_ = false;
  if (following_) {
    filter_.propagate(options_.motion, {}, step);
    const double sigma = std::sqrt(filter_.covariance().topLeftCorner<2, 2>().trace());
    if (time - seen_ > options_.lost_after_s || !(sigma < options_.lost_sigma_m)) following_ = false;
  }
  begun_ = true;
  time_ = time;
}

TrackedPose CarTracker::add(double time, std::span<const Blob> blobs) {
  begin(time);
  spots_of(blobs, calibration_, spots_);
  const std::size_t all = options_.layout.markers.size();
  std::optional<PoseMeasurement> measured = recognise(all, following_);
  if (!measured && following_ && all == 3 && close()) measured = recognise(2, true);
  if (measured) scale(*measured);
  return finish(time, std::move(measured));
}

TrackedPose CarTracker::add(double time, std::span<const PoseMeasurement> candidates) {
  begin(time);
  std::optional<PoseMeasurement> measured;
  if (following_) {
    constexpr double kClearDistance = 9.0;
    double best = kInfinity, second = kInfinity;
    for (const PoseMeasurement& pose : candidates) {
      const double d = distance(pose, 1.0);
      if (d < best) {
        second = best;
        best = d;
        measured = pose;
      } else {
        second = std::min(second, d);
      }
    }
    // Without a clear best the heading is not known any more.
    if (measured && best < pose_gate_ && second < best + kClearDistance) following_ = false;
    if (!(best < pose_gate_) || !following_) measured.reset();
  }
  if (!following_ && !measured) measured = found_again(time, candidates);
  return finish(time, std::move(measured));
}

std::optional<PoseMeasurement> CarTracker::found_again(double time, std::span<const PoseMeasurement> candidates) {
  if (candidates.empty()) return std::nullopt;
  constexpr double kMoved = 0.03, kRecent = 0.5;
  double wanted = 0.0;
  if (!followed_ && options_.first_heading) {
    wanted = *options_.first_heading;
  } else {
    const Eigen::Vector2d place = candidates.front().pose.head<2>(), moved = place - lost_place_;
    const bool recent = time - lost_time_ < kRecent;
    if (!recent || moved.norm() > kMoved) {
      lost_place_ = place;
      lost_time_ = time;
    }
    if (!recent || !(moved.norm() > kMoved)) return std::nullopt;
    wanted = std::atan2(moved(1), moved(0));
  }
  std::optional<PoseMeasurement> found;
  for (const PoseMeasurement& pose : candidates) {
    if (!(std::abs(numerics::wrap_angle(pose.pose(2) - wanted)) < 0.5 * kPi)) continue;
    if (found) return std::nullopt;
    found = pose;
  }
  return found;
}

TrackedPose CarTracker::finish(double time, std::optional<PoseMeasurement> measured) {
  TrackedPose result;
  result.time = time;
  result.measured = std::move(measured);
  if (result.measured) {
    if (following_) {
      correct(time, *result.measured);
    } else {
      start(*result.measured);
    }
    seen_ = time;
    map_ = result.measured->map;
  }
  if (!following_) return result;
  result.status = result.measured ? TrackStatus::kMeasured : TrackStatus::kPredicted;
  result.pose = filter_.state().head<3>();
  result.pose(2) = numerics::wrap_angle(result.pose(2));
  result.covariance = filter_.covariance().topLeftCorner<3, 3>() + map_;
  result.velocity = filter_.state().tail<3>();
  result.velocity_covariance = filter_.covariance().bottomRightCorner<3, 3>();
  return result;
}

double CarTracker::distance(const PoseMeasurement& pose, double factor) const {
  Eigen::Vector3d off = pose.pose - filter_.state().head<3>();
  off(2) = numerics::wrap_angle(off(2));
  const Eigen::Matrix3d S = filter_.covariance().topLeftCorner<3, 3>() + factor * pose.noise;
  return off.dot(S.ldlt().solve(off));
}

std::optional<PoseMeasurement> CarTracker::recognise(std::size_t markers, bool predicted) {
  const auto& layout = options_.layout.markers;
  std::optional<PoseMeasurement> best, second;
  double best_distance = kInfinity, second_distance = kInfinity;
  std::array<const Spot*, 3> chosen{};
  std::array<std::size_t, 3> which{};

  // Four times the variance so far is let in, so that the factor can grow to what the pictures really are.
  constexpr double kRoom = 4.0;
  const double factor = variance_factor();
  const auto judge = [&] {
    const auto pose =
        fit_pose(std::span(chosen).first(markers), std::span(which).first(markers), options_.layout, calibration_);
    if (!pose || !(pose->chi_square < fit_gate_[markers] * kRoom * factor)) return;
    double total = pose->chi_square / factor;
    if (predicted) {
      const double from_prediction = distance(*pose, factor);
      if (!(from_prediction < pose_gate_)) return;
      total += from_prediction;
    } else if (options_.first_heading && markers == 2 &&
               !(std::abs(numerics::wrap_angle(pose->pose(2) - *options_.first_heading)) < 0.5 * kPi)) {
      return;
    }
    if (total < best_distance) {
      second = best;
      second_distance = best_distance;
      best = pose;
      best_distance = total;
    } else if (total < second_distance) {
      second = pose;
      second_distance = total;
    }
  };
  // Distances between spots against the layout's, well before a fit: six sigma of both spots and both markers.
  const auto fits = [&](std::size_t i, std::size_t j) {
    const double expected = (layout[which[i]] - layout[which[j]]).norm();
    const double sigma2 =
        chosen[i]->noise.trace() + chosen[j]->noise.trace() + 4.0 * options_.layout.sigma * options_.layout.sigma;
    const double off = (chosen[i]->place - chosen[j]->place).norm() - expected;
    return off * off < 36.0 * factor * sigma2;
  };
  const auto pairs = [&](std::size_t a, std::size_t b) {
    which = {a, b, 3 - a - b};
    for (const Spot& first : spots_) {
      for (const Spot& other : spots_) {
        if (&first == &other) continue;
        chosen = {&first, &other, nullptr};
        if (!fits(0, 1)) continue;
        if (markers == 2) {
          judge();
          continue;
        }
        for (const Spot& third : spots_) {
          if (&third == &first || &third == &other) continue;
          chosen[2] = &third;
          if (fits(0, 2) && fits(1, 2)) judge();
        }
      }
    }
  };
  pairs(0, 1);
  if (markers == 2 && layout.size() == 3) {
    pairs(0, 2);
    pairs(1, 2);
  }
  // Two that agree about equally well: which of them is the car is not known.
  constexpr double kClearDistance = 9.0;
  const bool ambiguous = predicted && markers < layout.size() ? second_distance < best_distance + kClearDistance
                                                              : !predicted && second.has_value();
  if (ambiguous && best && second && (best->pose - second->pose).head<2>().norm() > 1e-3) return std::nullopt;
  return best;
}

bool CarTracker::close() const noexcept {
  double least = kInfinity;
  const auto& m = options_.layout.markers;
  for (std::size_t i = 0; i < m.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, (m[i] - m[j]).norm());
  const auto& P = filter_.covariance();
  constexpr double kSigmas = 3.0, kHeading = 0.2;
  return kSigmas * std::sqrt(std::max(P(0, 0), P(1, 1))) < least && std::sqrt(P(2, 2)) < kHeading;
}

void CarTracker::scale(PoseMeasurement& measured) {
  // No outlier moves the factor much.
  if (measured.markers == 3) {
    misfit_ += std::min(measured.chi_square, fit_gate_[3] * variance_factor());
    freedom_ += 3.0;
  }
  measured.noise *= variance_factor();
}

void CarTracker::start(const PoseMeasurement& measured) {
  CarMotionModel::State<double> x = CarMotionModel::State<double>::Zero();
  x.head<3>() = measured.pose;
  Filter::Covariance P = Filter::Covariance::Zero();
  P.topLeftCorner<3, 3>() = measured.noise;
  constexpr double kSpeed = 3.0, kSlip = 1.0, kYawRate = 4.0;  // of any car of such a size
  P.diagonal().tail<3>() << kSpeed * kSpeed, kSlip * kSlip, kYawRate * kYawRate;
  filter_ = Filter(x, P);
  for (auto& monitor : monitors_) monitor.restart();
  following_ = followed_ = true;
}

void CarTracker::correct(double time, const PoseMeasurement& measured) {
  // Three scalars of independent noise: L^-1 (z - x) with noise = L L'. The state moves with each of them.
  const Eigen::Matrix3d L = measured.noise.llt().matrixL();
  const Eigen::Matrix3d whiten = L.triangularView<Eigen::Lower>().solve(Eigen::Matrix3d::Identity());
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3d off = measured.pose - filter_.state().head<3>();
    off(2) = numerics::wrap_angle(off(2));
    Filter::Vector H = Filter::Vector::Zero();
    H.head<3>() = whiten.row(i).transpose();
    filter_.update(time, whiten.row(i).dot(off), H, 1.0, monitors_[i]);
  }
}

}  // namespace veridyn::camera
