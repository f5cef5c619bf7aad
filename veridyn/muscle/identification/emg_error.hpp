#pragma once

#include <Eigen/Core>
#include <vector>

#include "veridyn/muscle/identification/emg_priors.hpp"
#include "veridyn/muscle/model/signals.hpp"

namespace veridyn::muscle {

/// How far recorded EMG envelopes are from the excitations that they stand for: an error of each signal in
/// `kEmgErrorParts` independent parts. The quickest changes as fast as the envelope's bandwidth lets it (few motor
/// units under an electrode), the slowest over a second and more (electrodes that move over the muscle, crosstalk,
/// fatigue). Each has the standard deviation hypot(relative e, absolute) before a recording says how large it is: as
/// one does not know at which pace the stated error changes, it is allowed for at each.
struct EmgError {
  double relative = kEmgBudget[0].sigma;
  double absolute = 0.0;      ///< of full scale
  double bandwidth_Hz = 6.0;  ///< of the envelope
  double slow_s = 2.0;        ///< over which the slowest part keeps its value

  [[nodiscard]] bool any() const { return relative > 0.0 || absolute > 0.0; }
  /// Of the independent errors that make up the quickest part [s]: with the shapes of `PathMuscleColumn` its spectrum
  /// is 2 dB down at the bandwidth, 10 dB at twice and nothing at three times that, as of a low-passed envelope.
  [[nodiscard]] double spacing() const { return 0.25 / bandwidth_Hz; }
};

/// One of the independent errors that make up that of a signal: it has the shape cos(pi (t - knot)/(2 spacing)) where
/// |t - knot| < spacing. The squares of neighbours' shapes add up to one.
struct EmgErrorShape {
  double knot = 0.0, spacing = 1.0;  ///< [s], on the clock of the EMG
  int part = 0;                      ///< 0: the quickest
};
inline constexpr int kEmgErrorParts = 3;

/// Those of a signal from `begin` to `end`, from the quickest part to the slowest, spacings in even ratios. None where
/// the EMG is exact.
[[nodiscard]] std::vector<EmgErrorShape> error_shapes(const EmgError& error, double begin, double end);

/// The excitation e that an envelope r of one signal stands for where its errors are `size` [standard deviations], by
/// shape: the solution at x = 1 of de/dx = hypot(relative e, absolute) sum(size shape) with e = r at x = 0, so that a
/// positive envelope stands for a positive excitation. It is within 0 and `kMostEmg`.
[[nodiscard]] ControlSignals without_errors(const ControlSignals& envelope, const EmgError& error,
                                            const std::vector<EmgErrorShape>& shapes,
                                            const Eigen::Ref<const Eigen::VectorXd>& size);
inline constexpr double kMostEmg = 4.0;

}  // namespace veridyn::muscle
