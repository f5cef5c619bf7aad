#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "veridyn/core/enum_array.hpp"

namespace veridyn::estimation {

/// Average number of white samples u of N(mean, sd^2) until a two-sided CUSUM crosses `threshold`, from zero.
///
/// Each side is Page's S_k = max(0, S_{k-1} +- u_k - reference); its run length is that of a Markov chain of 2 x 75
/// states, extrapolated (Brook & Evans 1972). Sides combine as 1/L = 1/L_up + 1/L_down. Check: reference 0.5, threshold
/// 4 gives 168, threshold 5 gives 465 (Lucas & Crosier 1982).
[[nodiscard]] double cusum_run_length(double reference, double threshold, double mean = 0.0, double sd = 1.0);

/// The same of a one-sided CUSUM on u^2, u white N(0, sd^2): S_k = max(0, S_{k-1} + u_k^2 - reference).
[[nodiscard]] double spread_cusum_run_length(double reference, double threshold, double sd = 1.0);

/// How changes are searched in innovations.
struct ChangeDetectionOptions {
  double rate_Hz = 100.0;  ///< of the innovations
  /// Stated rate: mean time between false alarms on unchanged data [s]. Default one per 10 hours.
  double false_alarm_interval_s = 36000.0;
  /// Innovations are averaged over blocks of this length [s]; a block is one sample of the CUSUM. Long enough that a
  /// first-order model covers what correlation is left between blocks, short against the changes looked for.
  double block_s = 0.2;
  /// Change of the mean to be found fastest [standard deviations of a block]; its half is the CUSUM's reference value.
  double mean_shift = 1.0;
  /// Factor on the standard deviation to be found fastest, > 1; a change of a derivative shows as more variance, since
  /// regressors swing about zero. 0 watches the mean only.
  double spread_factor = 1.5;
  /// Blocks over which mean, variance and correlation of unchanged innovations are learned before watching starts [s].
  double learn_s = 60.0;
  /// They are followed with this memory afterwards [s].
  double memory_s = 300.0;

  /// Not watched for this long after an alarm [s]: the estimate follows the change meanwhile.
  double settle_s = 10.0;

  /// @throws InputError naming the option, its value and its rule.
  void validate() const;
};

/// What changed in the innovations.
enum class ChangeKind : std::size_t {
  kMean,      ///< the innovation has a mean: a bias, a jump of the constant term
  kSpread,    ///< the innovation has grown: other derivatives, more noise
  kParameter  ///< the innovation goes with a regressor: its parameter is another one; see ParameterWatch
};
/// Their names in results, in the order of the enum.
inline constexpr EnumArray<ChangeKind, std::string_view, 3> kChangeKindNames{"mean", "spread", "parameter"};

/// A detected change.
struct Change {
  ChangeKind kind = ChangeKind::kMean;
  double detected_s = 0.0;  ///< time of the alarm
  double began_s = 0.0;     ///< estimated time of the change: when the sum that raised it last left zero
  /// Mean of the whitened block innovations since then [sd] (kMean), their rms (kSpread), the relative change of
  /// the parameter (kParameter).
  double shift = 0.0;
};

/// Watches normalised innovations for a change, with a stated rate of false alarms.
///
/// Innovations of real flight are autocorrelated, so they are averaged over blocks, and block means b_i are whitened by
/// a running first-order model u_i = (b_i - mu - a (b_{i-1} - mu))/s whose mu, a and s are learned first and followed
/// slowly. Two-sided CUSUM (Page 1954) on u for the mean, and a one-sided one on
/// u^2 for the spread; thresholds give each half of the stated rate (normal u, average run lengths of Markov chains,
/// mean rate over the errors that mu and s have at the end of learning). After an alarm the sums start again when
/// `settle_s` are over, in which the estimate follows; the model of the noise is kept, for it is the aircraft that
/// changed. A second alarm soon after (within `learn_s`) is reported too, and then the noise is learned again: it may
/// be what changed.
class ChangeDetector {
 public:
  explicit ChangeDetector(const ChangeDetectionOptions& options);

  /// One innovation over its standard deviation, at `time_s`. Numbers that are not finite are left out. Does not
  /// allocate. @return the change when this sample raises the alarm
  std::optional<Change> update(double time_s, double normalised_innovation);

  /// Not watched for `settle_s`, as after an alarm.
  void pause();

  [[nodiscard]] bool watching() const;       ///< false while learning
  [[nodiscard]] double correlation() const;  ///< a, between neighbouring blocks
  /// Largest of the sums over their thresholds: 1 is an alarm.
  [[nodiscard]] double suspicion() const;
  [[nodiscard]] std::uint64_t alarms() const { return alarms_; }

 private:
  /// A sum that watches, and when it last left zero.
  struct Sum {
    double value = 0.0;
    double since_s = 0.0;
    double blocks = 0.0;
    void add(double increment, double time_s);
  };
  std::optional<Change> take_block(double mean);
  void learn(double mean);
  void start_again();
  void pause_after_alarm();

  ChangeDetectionOptions options_;
  double mean_reference_ = 0.0;
  double mean_threshold_ = 0.0;
  double spread_reference_ = 0.0;
  double spread_threshold_ = 0.0;
  std::uint64_t block_length_ = 1;
  double learn_blocks_ = 1.0;
  double memory_blocks_ = 1.0;
  std::uint64_t alarms_ = 0;

  // The block that is being filled.
  double block_sum_ = 0.0;
  std::uint64_t block_filled_ = 0;
  double block_began_s_ = 0.0;
  double last_s_ = 0.0;

  // Model of unchanged block means.
  double blocks_ = 0.0;
  double mean_ = 0.0;
  double variance_ = 0.0;
  double covariance_ = 0.0;
  double previous_ = 0.0;
  bool has_previous_ = false;

  Sum up_, down_, spread_;
  double pause_blocks_ = 0.0;  ///< still to be left out
  double since_alarm_ = 0.0;   ///< blocks watched since the last alarm's pause
};

}  // namespace veridyn::estimation
