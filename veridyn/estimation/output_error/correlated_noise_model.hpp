#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "veridyn/estimation/output_error/model_view.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"

namespace veridyn::estimation {

/// View of a model, which must outlive it, in outputs whose measurement noise is white where that of the model's own
/// outputs is stationary and of first order: corr(nu_k, nu_k-m) = phi^m of samples m apart, phi by output. Generalised
/// least squares for estimators that know only white noise.
///
///     v_k = (y_k - phi^m y_k-m) / sqrt(1 - phi^2m), k - m the last sample before k that was measured
///
/// The first measured sample of a segment stays as it is. Units and standard deviations are those of the outputs.
class CorrelatedNoiseModel final : public ModelView {
 public:
  /// `measured`: by segment, samples x outputs, NaN where nothing was measured. `correlation`: phi of each output, from
  /// 0 to below 1.
  CorrelatedNoiseModel(const ParametricModel& model, const std::vector<RowMatrix>& measured,
                       Eigen::VectorXd correlation);

  [[nodiscard]] bool respond(std::size_t segment, const Eigen::VectorXd& theta, std::span<const Eigen::Index> active,
                             ModelResponse& response) const override;

  /// A recording or response, samples x outputs, as the model shows its own; NaN stays.
  [[nodiscard]] RowMatrix whitened(std::size_t segment, const RowMatrix& values) const;
  /// Those of all segments.
  [[nodiscard]] std::vector<RowMatrix> whitened(const std::vector<RowMatrix>& values) const;
  /// Back from that.
  [[nodiscard]] RowMatrix restored(std::size_t segment, const RowMatrix& values) const;

 private:
  std::vector<RowMatrix> kept_;          ///< by segment, samples x outputs: phi^m; 0 where v = y
  std::vector<Eigen::MatrixXi> before_;  ///< k - m
};

/// Correlation of an estimate's noise from sample to sample.
struct NoiseCorrelation {
  Eigen::VectorXd correlation;  ///< phi by output
  double gain = 0.0;  ///< twice the gain of the log likelihood against white noise; by chance as chi-square, one degree
                      ///< of freedom an output
};

/// phi that makes a recording most likely about an estimate, from 0 to 0.98. The likelihood is the marginal one: what
/// the unknowns (on a line about the estimate, with their priors) may have absorbed of the noise is integrated out, so
/// that phi is not too small where many unknowns were fitted, as the correlation of the residuals is. The noise's size
/// is free, its ratio between outputs that of `sigma`. Nothing where the model cannot be simulated there.
[[nodiscard]] std::optional<NoiseCorrelation> noise_correlation(const ParametricModel& model,
                                                                const std::vector<RowMatrix>& measured,
                                                                const OutputErrorEstimate& estimate,
                                                                const Eigen::VectorXd& sigma, int threads);

}  // namespace veridyn::estimation
