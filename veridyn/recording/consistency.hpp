#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/recording/channel_map.hpp"
#include "veridyn/recording/drive_motion.hpp"

namespace veridyn::recording {

/// What one channel reads over what others imply; 1 where all are right.
struct ChannelRelation {
  estimation::Check check = {};  ///< "yaw rate against heading"
  InertialChannel channel{};     ///< the one that is compared
  std::string against = {};      ///< "the rate of the heading"
  double low = 0.0, high = 0.0;  ///< range of the ratio, three standard errors included
  double correlation = 1.0;
  double lag_s = 0.0;                         ///< by which the channel comes after what it is compared with
  double seconds = 0.0;                       ///< that were compared
  double truth_rms = 0.0, reading_rms = 0.0;  ///< of the motion that was compared
  double least = 0.0;                         ///< rms from which there is enough of it to say anything
  bool shown = false;     ///< a channel that may be exchanged with this one shows the motion that it is compared with
  bool verified = false;  ///< the range is narrow enough to verify a scale
  PerInertialChannel<int> power = {};  ///< to which power an error of each channel's scale is in the ratio
  estimation::Tolerance tolerance = {};
  /// A right channel may also read nothing of it: a vertical acceleration that is given without gravity.
  bool may_be_none = false;

  [[nodiscard]] double middle() const { return 0.5 * (low + high); }
  /// Whether there was enough of the motion to say anything: more than roads and noise make, or less that both or
  /// another channel show as one motion. A reading that is many times larger moves even where what it is compared with
  /// does not.
  /// @param reading_factor, truth_factor  by which the two are too large
  [[nodiscard]] bool moved(double reading_factor = 1.0, double truth_factor = 1.0) const;
  /// Of a ratio somewhere from `from` to `to`.
  [[nodiscard]] estimation::Outcome outcome_for(double from, double to) const;
  /// Whether nine tenths of both are common: by chance only of a handful of rows.
  [[nodiscard]] bool is_one_motion() const { return correlation * correlation > 0.9; }
  /// Square of the correlation below which two signals that move are not one motion.
  [[nodiscard]] bool unrelated() const { return moved() && correlation * correlation < 0.25; }
  /// By range and correlation; passed where nothing moved.
  [[nodiscard]] estimation::Outcome outcome() const;
  /// Moved, nothing to object to, and known well enough that a wrong sign, axis or unit would have been seen.
  [[nodiscard]] bool fits() const {
    const bool known = may_be_none || (low > tolerance.lowest && high < tolerance.highest);
    return moved() && outcome() == estimation::Outcome::kPassed && known;
  }
};

/// One thing that is wrong with channels.
struct ChannelFault {
  estimation::Cause cause = estimation::Cause::kNone;
  std::vector<InertialChannel> channels = {};
  double factor = 1.0;                     ///< reading over truth; NaN: the channel shows another motion
  std::string truly = {};                  ///< of a unit: in which the channel is recorded ("km/h"); "hand wheel"
  std::string taken = {};                  ///< for which it was taken ("m/s")
  bool hand_wheel = false;                 ///< the angle of the hand wheel taken for that of the road wheels
  std::vector<InertialChannel> from = {};  ///< of exchanged axes: where each of `channels` is recorded
  double least = 1.0, most = 1.0;          ///< of a hand wheel: its angle over that of the road wheels

  /// "speed is in km/h, not m/s".
  [[nodiscard]] std::string says(const ChannelNames& names) const;
};

/// What relations say together.
struct Consistency {
  std::vector<ChannelRelation> relations;
  /// The fewest faults that explain all relations that are off; several sets where these explain them as well. Empty
  /// where nothing is off, and where no set of at most three faults explains it.
  std::vector<std::vector<ChannelFault>> explanations = {};

  [[nodiscard]] bool is_off() const;
  /// Of one of several explanations: those that all have.
  [[nodiscard]] bool is_sure() const { return explanations.size() == 1; }
};

/// What is known besides the channels.
struct ConsistencyOptions {
  double wheelbase = 0.0;  ///< [m]; 0: unknown
  double band_Hz = 0.5;    ///< signals are compared below this frequency, where a body follows its wheels
  /// Where the vehicle drives; empty: all of it.
  std::vector<TimeSpan> spans = {};
};

/// Relations between the channels of a drive, and what is wrong with these:
///
/// - yaw rate (and roll and pitch rate) against the derivative of the angle, or of the positions' course;
/// - speed against that of the positions;
/// - lateral acceleration against r u, with v' as a function of r', u^2 r' and r'' (the sideslip of a bicycle in slow
///   manoeuvres) and a bias; longitudinal acceleration against u', with r^2 (for r v) and a bias;
/// - steering against L r/u, with understeer, r' and a bias; without a wheelbase the ratio is the wheelbase that the
///   steering would need;
/// - the median vertical acceleration against gravity, which is in or not.
///
/// Both sides of each may be noisy: gains are bracketed by regressions both ways (recording::signal_gain, Frisch), at
/// the lag at which the two correlate best. What hardly moves says nothing. Faults are units of the channel's dimension
/// (core/units), signs, the frame frd, exchanged axes of the accelerometer, the hand wheel's angle, gravity twice, a
/// leaning body, a scale that is no unit's, and another motion altogether; the fewest of them that bring every relation
/// within its tolerance are named.
[[nodiscard]] Consistency check_consistency(const DriveMotion& motion, const ConsistencyOptions& options = {});

/// The lines of `[data.map]`, or of `[data]` for a frame, that correct a fault.
/// @param origins of the channels, where the recording's own names are others
[[nodiscard]] std::vector<std::string> correction_of(const ChannelFault& fault, const ChannelNames& names,
                                                     std::span<const ChannelOrigin> origins = {});

/// "g taken for m/s^2": the unit in which a channel is recorded if it reads `factor` times the truth in the belief that
/// it is recorded in `taken`; empty where no unit of that dimension is within `doubt` (a share of the factor, from 3 to
/// 15 %).
[[nodiscard]] std::string mistaken_unit(const Unit& taken, double factor, double doubt = 0.0);

}  // namespace veridyn::recording
