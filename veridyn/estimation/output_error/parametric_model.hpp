#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::estimation {

/// An unknown of a parametric model and what is known of it before the data are used.
struct ModelParameter {
  std::string name;
  std::string unit = "1";
  double start = 0.0;  ///< where the search begins; also the mean of the prior
  double low = -kInfinity;
  double high = kInfinity;
  /// Standard deviation of the prior about `start`; infinity: no prior.
  double prior_sigma = kInfinity;
  bool fixed = false;  ///< stays at `start`
};

/// An output of a parametric model.
struct ModelOutput {
  std::string name;
  std::string unit = "1";
};

/// What a model predicts for one segment.
struct ModelResponse {
  RowMatrix output;  ///< samples x outputs
  /// (samples outputs) x active parameters: row k outputs + j holds d output(k, j) / d parameter.
  RowMatrix sensitivity;
};

/// A dynamic (or static) model as estimators see it, whatever the domain: named parameters that all segments share,
/// initial conditions of each segment, named outputs at the samples of each segment, and their exact derivatives.
///
/// A segment is one stretch of recorded motion. Its inputs, its sampling and its integrator are the model's own
/// business. theta is always [parameters; initial conditions of the segment]. Functions are const and called from
/// several threads at once. `AutodiffModel` (autodiff_model.hpp) makes the derivatives out of one function template.
class ParametricModel {
 public:
  virtual ~ParametricModel() = default;

  [[nodiscard]] virtual std::span<const ModelParameter> parameters() const = 0;
  [[nodiscard]] virtual std::span<const ModelOutput> outputs() const = 0;
  [[nodiscard]] virtual std::size_t segments() const = 0;
  [[nodiscard]] virtual Eigen::Index samples(std::size_t segment) const = 0;
  /// Unknowns of this segment only: initial states, mostly.
  [[nodiscard]] virtual std::span<const ModelParameter> initial_conditions(std::size_t segment) const = 0;
  /// For messages: "segment 3 (41.0 to 49.5 s)".
  [[nodiscard]] virtual std::string segment_name(std::size_t segment) const {
    return "segment " + std::to_string(segment + 1);
  }

  /// Outputs at `theta`, and their derivatives with respect to theta(active[0]), theta(active[1]), ...; none when
  /// `active` is empty. False when the simulation diverges or leaves the model's range; `response` is then worthless.
  [[nodiscard]] virtual bool respond(std::size_t segment, const Eigen::VectorXd& theta,
                                     std::span<const Eigen::Index> active, ModelResponse& response) const = 0;
};

/// Calls `work(segment)` for all segments of a model, on `threads` threads (0: as many as the machine has).
inline void for_each_segment(const ParametricModel& model, int threads, const std::function<void(std::size_t)>& work) {
  numerics::parallel_for(model.segments(), threads, work);
}

}  // namespace veridyn::estimation
