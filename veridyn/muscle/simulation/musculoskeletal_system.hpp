#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/muscle/actuator/muscle_group.hpp"
#include "veridyn/muscle/dynamics/coordinate_reduction.hpp"
#include "veridyn/muscle/dynamics/loop_constraints.hpp"
#include "veridyn/muscle/dynamics/mechanism.hpp"
#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/path/muscle_path.hpp"
#include "veridyn/muscle/path/path_fit.hpp"
#include "veridyn/muscle/simulation/passive_forces.hpp"

namespace veridyn::muscle {

/// Where path lengths and moment arms come from.
enum class PathSource {
  kExact,      ///< wrapping, computed at every pose
  kFitted,     ///< wrapping paths as polynomials fitted to it once, with a stated error; exact where no fit is good
  kAsOpenSim,  ///< OpenSim's own wrapping, jumps included, for comparisons; no derivatives
};

/// A mass held by a body.
struct HeldLoad {
  std::string body;
  double mass = 0.0;                                   ///< [kg]
  Eigen::Vector3d location = Eigen::Vector3d::Zero();  ///< in the body's frame [m]
};

/// How a model is prepared for simulation.
struct SystemOptions {
  PathSource paths = PathSource::kExact;
  /// Coordinates held at their start value, in addition to those that the model locks.
  std::vector<std::string> locked{};
  /// Coordinates that the model locks and that move nevertheless.
  std::vector<std::string> unlocked{};
  /// Continue without forces and constraints of the model that are not understood.
  bool without_unsupported = false;
  /// Leave the model's contacts out: what they do is among the external loads.
  bool without_contact = false;
};

/// What distinguishes a system from another one with the same paths: a task from the model that all tasks share.
struct SystemChanges {
  std::vector<HeldLoad> loads{};      ///< added to bodies
  std::vector<std::string> locked{};  ///< coordinates held besides
  /// In place of the model's, in its order and with its names: another person's muscles along the same paths. Empty:
  /// the same.
  std::vector<MuscleParameters> muscles{};
};

/// Positions of a system's states in its state vector: free coordinates [rad or m], their speeds, activations of
/// the muscles that have one, fibre lengths [m] of the muscles that have one.
struct StateLayout {
  std::size_t free = 0;           ///< free coordinates; their speeds follow
  std::vector<int> activation;    ///< by muscle; -1: the excitation is the activation
  std::vector<int> fiber_length;  ///< by muscle; -1: the tendon is rigid
  std::size_t size = 0;
};

/// A model prepared for dynamics: tree, constraints, paths, muscles. Muscles that the file disables are left out.
/// Immutable; used by many threads at once, each with its own `SystemEvaluator`.
class MusculoskeletalSystem {
 public:
  /// @throws InputError naming element and reason: forces that are not understood, unknown coordinates.
  explicit MusculoskeletalSystem(Model model, const SystemOptions& options = {});
  /// `other` with masses added to bodies: the same paths, fitted ones shared. @throws InputError naming a body that
  /// the model does not have.
  MusculoskeletalSystem(const MusculoskeletalSystem& other, std::span<const HeldLoad> loads);
  /// `other` with changes: the same paths, fitted ones shared. @throws InputError naming a body or coordinate that the
  /// model does not have, or muscles that are not the model's.
  MusculoskeletalSystem(const MusculoskeletalSystem& other, const SystemChanges& changes);
  MusculoskeletalSystem(const MusculoskeletalSystem&) = delete;
  MusculoskeletalSystem& operator=(const MusculoskeletalSystem&) = delete;

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const Mechanism& mechanism() const { return mechanism_; }
  [[nodiscard]] const CoordinateReduction& reduction() const { return reduction_; }
  [[nodiscard]] const LoopConstraints& loops() const { return loops_; }
  /// For methods that do not know loops. @throws InputError naming `method` and a constraint where there is one.
  void refuse_loops(std::string_view method) const;
  [[nodiscard]] const MusclePaths& paths() const { return paths_; }
  /// Null unless paths are fitted.
  [[nodiscard]] const FittedPaths* fit() const { return fit_.get(); }
  [[nodiscard]] PathSource path_source() const { return source_; }
  /// Muscles and coordinates of `SystemEvaluator::path_gradient`.
  [[nodiscard]] std::span<const MusclePaths::Pair> pairs() const { return fit_ ? fit_->pairs() : paths_.pairs(); }
  /// Forces between bodies and along passive paths.
  [[nodiscard]] const PassiveForces& passive() const { return passive_; }
  [[nodiscard]] const MuscleGroup<double>& muscles() const { return muscles_; }
  [[nodiscard]] const StateLayout& layout() const { return layout_; }
  [[nodiscard]] std::size_t coordinates() const { return model_.coordinates.size(); }
  /// Sizes of the states, for error control: 0.1 rad or m, 1 per second, activation 0.1, a tenth of L0. With them an
  /// accuracy of 1e-5 leaves arm26 within some 1e-6 rad after a second, as OpenSim's 1e-5 does.
  [[nodiscard]] std::span<const double> scales() const { return scales_; }
  /// "speed of coordinate 'elbow_flexion'", for messages.
  [[nodiscard]] std::string state_name(std::size_t index) const;
  /// For reports: forces left out, muscles disabled, path points inside wrap objects at the default pose, the error of
  /// fitted paths.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  void lay_out_states();

  std::vector<std::string> notes_;
  Model model_;
  Mechanism mechanism_;
  CoordinateReduction reduction_;
  LoopConstraints loops_;
  MusclePaths paths_;
  std::shared_ptr<const FittedPaths> fit_;
  PathSource source_;
  PassiveForces passive_;
  MuscleGroup<double> muscles_;
  StateLayout layout_;
  std::vector<double> scales_;
};

}  // namespace veridyn::muscle
