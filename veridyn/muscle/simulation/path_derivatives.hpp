#pragma once

#include <memory>
#include <span>
#include <vector>

#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// View of a system: path lengths, their gradients, and how the gradients change with the free coordinates, at one pose
/// at a time. A workspace for one thread; `evaluate` does not allocate.
class PathDerivatives {
 public:
  virtual ~PathDerivatives() = default;
  /// For values `q` of all coordinates, on the constraints; `slope`, by coordinate: dq over the free coordinate that it
  /// follows.
  virtual void evaluate(const double* q, const double* slope) = 0;

  /// By muscle [m].
  [[nodiscard]] std::span<const double> length() const { return length_; }
  /// dL/dq in the order of `system.pairs()`.
  [[nodiscard]] std::span<const double> gradient() const { return gradient_; }
  /// d(gradient of a pair)/d(free coordinate k): pair after pair.
  [[nodiscard]] std::span<const double> curvature() const { return curvature_; }

 protected:
  std::vector<double> length_, gradient_, curvature_;
};

/// By automatic differentiation, two coordinates at a time where no more are free, else six.
[[nodiscard]] std::unique_ptr<PathDerivatives> make_path_derivatives(const MusculoskeletalSystem& system);

}  // namespace veridyn::muscle
