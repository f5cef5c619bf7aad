#include "veridyn/muscle/simulation/path_derivatives.hpp"

#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"

namespace veridyn::muscle {
namespace {

/// View of a system.
template <typename Jet>
class JetPathDerivatives final : public PathDerivatives {
 public:
  explicit JetPathDerivatives(const MusculoskeletalSystem& system)
      : system_(&system),
        free_(system.reduction().free().size()),
        kinematics_(system.mechanism()),
        workspace_(system.paths()),
        q_jets_(system.coordinates()),
        length_jets_(system.muscles().size()),
        gradient_jets_(system.pairs().size()) {
    length_.resize(length_jets_.size());
    gradient_.resize(gradient_jets_.size());
    curvature_.resize(gradient_jets_.size() * free_);
  }

  void evaluate(const double* q, const double* slope) override {
    const CoordinateReduction& reduction = system_->reduction();
    for (std::size_t first = 0; first < free_; first += kWidth) {
      for (std::size_t c = 0; c < q_jets_.size(); ++c) {
        q_jets_[c] = Jet(q[c]);
        const int root = reduction.free_root(static_cast<int>(c));
        if (root >= static_cast<int>(first) && root < static_cast<int>(first + kWidth))
          q_jets_[c].v(root - static_cast<int>(first)) = slope[c];
      }
      evaluate_jets();
      for (std::size_t p = 0; p < gradient_.size(); ++p) {
        gradient_[p] = gradient_jets_[p].a;
        for (std::size_t k = first; k < std::min(free_, first + kWidth); ++k)
          curvature_[p * free_ + k] = gradient_jets_[p].v(k - first);
      }
    }
    for (std::size_t m = 0; m < length_.size(); ++m) length_[m] = length_jets_[m].a;
  }

 private:
  static constexpr auto kWidth = static_cast<std::size_t>(Jet::DIMENSION);

  void evaluate_jets() {
    const FittedPaths* fit = system_->fit();
    if (fit != nullptr && fit->all_fitted()) {
      fit->evaluate(q_jets_.data(), length_jets_.data(), gradient_jets_.data());
      return;
    }
    update_positions(system_->mechanism(), q_jets_.data(), kinematics_);
    if (fit != nullptr) {
      fit->evaluate(system_->paths(), kinematics_, q_jets_.data(), workspace_, length_jets_.data(),
                    gradient_jets_.data());
      return;
    }
    system_->paths().evaluate(kinematics_, q_jets_.data(), workspace_);
    std::copy(workspace_.length.begin(), workspace_.length.end(), length_jets_.begin());
    std::copy(workspace_.gradient.begin(), workspace_.gradient.end(), gradient_jets_.begin());
  }

  const MusculoskeletalSystem* system_;
  std::size_t free_;
  Kinematics<Jet> kinematics_;
  PathWorkspace<Jet> workspace_;
  std::vector<Jet> q_jets_, length_jets_, gradient_jets_;
};

}  // namespace

std::unique_ptr<PathDerivatives> make_path_derivatives(const MusculoskeletalSystem& system) {
  if (system.reduction().free().size() <= static_cast<std::size_t>(PathJet::DIMENSION))
    return std::make_unique<JetPathDerivatives<PathJet>>(system);
  return std::make_unique<JetPathDerivatives<SimulationJet>>(system);
}

}  // namespace veridyn::muscle
