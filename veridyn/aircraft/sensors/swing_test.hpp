#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/estimation/uncertainty/damped_cosine.hpp"
#include "veridyn/estimation/uncertainty/monte_carlo.hpp"

namespace veridyn::aircraft {

/// How the aircraft hangs.
enum class Suspension {
  kBifilar,  ///< from two parallel lines, turning about the vertical: I = m g d^2/(4 w^2 L)
  kPendulum  ///< swinging about a pivot, distance l above the centre of gravity: I_pivot = m g l/w^2
};

/// Swings about one body axis: how it hung, and the frequencies.
struct SwingAxis {
  char axis = 'x';
  Suspension suspension = Suspension::kBifilar;
  double filar_distance = 0.0;  ///< d, between the lines [m]; bifilar
  double length = 0.0;          ///< L of the lines or l from pivot to centre of gravity, aircraft in its cradle [m]
  double cradle_length = 0.0;   ///< the same with the cradle alone [m]
  double offset = 0.0;          ///< pendulum: how much further from the pivot the aircraft's centre of gravity is [m]
  std::vector<std::filesystem::path> files = {},
                                     cradle_files = {};  ///< runs with the aircraft, and of the cradle alone
};

/// A swing test. Study table `[swing_test]`.
struct SwingTest {
  std::string name = "aircraft";
  double mass = 0.0, cradle_mass = 0.0;  ///< of the aircraft alone, of the cradle; 0: none [kg]
  double gravity = kGravity;
  double sigma_mass = 0.002, sigma_filar_distance = 0.002, sigma_length = 0.005;
  std::string channel;
  double settle_s = 0.0;
  double fade = 0.1;
  double max_relative_sigma = 0.1;
  std::size_t draws = 100000;
  std::uint64_t seed = 1;
  std::vector<SwingAxis> axes;

  [[nodiscard]] static const KeyTable<SwingTest>& keys();
};

/// The angle of a recorded swing [rad]: the given channel, or the turn about the main axis of a motion in quaternions
/// (rotation vector from the mean attitude, its first principal component).
struct SwingAngle {
  std::vector<double> time, angle;
  double principal_share = 1.0;  ///< of the mean square rotation that is about the main axis; low: it wobbled
};
/// @throws InputError when the recording holds neither.
[[nodiscard]] SwingAngle swing_angle(const Recording& recording, const std::string& channel);

/// The part of a record in which the aircraft swings freely: from `settle_s` after the largest excursion from the
/// median to the last excursion of at least `fade` times the largest. What the hands did before the release is left
/// out. {first, one past last}; empty when nothing is left.
[[nodiscard]] std::pair<std::size_t, std::size_t> free_swing(const SwingAngle& swing, double settle_s, double fade);

/// One run.
struct SwingRun {
  std::string file;
  bool cradle_alone = false;
  SwingAngle swing;
  std::size_t begin = 0, end = 0;  ///< samples that were fitted
  estimation::DampedCosine fit;
};

/// Whether a swing test determines a moment of inertia.
enum class InertiaVerdict {
  kDetermined,
  kNotDetermined  ///< sigma above `max_relative_sigma` of the value, or the value is not positive
};

/// A moment of inertia from its swings.
struct AxisInertia {
  SwingAxis test;
  std::vector<SwingRun> runs;
  double frequency = 0.0, cradle_frequency = 0.0;              ///< mean undamped frequencies [rad/s]
  double sigma_frequency = 0.0, sigma_cradle_frequency = 0.0;  ///< of the means: scatter of the runs, or the fits'
  double value = 0.0;                                          ///< [kg m^2]
  estimation::ErrorDistribution error;                         ///< by Monte Carlo
  /// Linear standard deviations by source: masses, filar distance, lengths, frequencies.
  double by_mass = 0.0, by_filar_distance = 0.0, by_length = 0.0, by_frequency = 0.0;
  double largest_term = 0.0;                   ///< of the sum that gives the value [kg m^2]
  double per_half_percent_of_frequency = 0.0;  ///< what 0.5 % of `frequency` changes [kg m^2]
  InertiaVerdict verdict = InertiaVerdict::kNotDetermined;
  std::string reason;  ///< one sentence
  [[nodiscard]] double sigma() const { return error.sd; }
};

/// Moments of inertia of all axes that were swung.
struct SwingTestResult {
  std::vector<AxisInertia> axes;
  Eigen::MatrixXd covariance;  ///< of the values, axes in their order: masses are shared
  estimation::Estimate estimate;
  std::vector<std::string> warnings;
  [[nodiscard]] const AxisInertia* find(char axis) const;
};

/// Terms of the moment of inertia about one axis [kg m^2]: aircraft in its cradle less the cradle (each about the same
/// line), for a pendulum moved to the aircraft's centre of gravity by the parallel axis theorem.
template <typename Scalar>
struct SwingTerms {
  Scalar whole, cradle, transfer;
  [[nodiscard]] Scalar inertia() const { return whole - cradle - transfer; }
};

/// They follow from masses, lengths and undamped frequencies [rad/s].
[[nodiscard]] SwingTerms<double> swing_terms(const SwingTest& test, const SwingAxis& axis, double frequency,
                                             double cradle_frequency);

/// Reads and fits all runs, and judges. A run without a swing is left out with a warning.
/// @throws InputError for unreadable files, or an axis without a single usable run.
[[nodiscard]] SwingTestResult analyse_swing_test(const SwingTest& test, Progress& progress);

/// `inertia` and `sigma` of a subject, with comments on what is not determined or was not measured.
[[nodiscard]] std::string inertia_toml(const SwingTest& test, const SwingTestResult& result);

}  // namespace veridyn::aircraft
