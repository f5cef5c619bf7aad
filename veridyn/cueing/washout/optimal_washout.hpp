#pragma once

#include <string>

#include "veridyn/cueing/perception/vestibular_model.hpp"
#include "veridyn/cueing/washout/shared_channels.hpp"

namespace veridyn::cueing {

/// Numbers of the optimal washout: what an error of feeling, and what the platform's travel costs.
class OptimalDesign final : public WashoutDesign {
 public:
  std::array<double, 2> force_gain = {0.6, 0.6};  ///< surge, sway
  std::array<double, 2> rate_gain = {0.6, 0.6};   ///< roll, pitch
  double heave_gain = 0.5, yaw_gain = 0.6;
  double force_weight = 1.0;                     ///< of the squared error of felt force over its threshold
  double rate_weight = 1.0;                      ///< of the squared error of felt rate over its threshold
  double shift_weight = 30.0;                    ///< of the squared shift over the platform's range
  double tilt_weight = 1.0;                      ///< of the squared angle over the platform's range
  double force_change = 1.0, rate_change = 2.0;  ///< how fast forces and rates of the vehicle change [rad/s]
  double tilt_rate = 3.0 * kDegree;              ///< greatest rate of the angle that stands for a force [rad/s]
  std::string perception = "young_meiry";

  [[nodiscard]] std::vector<Knob> knobs() override;
  [[nodiscard]] std::unique_ptr<Washout> make(const Platform& platform) const override;
  [[nodiscard]] std::unique_ptr<WashoutDesign> clone() const override { return std::make_unique<OptimalDesign>(*this); }
};

/// One pair of axes, or one axis, that a linear-quadratic design drives. States: what is felt of the platform less what
/// is felt of the vehicle, by otoliths (2) and canal (3); angle; shift, its rate and its integral. Inputs of the
/// platform: the angle's rate and the shift's acceleration. Inputs of the vehicle, taken for filtered white noise:
/// force and rate.
class OptimalChannel {
 public:
  static constexpr Eigen::Index kMostStates = 9, kFelt = 5;
  using State = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostStates, 1>;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostStates, kMostStates>;
  using Input = Eigen::Vector2d;  ///< force and rate of the vehicle, or angle's rate and shift's acceleration

  /// View of a model of perception, and what the design is of.
  struct Options {
    const VestibularModel* model = nullptr;
    std::size_t canal = 0;                           ///< the axis that turns
    bool turns = true, shifts = true, tilts = true;  ///< what moves; whether the angle stands for a force
    double angle_range = 1.0, shift_range = 1.0;     ///< [rad], [m]
    double most_rate = kInfinity;                    ///< of the angle that stands for the force [rad/s]
    double felt_rate = 1.0, felt_force = 1.0;        ///< thresholds [rad/s], [m/s^2]
    OptimalDesign weights;
  };
  /// @throws InputError where there is no such control.
  explicit OptimalChannel(const Options& options);

  /// @param input force [m/s^2] and rate [rad/s] that are to be felt
  PairedOutput step(const Input& input, SampleStep step);

  /// The platform's inputs over the vehicle's at a frequency where no limit is reached: columns force, rate.
  [[nodiscard]] Eigen::Matrix2cd response(double omega) const;

 private:
  [[nodiscard]] Input control(const State& x, const Input& vehicle) const;
  [[nodiscard]] State next(const State& x, const Input& before, const Input& now, double step, bool limited) const;

  bool turns_, shifts_;
  double most_rate_;
  Square A_;
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, kMostStates, 2> of_platform_, of_vehicle_;
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, kMostStates> K_;
  Eigen::Matrix2d K_vehicle_;
  // The system is linear: what the vehicle's force brings and what its rate brings are followed separately, so that the
  // rate of the tilt alone can be limited.
  State by_force_, by_rate_;
  Input vehicle_ = Input::Zero();
};

/// The washout that makes the rider's perceived error least under the platform's travel, for linear organs of balance
/// and a vehicle whose motion is filtered noise (Sivan, Ish-Shalom & Huang 1982, IEEE Trans Syst Man Cybern 12:818;
/// Reid & Nahon 1985, UTIAS 296). Its control acts on the states themselves, so that a limited rate of tilt is known to
/// it.
class OptimalWashout final : public Washout {
 public:
  /// @throws InputError as `check_knobs` and where no control makes the cost finite.
  OptimalWashout(const OptimalDesign& design, const Platform& platform);
  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<OptimalWashout>(*this); }

  /// Sway and roll; surge and pitch; heave; yaw.
  [[nodiscard]] const std::vector<OptimalChannel>& channels() const { return channels_; }

 private:
  PlatformCommand next(const VehicleMotion& motion, SampleStep step) override;

  OptimalDesign design_;
  std::vector<OptimalChannel> channels_;
};

}  // namespace veridyn::cueing
