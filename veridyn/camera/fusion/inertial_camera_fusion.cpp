#include "veridyn/camera/fusion/inertial_camera_fusion.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::camera {
namespace {

using Model = InertialModel;

Eigen::Vector2d turned_by(double heading, const Eigen::Vector2d& arm) {
  const double c = std::cos(heading), s = std::sin(heading);
  return {c * arm(0) - s * arm(1), s * arm(0) + c * arm(1)};
}

/// Acceleration forward and left, horizontal.
template <typename Scalar>
Eigen::Matrix<Scalar, 2, 1> along_the_car(const Model::State<Scalar>& x, const Eigen::Vector3d& force) {
  using std::cos;
  using std::sin;
  const numerics::Vector3<Scalar> a = Model::acceleration<Scalar>(x, force);
  const Scalar c = cos(x(Model::kHeading)), s = sin(x(Model::kHeading));
  return {c * a(0) + s * a(1), c * a(1) - s * a(0)};
}

}  // namespace

void FusionOptions::validate() const {
  const auto positive = [](double value, const char* name) {
    if (!(value > 0.0 && std::isfinite(value))) throw InputError("fusion", fmt::format("{} must be > 0", name));
  };
  positive(noise.gyro, "noise.gyro");
  if (!(noise.gyro_share >= 0.0 && noise.gyro_share < 1.0))
    throw InputError("fusion", "noise.gyro_share must be 0 to 1");
  positive(noise.gyro_walk, "noise.gyro_walk");
  positive(noise.gyro_bias, "noise.gyro_bias");
  positive(noise.accelerometer, "noise.accelerometer");
  positive(noise.accelerometer_walk, "noise.accelerometer_walk");
  positive(noise.accelerometer_bias, "noise.accelerometer_bias");
  positive(offset_sigma, "offset_sigma");
  positive(inclination_sigma, "inclination_sigma");
  positive(lag_s, "lag");
  positive(longest_gap_s, "longest_gap");
  if (!(offset_walk >= 0.0 && std::isfinite(offset_walk))) throw InputError("fusion", "offset_walk must be >= 0");
  if (!sensor_place.allFinite()) throw InputError("fusion", "sensor_place must be finite");
  if (!(std::abs(offset) + 3.0 * offset_sigma < lag_s))
    throw InputError("fusion", fmt::format("lag is {:g} s; must be more than the offset and three of its standard "
                                           "deviations, {:g} s",
                                           lag_s, std::abs(offset) + 3.0 * offset_sigma));
}

const KeyTable<FusionOptions>& FusionOptions::keys() {
  using O = FusionOptions;
  using N = InertialNoise;
  static const auto noise =
      KeyTable<N>("fusion")
          .number("gyro", &N::gyro, "1", kPositive, "its noise [rad/s/sqrt(Hz)]")
          .number("gyro_share", &N::gyro_share, "1", {.low = 0.0, .high = 1.0, .with_high = false},
                  "errors that grow with the rate, scale and mounting, as noise of this share of it")
          .number("gyro_walk", &N::gyro_walk, "1", kPositive, "of its bias [rad/s^2/sqrt(Hz)]")
          .number("gyro_bias", &N::gyro_bias, "1", kPositive, "of its bias at the start, standard deviation [rad/s]")
          .number("accelerometer", &N::accelerometer, "1", kPositive, "its noise [m/s^2/sqrt(Hz)]")
          .number("accelerometer_walk", &N::accelerometer_walk, "1", kPositive, "of its bias [m/s^3/sqrt(Hz)]")
          .number("accelerometer_bias", &N::accelerometer_bias, "1", kPositive,
                  "of its bias at the start, standard deviation [m/s^2]");
  const auto coordinate = [](Eigen::Index i) { return [i](O& o) -> double& { return o.sensor_place(i); }; };
  static const auto table =
      KeyTable<O>("fusion", "How inertial sensors and camera are fused; in a study `[live.camera.fusion]`.")
          .with(&O::noise, noise)
          .number("sensor_x", coordinate(0), "m", kAnyNumber,
                  "of the inertial sensors, forward of the point whose pose the camera gives")
          .number("sensor_y", coordinate(1), "m", kAnyNumber, "left of it")
          .number("offset", &O::offset, "s", kAnyNumber, "of the camera's stamps at the start; positive: they are late")
          .number("offset_sigma", &O::offset_sigma, "s", kPositive, "of that, standard deviation")
          .number("inclination_sigma", &O::inclination_sigma, "rad", kPositive, "of pitch and roll at the start")
          .number("lag", &O::lag_s, "s", kPositive, "frames that arrive up to this late are entered where they belong")
          .number("longest_gap", &O::longest_gap_s, "s", kPositive,
                  "between inertial samples; after a longer one the fusion starts again with a frame");
  return table;
}

InertialCameraFusion::InertialCameraFusion(const FusionOptions& options) : options_(options) {
  options_.validate();
  model_.noise = options_.noise;
  model_.offset_walk = options_.offset_walk;
}

void InertialCameraFusion::add_inertial(double time, const Eigen::Vector3d& rate, const Eigen::Vector3d& force) {
  if (!std::isfinite(time) || !rate.allFinite() || !force.allFinite())
    throw InputError("inertial sample", fmt::format("something at {:.6f} s is not a finite number", time));
  if (!steps_.empty() && !(time > steps_.back().time))
    throw InputError("inertial sample",
                     fmt::format("its time {:.6f} s does not follow {:.6f} s", time, steps_.back().time));
  if (!steps_.empty() && time - steps_.back().time > options_.longest_gap_s) {
    ++gaps_;
    running_ = false;
    steps_.clear();
    first_frame_ += frames_.size();
    frames_.clear();
  }
  Step step{.time = time, .sample = {rate, force}, .filter = {}, .monitors = monitors_, .next_frame = first_frame_};
  if (running_) run(steps_.back(), step);
  monitors_ = step.monitors;
  steps_.push_back(std::move(step));
  forget();
}

bool InertialCameraFusion::add_camera(double stamp, const Eigen::Vector3d& pose, const Eigen::Matrix3d& covariance) {
  if (!std::isfinite(stamp) || !pose.allFinite() || !covariance.allFinite() ||
      covariance.llt().info() != Eigen::Success)
    throw InputError("camera pose",
                     fmt::format("at {:.6f} s it is not finite or its covariance not positive definite", stamp));
  if (steps_.empty()) return false;
  const Frame frame{stamp, pose, covariance};
  if (!running_) {
    start(frame);
    return true;
  }
  const auto place =
      std::upper_bound(frames_.begin(), frames_.end(), stamp, [](double s, const Frame& f) { return s < f.stamp; });
  const std::size_t number = first_frame_ + at(place - frames_.begin());
  // The last step before the frame that has entered nothing after it.
  std::size_t from = steps_.size();
  while (from > 0) {
    const Step& s = steps_[from - 1];
    if (s.next_frame <= number && s.time <= stamp - s.filter.state()(Model::kOffset)) break;
    --from;
  }
  if (from == 0) {
    ++too_late_;
    return false;
  }
  frames_.insert(place, frame);
  for (std::size_t i = from; i < steps_.size(); ++i) run(steps_[i - 1], steps_[i]);
  monitors_ = steps_.back().monitors;
  return true;
}

void InertialCameraFusion::start(const Frame& frame) {
  Model::State<double> x = Model::State<double>::Zero();
  x.head<2>() = frame.pose.head<2>() + turned_by(frame.pose(2), options_.sensor_place);
  x(Model::kHeading) = frame.pose(2);
  x(Model::kOffset) = options_.offset;
  Filter::Covariance P = Filter::Covariance::Zero();
  const auto square = [](double s) { return s * s; };
  constexpr double kSpeed = 3.0;  // of any car of such a size
  P.diagonal() << 0.0, 0.0, square(kSpeed), square(kSpeed), 0.0, square(options_.inclination_sigma),
      square(options_.inclination_sigma), Eigen::Vector3d::Constant(square(options_.noise.gyro_bias)),
      Eigen::Vector3d::Constant(square(options_.noise.accelerometer_bias)), square(options_.offset_sigma);
  // The pose is of another time than the last sample: by the lateness of the frame, at any speed that the car may have.
  const Step& last = steps_.back();
  const double apart = std::abs(last.time - frame.stamp) + options_.offset_sigma + std::abs(options_.offset);
  const Eigen::Vector3d rate(last.sample.rate);
  const std::array<int, 3> index{Model::kX, Model::kX + 1, Model::kHeading};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) P(index[i], index[k]) = frame.covariance(i, k);
  P(0, 0) += square(kSpeed * apart);
  P(1, 1) += square(kSpeed * apart);
  P(Model::kHeading, Model::kHeading) += square((std::abs(rate(2)) + 1.0) * apart);
  const Step begun{.time = last.time,
                   .sample = last.sample,
                   .filter = Filter(x, P),
                   .monitors = monitors_,
                   .next_frame = first_frame_};
  steps_.clear();
  steps_.push_back(begun);
  frames_.clear();
  running_ = true;
}

void InertialCameraFusion::run(const Step& from, Step& to) {
  to.filter = from.filter;
  to.monitors = from.monitors;
  to.next_frame = from.next_frame;
  const Model::Input mean{0.5 * (from.sample.rate + to.sample.rate), 0.5 * (from.sample.force + to.sample.force)};
  const Eigen::Vector3d angular = (to.sample.rate - from.sample.rate) / (to.time - from.time);
  double time = from.time;
  while (to.next_frame < first_frame_ + frames_.size()) {
    const Frame& frame = frames_[to.next_frame - first_frame_];
    const double when = std::max(time, frame.stamp - to.filter.state()(Model::kOffset));
    if (!(when < to.time)) break;
    if (when > time) to.filter.propagate(model_, mean, when - time);
    time = when;
    enter(frame, time, mean, angular, to.filter, to.monitors);
    ++to.next_frame;
  }
  to.filter.propagate(model_, mean, to.time - time);
}

void InertialCameraFusion::enter(const Frame& frame, double time, const Model::Input& input,
                                 const Eigen::Vector3d& angular, Filter& filter,
                                 std::array<estimation::InnovationMonitor, 3>& monitors) const {
  // The frame is of stamp - offset; the filter stands at `time`, which is that but for a frame that the offset moved.
  const Eigen::Matrix3d L = frame.covariance.llt().matrixL();
  const Eigen::Matrix3d whiten = L.triangularView<Eigen::Lower>().solve(Eigen::Matrix3d::Identity());
  for (int i = 0; i < 3; ++i) {
    const Model::State<double>& x = filter.state();
    const Filter::Covariance& P = filter.covariance();
    const double ahead = frame.stamp - x(Model::kOffset) - time;
    const Eigen::Vector2d arm = turned_by(x(Model::kHeading), options_.sensor_place);
    const Eigen::Vector3d rates =
        numerics::euler_rates<double>(x(Model::kRoll), x(Model::kPitch), input.rate - x.segment<3>(Model::kGyroBias));
    const Eigen::Vector3d a = Model::acceleration<double>(x, input.force);
    Eigen::Vector3d moving;  // rate of the predicted pose
    moving << x.segment<2>(Model::kVelocity) - rates(2) * Eigen::Vector2d(-arm(1), arm(0)), rates(2);
    Eigen::Vector3d off = frame.pose;
    off.head<2>() -= x.head<2>() - arm;
    off(2) -= x(Model::kHeading);
    off -= moving * ahead;
    off(2) = numerics::wrap_angle(off(2));
    Eigen::Matrix<double, 3, Model::kStates> H = Eigen::Matrix<double, 3, Model::kStates>::Zero();
    H(0, 0) = H(1, 1) = H(2, Model::kHeading) = 1.0;
    H(0, Model::kHeading) = arm(1);
    H(1, Model::kHeading) = -arm(0);
    H.block<2, 2>(0, Model::kVelocity) = ahead * Eigen::Matrix2d::Identity();
    H(2, Model::kGyroBias + 2) = -ahead;
    H.col(Model::kOffset) = -moving;
    // Second order in the offset: half the square of the trace of (second derivatives x P).
    const double P_tt = P(Model::kOffset, Model::kOffset);
    Eigen::Vector3d wider;
    for (int k = 0; k < 2; ++k) {
      const double P_vt = P(Model::kVelocity + k, Model::kOffset), P_vv = P(Model::kVelocity + k, Model::kVelocity + k);
      wider(k) = 0.5 * a(k) * a(k) * P_tt * P_tt + P_vv * P_tt + P_vt * P_vt;
    }
    wider(2) = 0.5 * angular(2) * angular(2) * P_tt * P_tt + P(Model::kGyroBias + 2, Model::kGyroBias + 2) * P_tt;
    const Eigen::Vector3d w = whiten.row(i).transpose();
    const Filter::Vector row = H.transpose() * w;
    filter.update(time, w.dot(off), row, 1.0 + w.cwiseAbs2().dot(wider), monitors[i]);
  }
}

void InertialCameraFusion::forget() {
  // Two steps stay in any case; frames that every step has entered are not needed.
  while (steps_.size() > 2 && steps_[1].time < steps_.back().time - options_.lag_s) steps_.pop_front();
  while (!frames_.empty() && first_frame_ < steps_.front().next_frame) {
    frames_.pop_front();
    ++first_frame_;
  }
}

std::optional<FusedMotion> InertialCameraFusion::now() const {
  if (!running_) return std::nullopt;
  const Step& step = steps_.back();
  const Model::State<double>& x = step.filter.state();
  const Filter::Covariance& P = step.filter.covariance();
  FusedMotion m;
  m.time = step.time;
  m.position = x.head<2>();
  m.velocity = x.segment<2>(Model::kVelocity);
  m.heading = numerics::wrap_angle(x(Model::kHeading));
  m.pitch = x(Model::kPitch);
  m.roll = x(Model::kRoll);
  m.gyro_bias = x.segment<3>(Model::kGyroBias);
  m.accel_bias = x.segment<3>(Model::kAccelBias);
  m.offset = x(Model::kOffset);
  m.sigma = P.diagonal().cwiseMax(0.0).cwiseSqrt();
  using Jet = ceres::Jet<double, Model::kStates>;
  Model::State<Jet> moved;
  for (int i = 0; i < Model::kStates; ++i) moved(i) = Jet(x(i), i);
  const Eigen::Matrix<Jet, 2, 1> a = along_the_car<Jet>(moved, step.sample.force);
  for (int i = 0; i < 2; ++i) {
    m.acceleration(i) = a(i).a;
    m.sigma_acceleration(i) = std::sqrt(std::max(0.0, a(i).v.dot(P * a(i).v)));
  }
  return m;
}

}  // namespace veridyn::camera
