#pragma once

#include <memory>

#include "veridyn/aircraft/reconstruction/filter_engine.hpp"
#include "veridyn/estimation/kalman/innovation_guard.hpp"

namespace veridyn::aircraft {

/// A model-free and a model-based filter running alongside, on board or in a replay: the estimate is the model-based
/// filter's as long as its innovations are what they should be, and the model-free filter's otherwise.
///
/// New derivatives may come at any time from a recursive identification (`set_model`): the loop is closed, and the
/// guard keeps it from trusting its mistakes, because the model-free filter never sees the model. Judged are pitot
/// tube, vanes and accelerometer of the model-based filter, each by itself (InnovationGuard). When the guard ends the
/// trust, the model-based filter starts again from the model-free one's state and covariance; it does so again after
/// every window with an alarm, so that what a wrong model did to it is forgotten, and it is trusted again after
/// `return_after` of sound windows.
///
/// Without a model (`subject` null) the estimate is the model-free filter's. A first model, like one after that, has to
/// earn the trust: `return_after` of sound windows.
///
/// A change of the aircraft is noticed within two windows (2 s by default); until then the estimate is the wrong
/// model's. `propagate`, `measure` and `judge` do not allocate. Not thread-safe.
class GuardedFilter {
 public:
  using State = AirDataState<double>;
  using Monitors = internal::Monitors;

  /// `motion.subject` is ignored: `subject` is the force model (see internal::load_model_streams), null where none is
  /// known yet. `imu_errors`: both filters estimate errors of the inertial sensors. `t`: time of `start` [s].
  GuardedFilter(bool imu_errors, const ModelBasedMotion& motion, std::shared_ptr<const Subject> subject,
                const internal::Start& start, double t, const estimation::GuardOptions& guard = {},
                const estimation::InnovationGate& gate = {});

  /// Derivatives and their uncertainty from outside, from now on. The model-based filter starts again from the
  /// model-free one. In place of another model the trust stays as it was and the running window judges both; a first
  /// one is not trusted yet. Null: nothing is known any more.
  void set_model(std::shared_ptr<const Subject> subject, const ModelError& error);

  /// Over `dt` > 0 [s] with inertial measurements and controls `u`; its airspeed is filled in.
  void propagate(const AirDataInput& u, double dt);

  /// A sample `z` of a sensor with standard deviation `sigma`.
  void measure(const internal::MeasurementContext& context, internal::Sensor which, double z, double sigma);

  /// Closes a window of the guard when its time is over. Call after the samples of a time.
  void judge();

  /// Whether the estimate is the model-based filter's.
  [[nodiscard]] bool model_based() const { return guard_.trusted(); }
  [[nodiscard]] const estimation::InnovationGuard& guard() const { return guard_; }
  /// The filter in use.
  [[nodiscard]] const internal::AirDataEstimator& active() const { return model_based() ? *based_ : *free_; }
  /// Attitude, velocity, gusts and wind of the filter in use.
  [[nodiscard]] const State& state() const { return active().state(); }
  /// Velocity relative to the air [m/s, body axes] of the filter in use.
  [[nodiscard]] Eigen::Vector3d air_velocity() const { return active().motion().air_velocity(state()); }

 private:
  void restart_model_based();

  std::shared_ptr<const Subject> subject_;  ///< null: no model
  std::unique_ptr<internal::AirDataEstimator> free_, based_;
  Monitors free_monitors_, based_monitors_;
  estimation::InnovationGuard guard_;
  estimation::InnovationGate gate_;
  double t_;
};

}  // namespace veridyn::aircraft
