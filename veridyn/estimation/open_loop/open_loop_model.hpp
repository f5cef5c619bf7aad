#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/estimation/output_error/parametric_model.hpp"

namespace veridyn::estimation {

/// A parametric model that is integrated open loop: from recorded inputs alone, for as long as these go. Its segments
/// are windows, which can be shortened: to the first seconds, from which the initial state is estimated, and to what
/// comes before a simulation diverges.
class OpenLoopModel : public ParametricModel {
 public:
  /// How many of the outputs, from the first on, are forecast and judged.
  [[nodiscard]] virtual std::size_t forecast_outputs() const = 0;
  /// What was measured of the outputs, per segment; NaN where missing.
  [[nodiscard]] virtual std::vector<RowMatrix> measured() const = 0;
  /// From its first to its last sample, in its recording's own time [s].
  [[nodiscard]] virtual TimeSpan segment_span(std::size_t segment) const = 0;
  /// Between two samples of the outputs [s].
  [[nodiscard]] virtual double sample_interval_s() const = 0;
  /// The samples of a segment before it diverges, all where it does not.
  [[nodiscard]] virtual Eigen::Index samples_before_divergence(std::size_t segment,
                                                               const Eigen::VectorXd& theta) const = 0;
  /// Leaves the first `samples` of a segment. @param samples  at most those that it has
  virtual void shorten(std::size_t segment, Eigen::Index samples) = 0;
  /// By how much each of several draws of what acts on the model and is not among its inputs changes what is forecast
  /// of a segment: a row a sample; those of a shortened segment are the first of the same. A draw that diverges is
  /// empty. None where nothing is known to act.
  [[nodiscard]] virtual std::vector<RowMatrix> disturbances(std::size_t /*segment*/,
                                                            const Eigen::VectorXd& /*theta*/) const {
    return {};
  }
};

}  // namespace veridyn::estimation
