#pragma once

#include <array>
#include <memory>
#include <utility>

#include "veridyn/aircraft/reconstruction/air_data_measurement.hpp"
#include "veridyn/estimation/kalman/innovation_guard.hpp"

namespace veridyn::aircraft {

/// A model-free and a model-based filter side by side, on board or in a replay: the estimate is the model-based
/// filter's as long as its innovations are what they should be, and the model-free filter's otherwise.
///
/// New derivatives may come at any time from a recursive identification (`set_model`): the loop is closed, and the
/// guard keeps it from believing its own mistakes, because the model-free filter never sees the model. Judged are pitot
/// tube, vanes and accelerometer of the model-based filter, each by itself (InnovationGuard). When the guard ends the
/// trust, the model-based filter starts anew from the model-free one's state and covariance; it does so again after
/// every window with an alarm, so that what a wrong model did to it is forgotten, and it is believed again after
/// `return_after` of sound windows.
///
/// A change of the aircraft is noticed within two windows (2 s by default); until then the estimate is the wrong
/// model's. `propagate`, `measure` and `judge` do not allocate. Not thread-safe.
template <class Free = AirDataModel<0, false>, class Based = ModelBasedAirData<0, false>>
class GuardedFilter {
 public:
  using FreeState = typename Free::template State<double>;
  using BasedState = typename Based::template State<double>;
  using Monitors = std::array<estimation::InnovationMonitor, internal::kSensors>;

  /// `model_based.subject` is ignored: `subject` is the force model (see internal::load_model_streams).
  GuardedFilter(const Free& model_free, Based model_based, std::shared_ptr<const Subject> subject, const FreeState& x,
                const typename Free::Covariance& P, double t, const estimation::GuardOptions& guard = {},
                const estimation::InnovationGate& gate = {})
      : free_model_(model_free),
        based_model_(std::move(model_based)),
        subject_(std::move(subject)),
        free_(x, P),
        guard_(guard),
        gate_(gate),
        t_(t) {
    based_model_.subject = subject_.get();
    free_monitors_.fill(estimation::InnovationMonitor(gate));
    restart_model_based();
    guard_.restart(t, true);
  }

  /// Derivatives and their uncertainty from outside, from now on. The model-based filter starts anew from the
  /// model-free one; whether it is believed stays as it was, and the next window judges the new model.
  void set_model(std::shared_ptr<const Subject> subject, const ModelError& error) {
    subject_ = std::move(subject);
    based_model_.subject = subject_.get();
    based_model_.error = error;
    restart_model_based();
    guard_.restart(t_, guard_.trusted());
  }

  /// Over `dt` > 0 [s] with inertial measurements and controls `u`; its airspeed is filled in.
  void propagate(typename Based::Input u, double dt) {
    t_ += dt;
    u.airspeed = based_model_.air_velocity(based_.state()).norm();
    based_.propagate(based_model_, u, dt);
    u.airspeed = free_model_.air_velocity(free_.state()).norm();
    free_.propagate(free_model_, u, dt);
  }

  /// A sample `z` of a sensor with standard deviation `sigma`.
  void measure(const internal::MeasurementContext& context, internal::Sensor which, double z, double sigma) {
    static_cast<void>(
        internal::enter_measurement<Free>(free_, free_model_, context, which, z, sigma, free_monitors_[which]));
    estimation::Innovation seen;
    const bool offered = internal::enter_measurement<Based>(based_, based_model_, context, which, z, sigma,
                                                            based_monitors_[which], nullptr, &seen);
    if (offered && which >= internal::kPitot) guard_.add(static_cast<std::size_t>(which), seen.nis());
  }

  /// Closes a window of the guard when its time is over. Call after the samples of a time.
  void judge() {
    if (guard_.advance(t_) && guard_.alarm()) restart_model_based();
  }

  /// Whether the estimate is the model-based filter's.
  [[nodiscard]] bool model_based() const { return guard_.trusted(); }
  [[nodiscard]] const estimation::InnovationGuard& guard() const { return guard_; }
  [[nodiscard]] const estimation::ExtendedKalmanFilter<Free>& free_filter() const { return free_; }
  [[nodiscard]] const estimation::ExtendedKalmanFilter<Based>& based_filter() const { return based_; }
  [[nodiscard]] const Free& free_model() const { return free_model_; }
  [[nodiscard]] const Based& based_model() const { return based_model_; }
  [[nodiscard]] const Monitors& free_monitors() const { return free_monitors_; }
  /// Attitude, velocity, gusts and wind of the filter in use.
  [[nodiscard]] const FreeState& state() const { return model_based() ? based_.state() : free_.state(); }
  /// Velocity relative to the air [m/s, body axes] of the filter in use.
  [[nodiscard]] Eigen::Vector3d air_velocity() const { return free_model_.air_velocity(state()); }

 private:
  void restart_model_based() {
    static_assert(Based::kStates == Free::kStates + 3);
    BasedState x;
    static_cast<FreeState&>(x) = free_.state();
    typename Based::Covariance P = Based::Covariance::Zero();
    P.template topLeftCorner<Free::kStates, Free::kStates>() = free_.covariance();
    for (int i = 0; i < 3; ++i) {
      const double sigma = based_model_.error.sigma(static_cast<std::size_t>(i));
      P(Based::kCoefficientError + i, Based::kCoefficientError + i) = sigma * sigma;
    }
    based_ = estimation::ExtendedKalmanFilter<Based>(x, P);
    based_monitors_.fill(estimation::InnovationMonitor(gate_));
  }

  Free free_model_;
  Based based_model_;
  std::shared_ptr<const Subject> subject_;
  estimation::ExtendedKalmanFilter<Free> free_;
  estimation::ExtendedKalmanFilter<Based> based_;
  Monitors free_monitors_, based_monitors_;
  estimation::InnovationGuard guard_;
  estimation::InnovationGate gate_;
  double t_;
};

}  // namespace veridyn::aircraft
