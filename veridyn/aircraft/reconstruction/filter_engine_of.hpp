#pragma once

#include "veridyn/aircraft/reconstruction/filter_engine.hpp"
#include "veridyn/estimation/kalman/smoother.hpp"

/// Inside of the engines' source files: an engine for one system. Costly to compile; included by those two only.
namespace veridyn::aircraft::internal {

/// The covariance of a filter of one kind, with its size hidden.
template <class Model>
[[nodiscard]] CovarianceView view_of(const typename Model::Covariance& P) {
  return {{P.data(), Model::kStates, Model::kStates}, Model::kImuError, Model::kCoefficientError};
}

/// AirDataEstimator for one kind of filter.
template <class Model>
class EstimatorOf final : public AirDataEstimator {
 public:
  EstimatorOf(const ModelBasedMotion& motion, const Start& start)
      : model_(system_of<Model>(motion)), filter_(start.x, start_covariance<Model>(start)) {}

  void propagate(AirDataInput u, double dt) override {
    u.airspeed = model_.air_velocity(filter_.state()).norm();
    filter_.propagate(model_, u, dt);
  }
  bool measure(const MeasurementContext& context, Sensor which, double z, double sigma,
               estimation::InnovationMonitor& monitor, estimation::Innovation* seen) override {
    return enter_measurement<Model>(filter_, model_, context, which, z, sigma, monitor, nullptr, seen);
  }
  void restart_from(const AirDataEstimator& model_free) override {
    const CovarianceView from = model_free.covariance();
    typename Model::Covariance P = Model::Covariance::Zero();
    for (Eigen::Index j = 0; j < from.matrix.cols(); ++j) {
      for (Eigen::Index i = 0; i < from.matrix.rows(); ++i) P(i, j) = from.matrix(i, j);
    }
    if constexpr (FlightRun<Model>::kForces) {
      for (int i = 0; i < 3; ++i) {
        const double sigma = model_.error.sigma(static_cast<std::size_t>(i));
        P(Model::kCoefficientError + i, Model::kCoefficientError + i) = sigma * sigma;
      }
    }
    filter_ = estimation::ExtendedKalmanFilter<Model>(model_free.state(), P);
  }
  void set_forces([[maybe_unused]] const Subject* subject, [[maybe_unused]] const ModelError& error) override {
    if constexpr (FlightRun<Model>::kForces) {
      model_.subject = subject;
      model_.error = error;
    }
  }
  const AirDataState<double>& state() const override { return filter_.state(); }
  CovarianceView covariance() const override { return view_of<Model>(filter_.covariance()); }
  const AirDataMotion& motion() const override { return model_; }

 private:
  Model model_;
  estimation::ExtendedKalmanFilter<Model> filter_;
};

/// InnovationRun for one kind of filter.
template <class Model>
class InnovationRunOf final : public InnovationRun {
 public:
  explicit InnovationRunOf(FlightRun<Model> run) : run_(std::move(run)) { run_.keep_innovations(); }
  bool advance() override { return run_.advance(nullptr); }
  const std::vector<SensorInnovation>& innovations() const override { return run_.innovations(); }
  const Monitors& monitors() const override { return run_.monitors(); }

 private:
  FlightRun<Model> run_;
};

/// FilterEngine for one kind of filter.
template <class Model>
class EngineOf final : public FilterEngine {
 public:
  bool has_forces() const override { return FlightRun<Model>::kForces; }

  PassEnd smooth(const RunSetting& setting, const Segment& segment, const Monitors& monitors, std::size_t first_output,
                 std::span<const std::size_t> error_columns, int threads, const OnFiltered& filtered,
                 const OnSmoothed& smoothed, const OnInnovation& seen) const override {
    constexpr std::size_t kBlock = 512;
    const auto forward = [&](const FlightRun<Model>& now) {
      for (const SensorInnovation& innovation : now.innovations()) seen(now.time(), innovation);
      if (lost_sensor(now.monitors())) return false;
      return !now.at_output() ||
             filtered(now.output(), now.time(), now.filter().state(), view_of<Model>(now.filter().covariance()));
    };
    const auto emit = [&](std::size_t number, const AirDataState<double>& x, const typename Model::Covariance& P) {
      smoothed(number, x, view_of<Model>(P));
    };
    FlightRun<Model> run(setting, segment, start_of(setting, segment), monitors, first_output);
    if (seen) run.keep_innovations();
    const FlightRun<Model> end = estimation::smooth_in_blocks<Model>(run, kBlock, threads, forward, emit);
    return {end.monitors(), view_of<Model>(end.filter().covariance()).of_columns(error_columns)};
  }

  std::unique_ptr<InnovationRun> innovation_run(const RunSetting& setting, const Segment& segment,
                                                const Monitors& monitors) const override {
    return std::make_unique<InnovationRunOf<Model>>(
        FlightRun<Model>(setting, segment, start_of(setting, segment), monitors, 0));
  }

  std::unique_ptr<AirDataEstimator> estimator(const ModelBasedMotion& motion, const Start& start) const override {
    return std::make_unique<EstimatorOf<Model>>(motion, start);
  }
};

}  // namespace veridyn::aircraft::internal
