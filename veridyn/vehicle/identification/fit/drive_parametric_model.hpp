#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/estimation/open_loop/open_loop_model.hpp"
#include "veridyn/estimation/output_error/autodiff_model.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"
#include "veridyn/vehicle/identification/fit/drive_noise.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"
#include "veridyn/vehicle/model/rolling_bicycle.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {

/// The unknown of a segment that the bank of its road is.
inline constexpr std::string_view kSegmentBank = "bank";
/// Below it the derivative of the recorded speed moves loads: bodies pitch as slowly.
inline constexpr double kPedalBand_Hz = 2.0;

/// Unknowns whose derivatives one simulation gives: a bicycle has ten, and two of its beginning.
inline constexpr int kDriveStride = 12;

/// The drive as a parametric model for output error: a `RollingBicycle` (exact geometry) driven by measured steering
/// and speed, with the states of each segment's beginning as further unknowns: lateral velocity and yaw rate, and of
/// roll, roll rate and lagging slips what they differ by from steady cornering. (Were they taken as steady, a
/// transient of half a second a segment would move stiffnesses by 4 to 10 %.)
///
/// Each segment may have constants of its own in addition to biases of steering and sensors, further unknowns of it
/// (`DriveModelOptions::offsets`): for simulations that nothing corrects, see drive_open_loop.hpp.
///
/// Effects of a racing car are added where the options have them: a bank of the road is one more unknown of each
/// segment, axle loads move with the speed and with its derivative (the recorded speed's below kPedalBand_Hz).
///
/// Outputs: yaw_rate; accel_y at the sensor's place, a_y + x r' - y r^2 - z phi'', with g phi where the body rolls
/// and gravity's share was not taken off; lateral_velocity, v, of course and heading v + u bias - delay a_y; and of a
/// body that rolls roll and roll_rate; each where it is recorded. Integrated by RK4 with steps of at most 10 ms and
/// two fifths of the bicycle's fastest time constant at the start. Delays shift inputs and outputs by cubic
/// interpolation. The mass only scales C_f, C_r and I_z: it is never free.
///
/// Noise of the recorded steering would take some of every gain away. By default the steering is therefore replaced
/// by what is to be expected of it (`numerics::denoised`), and the outputs are not filtered; what is left of the noise
/// moves the vehicle, and the residual is coloured by it (`steering_noise`), which intervals allow for. A filter that
/// takes the colour out would make them smaller, and wrong: it weighs most what the steering's noise distorts most,
/// whose derivatives have the same noise as the residual, and drew delays of drives without any to -25 ms. With
/// `DriveModelOptions::smoothing_Hz` inputs and outputs are smoothed alike instead: a linear time-invariant system
/// commutes with that exactly, the bicycle to second order in the kernel's length.
///
/// What the model leaves out shows as autocorrelation of the residual: load transfer, compliance of the steering
/// (`steer_scale`, indistinguishable from C_f). Diverged: |v| above 2 u, |r| above 50 rad/s.
class DriveParametricModel
    : public estimation::AutodiffModel<DriveParametricModel, kDriveStride, estimation::OpenLoopModel> {
 public:
  /// All DriveUnknowns, then the initial conditions of the segment.
  template <typename Scalar>
  using Parameters = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  /// A row per sample, a column per output.
  template <typename Scalar>
  using Outputs = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// Takes what it needs of the signals. @throws InputError when steering, speed or yaw rate is missing
  DriveParametricModel(const DriveSignals& signals, std::span<const TimeSpan> spans,
                       const VehicleParameters<double>& start, const DriveModelOptions& options);

  [[nodiscard]] std::span<const estimation::ModelParameter> parameters() const override { return parameters_; }
  [[nodiscard]] std::span<const estimation::ModelOutput> outputs() const override { return outputs_; }
  [[nodiscard]] std::size_t segments() const override { return segments_.size(); }
  [[nodiscard]] Eigen::Index samples(std::size_t segment) const override { return segments_[segment].samples; }
  [[nodiscard]] std::span<const estimation::ModelParameter> initial_conditions(std::size_t segment) const override {
    return segments_[segment].initial;
  }
  [[nodiscard]] std::string segment_name(std::size_t segment) const override;
  /// From its first to its last sample [s].
  [[nodiscard]] TimeSpan segment_span(std::size_t segment) const override;
  [[nodiscard]] std::size_t forecast_outputs() const override { return outputs_.size(); }
  [[nodiscard]] double sample_interval_s() const override { return grid_.step; }
  [[nodiscard]] Eigen::Index samples_before_divergence(std::size_t segment,
                                                       const Eigen::VectorXd& theta) const override;
  void shorten(std::size_t segment, Eigen::Index samples) override;
  [[nodiscard]] double smoothing_Hz() const { return smoothing_Hz_; }  ///< as applied; 0: none
  /// Where it begins on the signals' grid.
  [[nodiscard]] std::size_t first_sample(std::size_t segment) const { return segments_[segment].begin; }

  /// What was measured of the outputs, per segment, smoothed; NaN where missing.
  [[nodiscard]] std::vector<estimation::RowMatrix> measured() const override;

  /// What noise of the steering that is left gives each output at `theta`, midway between slowest and fastest of the
  /// segments; variances 0 and memories 1 without noise, or where the vehicle is unstable there.
  [[nodiscard]] estimation::InputNoise steering_noise(const Eigen::VectorXd& theta) const;

  /// Fills `output`; false where the motion diverged. Compiled for double and Jets.
  template <typename Scalar>
  bool simulate(std::size_t segment, const Parameters<Scalar>& theta, Outputs<Scalar>& output) const;
  /// Derivatives with respect to initial conditions, which are forgotten within seconds.
  bool simulate_transient(std::size_t segment, const Parameters<ceres::Jet<double, kDriveStride>>& theta,
                          Outputs<ceres::Jet<double, kDriveStride>>& output) const;

 private:
  /// How far a drive is simulated.
  enum class Extent { kWhole, kTransient };
  struct Segment {
    std::size_t begin = 0;  // into the signals' grid
    Eigen::Index samples = 0;
    int substeps = 1;
    std::vector<estimation::ModelParameter> initial;
  };
  /// What is compared with the model: a recorded signal.
  struct Compared {
    DriveSignal signal = DriveSignal::kYawRate;
    std::vector<double> value;
  };

  /// Over samples [begin, end) of the grid.
  [[nodiscard]] Segment make_segment(std::size_t begin, std::size_t end) const;
  /// Calls `work(model, states)` with the vehicle at `theta` and its number of states as a constant.
  template <typename Scalar, typename Work>
  auto with_model(const Parameters<Scalar>& theta, const Work& work) const;
  /// `kTransient`: outputs are 0 once no state depends on where the segment began.
  template <int kStates, typename Scalar, typename Tyre>
  bool drive(const Segment& segment, const RollingBicycle<Scalar, Tyre>& model, const Parameters<Scalar>& theta,
             Extent extent, Outputs<Scalar>& output) const;
  template <typename Scalar>
  bool simulate(const Segment& segment, const Parameters<Scalar>& theta, Extent extent, Outputs<Scalar>& output) const;
  /// What a sensor would show without errors at a state and its rates.
  template <int kStates, typename Scalar>
  [[nodiscard]] Scalar true_output(DriveSignal signal, const Eigen::Matrix<Scalar, kStates, 1>& state,
                                   const RollingBicycleRates<Scalar, kStates>& rates,
                                   const Parameters<Scalar>& theta) const;
  /// The same as it is recorded, delays apart.
  template <typename Scalar>
  [[nodiscard]] Scalar recorded(DriveSignal signal, const Scalar& shown, const Parameters<Scalar>& theta) const;
  /// Replaces outputs whose sensors are late by what `shown` (by output, then sample) was before.
  template <typename Scalar>
  void delay_outputs(const std::vector<std::vector<Scalar>>& shown, const Parameters<Scalar>& theta,
                     Outputs<Scalar>& output) const;
  /// About straight driving at speed u.
  [[nodiscard]] LinearDrive linearized(double u, const Eigen::VectorXd& theta) const;
  /// Whether loads of the axles change.
  [[nodiscard]] bool moves_loads() const;
  struct SpeedRange {
    double slowest = 0.0, fastest = 0.0;  // [m/s]
  };
  /// Over all segments.
  [[nodiscard]] SpeedRange speeds() const;
  [[nodiscard]] bool delays_outputs(double yaw_rate_delay, double accel_delay) const;
  /// Samples at both ends of a segment of which a delay within three standard deviations of its prior may show what was
  /// before or is after it; none where those are three or fewer.
  [[nodiscard]] Eigen::Index out_of_reach(DriveSignal signal) const;

  numerics::UniformGrid grid_;
  std::array<double, 3> accel_position_{};
  bool gravity_removed_ = false;
  double removed_gradient_ = 0.0;
  double steer_sigma_ = 0.0;
  double steer_error_share_ = 0.0;  // of its variance, after the estimate of the steering
  std::vector<double> steer_, speed_;
  std::vector<double> speed_rate_;  // empty: no load is moved by it
  std::vector<Compared> compared_;  // in the order of outputs_
  VehicleParameters<double> start_;
  DriveModelOptions options_;
  double smoothing_Hz_ = 0.0;
  std::vector<estimation::ModelParameter> parameters_;
  std::vector<estimation::ModelOutput> outputs_;
  std::vector<Segment> segments_;
};

}  // namespace veridyn::vehicle
