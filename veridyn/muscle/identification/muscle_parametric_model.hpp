#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/estimation/output_error/parametric_model.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// A parameter of a muscle: "BIClong.optimal_fiber_length".
struct MuscleParameterName {
  int muscle = 0;
  std::size_t field = 0;  ///< in `kMusculotendonFields`
};

/// Reads "MUSCLE.field". @throws InputError at `place` naming the nearest muscle or field.
[[nodiscard]] MuscleParameterName parse_parameter_name(const Model& model, std::string_view text,
                                                       std::string_view place);

/// One motion for estimation or sensitivity: where it starts, what drives it, when it is sampled.
struct MotionSegment {
  StartState start;
  Drive drive;
  std::vector<double> time;  ///< increasing; the first is where it starts [s]
};

/// View of a system, which must outlive it: its forward simulations as estimators see them
/// (`estimation::ParametricModel`). theta are parameters of its muscles, and of each segment the values and speeds of
/// the free coordinates where it starts; outputs are the free coordinates. Exact derivatives by automatic
/// differentiation through paths, muscles, equilibrium at the start and dynamics; steps are those of the values, so
/// that derivatives are those of the numerical solution.
///
/// Initial conditions are fixed at the segment's start unless `estimate_start`.
class MuscleParametricModel final : public estimation::AutodiffModel<MuscleParametricModel, SimulationJet::DIMENSION> {
 public:
  /// Parameters start at the model's values, with bounds of half and one and a half of them.
  MuscleParametricModel(const MusculoskeletalSystem& system, std::vector<MuscleParameterName> parameters,
                        std::vector<MotionSegment> segments, double accuracy = 1e-6, bool estimate_start = false);

  [[nodiscard]] std::span<const estimation::ModelParameter> parameters() const override { return parameters_; }
  [[nodiscard]] std::span<const estimation::ModelOutput> outputs() const override { return outputs_; }
  [[nodiscard]] std::size_t segments() const override { return segments_.size(); }
  [[nodiscard]] Eigen::Index samples(std::size_t segment) const override {
    return static_cast<Eigen::Index>(segments_[segment].time.size());
  }
  [[nodiscard]] std::span<const estimation::ModelParameter> initial_conditions(std::size_t segment) const override {
    return initial_[segment];
  }

  template <typename Scalar>
  [[nodiscard]] bool simulate(std::size_t segment, const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& theta,
                              Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& output) const;

 private:
  const MusculoskeletalSystem* system_;
  std::vector<MuscleParameterName> names_;
  std::vector<estimation::ModelParameter> parameters_;
  std::vector<estimation::ModelOutput> outputs_;
  std::vector<MotionSegment> segments_;
  std::vector<std::vector<estimation::ModelParameter>> initial_;
  double accuracy_;
};

}  // namespace veridyn::muscle
