#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/output_error/parametric_model.hpp"
#include "veridyn/vehicle/identification/drive_signals.hpp"
#include "veridyn/vehicle/model/bicycle_model.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {

/// Unknowns of the drive model, in this order.
enum class DriveUnknown : std::size_t {
  kCf,            ///< cornering stiffness of one front tyre [N/rad]
  kCr,            ///< of one rear tyre
  kIz,            ///< yaw inertia [kg m^2]
  kA,             ///< centre of gravity to front axle [m]; the wheelbase stays
  kMu,            ///< peak friction coefficient D/F_z of the Magic Formula [-]
  kShape,         ///< its shape factor C [-]
  kCurvature,     ///< its curvature factor E [-]
  kSteerBias,     ///< measured minus true [rad]
  kSteerScale,    ///< measured over true, less 1: steering ratio, compliance [-]
  kYawRateBias,   ///< [rad/s]
  kAccelYBias,    ///< [m/s^2]: sensor and mean bank
  kAccelYScale,   ///< measured over true, less 1: roll of the body adds g roll_gradient [-]
  kSteerDelay,    ///< how late the front wheels' force answers the recorded steering [s]
  kYawRateDelay,  ///< how late the yaw rate is recorded [s]
  kAccelYDelay
};
/// How many unknowns there are.
inline constexpr std::size_t kDriveUnknowns = 15;
/// All of them, in order.
inline constexpr auto kAllDriveUnknowns = enumerators<DriveUnknown, kDriveUnknowns>();
/// Their names in studies and results, in the order of the enum.
inline constexpr EnumArray<DriveUnknown, std::string_view, kDriveUnknowns> kDriveUnknownNames{"C_f",
                                                                                              "C_r",
                                                                                              "I_z",
                                                                                              "a",
                                                                                              "mu",
                                                                                              "C",
                                                                                              "E",
                                                                                              "steer_bias",
                                                                                              "steer_scale",
                                                                                              "yaw_rate_bias",
                                                                                              "accel_y_bias",
                                                                                              "accel_y_scale",
                                                                                              "steer_delay",
                                                                                              "yaw_rate_delay",
                                                                                              "accel_y_delay"};
/// Their units, in the same order.
inline constexpr EnumArray<DriveUnknown, std::string_view, kDriveUnknowns> kDriveUnknownUnits{
    "N/rad", "N/rad", "kg m^2", "m", "1", "1", "1", "rad", "1", "rad/s", "m/s^2", "1", "s", "s", "s"};

/// Tyres of the drive model.
enum class DriveTyre {
  kLinear,        ///< F = C alpha
  kMagicFormula,  ///< F = D sin(C atan(B alpha - E (B alpha - atan(B alpha)))), D = mu F_z, B C D = cornering stiffness
};

/// Study keys of `[identify]`.
struct DriveModelOptions {
  DriveTyre tyre = DriveTyre::kLinear;  ///< `tyre = "linear"` or "magic formula"
  /// `estimate = ["C_f", "C_r", ...]`: names of what is free. Default: C_f, C_r, I_z, the three biases, and with the
  /// Magic Formula mu and C. What is not free stays at its start.
  EnumArray<DriveUnknown, bool, kDriveUnknowns> free{};
  /// `[identify.start] mu = 1`: where the search begins; also the mean of the prior.
  EnumArray<DriveUnknown, double, kDriveUnknowns> start{};
  /// `[identify.prior] steer_bias = "1 deg"`: standard deviation of what is known beforehand; infinite: nothing.
  /// Defaults: steer_bias 1 deg, yaw_rate_bias 1 deg/s, accel_y_bias 0.5 m/s^2 (at one constant speed the three are
  /// indistinguishable without), steer_scale and accel_y_scale 0.1, delays 0.1 s, C 0.2, E 0.5.
  EnumArray<DriveUnknown, double, kDriveUnknowns> prior{};
  /// `smoothing`: cut-off of the kernel through which inputs and outputs alike go before the comparison [Hz]. Noise of
  /// the steering acts on the lateral acceleration at once (2 C_f/m times it), and what it adds to the slip angle's
  /// power is taken off C_f: 1.3 % for 0.1 deg of white noise at 100 Hz on 0.9 deg rms of slip. 4 Hz leave a tenth of
  /// that. 0: none; negative (the default): 4 Hz or a tenth of the rate, where the steering's noise is above 1e-4 of
  /// the steering.
  double smoothing_Hz = -1.0;
  /// C_f, C_r and I_z are looked for between their start over this and times it; no key.
  double search_factor = 1e3;
  double gravity = kGravity;

  DriveModelOptions();
  /// @throws InputError naming file, line and key.
  void read_keys(const StudyTable& table);
};

/// A sampled input between its samples: cubic through the four neighbours (Catmull-Rom), so that shifts in time have a
/// derivative.
struct SampledInput {
  std::span<const double> value;
  double step = 0.01;

  /// At `position` [samples from the first]; the end values hold outside.
  template <typename Scalar>
  [[nodiscard]] Scalar at(const Scalar& position) const;
};

/// The drive as a parametric model for output error: the nonlinear bicycle (exact geometry) driven by measured steering
/// and speed, with lateral velocity and yaw rate of each segment's beginning as further unknowns.
///
/// Outputs: yaw_rate, accel_y at the sensor's place, a_y + x r' - y r^2 (where recorded), lateral_velocity (where
/// recorded).
/// Inputs are taken as they were recorded, smoothed together with the outputs (`DriveModelOptions::smoothing_Hz`): a
/// linear time-invariant system commutes with that exactly, the bicycle to second order in the kernel's length.
/// Integrated by RK4 with steps of at most 5 ms and a third of the fastest tyre relaxation at the start values. Delays
/// shift inputs and outputs by cubic interpolation. The mass only scales C_f, C_r and I_z: it is never free.
///
/// What the bicycle leaves out shows as autocorrelation of the residual: load transfer and roll (a sensor on the body
/// feels g sin(roll): free `accel_y_scale`, or give `roll_gradient`), tyre relaxation (0.3 to 0.6 m of travel: a
/// `steer_delay` of 15 to 30 ms at 20 m/s), compliance of the steering (`steer_scale`, indistinguishable from C_f).
/// Diverged: |v| above 2 u, |r| above 50 rad/s.
class DriveParametricModel : public estimation::AutodiffModel<DriveParametricModel> {
 public:
  /// All DriveUnknowns, then lateral velocity and yaw rate at the segment's beginning.
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
  [[nodiscard]] TimeSpan segment_span(std::size_t segment) const;
  [[nodiscard]] double smoothing_Hz() const { return smoothing_Hz_; }  ///< as applied; 0: none
  /// Where it begins on the signals' grid.
  [[nodiscard]] std::size_t first_sample(std::size_t segment) const { return segments_[segment].begin; }

  /// What was measured of the outputs, per segment, smoothed; NaN where missing.
  [[nodiscard]] std::vector<estimation::RowMatrix> measured() const;

  /// Fills `output`; false where the motion diverged. Compiled for double and Jets of 8.
  template <typename Scalar>
  bool simulate(std::size_t segment, const Parameters<Scalar>& theta, Outputs<Scalar>& output) const;

 private:
  struct Segment {
    std::size_t begin = 0;  // into the signals' grid
    Eigen::Index samples = 0;
    int substeps = 1;
    std::vector<estimation::ModelParameter> initial;
  };

  /// Over samples [begin, end) of the grid.
  [[nodiscard]] Segment make_segment(std::size_t begin, std::size_t end) const;
  template <typename Scalar, typename Tyre>
  bool drive(const Segment& segment, const BicycleModel<Scalar, Tyre>& model, const Parameters<Scalar>& theta,
             Outputs<Scalar>& output) const;
  /// Yaw rate and accel_y of `output` as the sensors' delays let them be recorded.
  template <typename Scalar>
  void delay_outputs(const Parameters<Scalar>& theta, const std::vector<Scalar>& yaw_rate,
                     const std::vector<Scalar>& accel, Outputs<Scalar>& output) const;

  numerics::UniformGrid grid_;
  std::array<double, 3> accel_position_{};
  std::vector<double> steer_, speed_;                               // smoothed
  std::vector<double> yaw_rate_, accel_y_, lateral_velocity_meas_;  // what is compared with
  VehicleParameters<double> start_;
  DriveModelOptions options_;
  double smoothing_Hz_ = 0.0;
  bool accel_ = false;
  bool lateral_velocity_ = false;
  std::vector<estimation::ModelParameter> parameters_;
  std::vector<estimation::ModelOutput> outputs_;
  std::vector<Segment> segments_;
};

}  // namespace veridyn::vehicle
