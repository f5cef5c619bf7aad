#pragma once

#include <span>
#include <string>

#include "veridyn/core/cloned.hpp"
#include "veridyn/cueing/perception/vestibular_model.hpp"
#include "veridyn/cueing/washout/classical_washout.hpp"
#include "veridyn/cueing/washout/shared_channels.hpp"
#include "veridyn/numerics/optimal_control/horizon_programme.hpp"

namespace veridyn::cueing {

/// Numbers of the model predictive washout.
class PredictiveDesign final : public WashoutDesign {
 public:
  SharedKnobs shared;
  double force_weight = 1.0;  ///< of the squared error of felt force over its threshold
  double rate_weight = 1.0;   ///< of the squared felt rate of the tilt over its threshold
  double shift_weight = 3.0;  ///< of the squared shift over the platform's range
  double tilt_weight = 0.3;   ///< of the squared angle over the platform's range
  double fades = 3.0;         ///< time constant with which a force that nothing explains is foreseen to fade [s]
  double use = 0.95;          ///< share of the platform's range that is planned with
  std::string perception = "young_meiry";
  Cloned<Foresight> foresight;  ///< nothing: forces are foreseen to fade

  [[nodiscard]] std::vector<Knob> knobs() override;
  void foresee_from(const Foresight& from) override { foresight = Cloned(from.clone()); }
  [[nodiscard]] std::unique_ptr<Washout> make(const Platform& platform) const override;
  [[nodiscard]] std::unique_ptr<WashoutDesign> clone() const override {
    return std::make_unique<PredictiveDesign>(*this);
  }
};

/// How the plans of a drive went.
struct PlanCounts {
  long plans = 0;       ///< that were made
  long iterations = 0;  ///< of all of them
  long most = 0;        ///< iterations of one
  long late = 0;        ///< of them not ready within the iterations: the tail of the one before was followed
  long classical = 0;   ///< moments at which there was no tail either, and the classical algorithm was followed
};

/// Surge with pitch, or sway with roll, planned ahead. States: what the rider feels less what the driver feels by the
/// otoliths (2), what of the tilt the canals feel (3), angle and its rate; of a platform that shifts: shift and its
/// rate. Inputs: the angle's second derivative, and the shift's.
template <int kStates, int kInputs>
class PlannedPair {
 public:
  using Programme = numerics::HorizonProgramme<kStates, kInputs>;
  static constexpr std::size_t kSteps = kForeseenSteps;  ///< of a plan, see kForeseenTimes
  static constexpr double kReplan = 0.0095;              ///< plans are no older than the sample after this [s]

  PlannedPair(const PredictiveDesign& design, const Platform& platform, Eigen::Index pair);
  /// What is foreseen of the force from now on: at the present, and in the middle of every step of a plan [m/s^2].
  void foresee(double now, const std::array<double, kSteps>& then);
  /// @param fallback where the classical algorithm would have the angle and the shift
  PairedOutput step(double force, const PairedOutput& fallback, SampleStep step);
  [[nodiscard]] const PlanCounts& counts() const { return counts_; }
  /// The last plan's programme, to solve it by something else, and where it began.
  [[nodiscard]] const Programme& programme() const { return programme_; }
  [[nodiscard]] const typename Programme::State& planned_from() const { return planned_from_; }

 private:
  using State = typename Programme::State;
  using Input = typename Programme::Input;
  void plan(double force);
  [[nodiscard]] Input planned(const PairedOutput& fallback);

  typename Programme::StateMatrix A_;
  typename Programme::Map B_;
  State of_force_;                        ///< continuous: how the vehicle's force drives the error
  std::array<State, kSteps> held_force_;  ///< the same over the steps of the plan
  std::array<double, kSteps> fade_ = {};  ///< of a force until the middles of the steps
  Programme programme_;
  double foreseen_now_ = 0.0;
  std::array<double, kSteps> foreseen_ = {};
  std::vector<Input> tail_;
  double since_plan_ = 0.0;
  bool has_plan_ = false;
  State x_ = State::Zero(), planned_from_ = State::Zero();
  double force_ = 0.0;
  PlanCounts counts_;
};

/// Model predictive control (Dagdelen, Reymond, Kemeny, Bordier & Maizi 2009, Control Eng Pract 17:995; Beghi,
/// Bruschetta & Maran 2012, IEEE CDC): at every sample, and no more than 100 times a second, a quadratic programme over
/// the next 4.4 s finds the accelerations of angle and shift with the least perceived error, the platform's range,
/// rates and accelerations being bounds. The vehicle's force is foreseen by a `Foresight`, and to fade as far as that
/// does not explain it; its own turns and heave are rendered as by the classical algorithm. Where a plan is not ready
/// in its iterations the last one's tail is followed, then the classical algorithm, from wherever the platform is.
class PredictiveWashout final : public Washout {
 public:
  /// @throws InputError as `check_knobs`.
  PredictiveWashout(const PredictiveDesign& design, const Platform& platform);
  [[nodiscard]] std::unique_ptr<Washout> clone() const override { return std::make_unique<PredictiveWashout>(*this); }

  /// Of both pairs together.
  [[nodiscard]] PlanCounts counts() const;
  [[nodiscard]] std::string account() const override;

 private:
  PlatformCommand next(const VehicleMotion& motion, SampleStep step) override;

  /// The plans' force of a specific force [m/s^2].
  [[nodiscard]] double planned_force(const Eigen::Vector3d& force, Eigen::Index pair) const;
  /// Tells both pairs what is foreseen.
  void look_ahead(const VehicleMotion& motion, SampleStep step);

  PredictiveDesign design_;
  Foreseen foreseen_;
  std::array<ForesightAccount, 2> foresight_account_;
  SharedChannels shared_;
  std::array<numerics::CausalFilter, 2> low_pass_;  ///< of the classical algorithm that stands by
  std::array<TiltCoordination, 2> tilt_;
  std::array<ShiftChannel, 2> shift_;
  std::vector<PlannedPair<7, 1>> tilting_;   ///< of pairs that do not shift
  std::vector<PlannedPair<9, 2>> shifting_;  ///< of those that do
  std::array<bool, 2> shifts_ = {};
};

}  // namespace veridyn::cueing
