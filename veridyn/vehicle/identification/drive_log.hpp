#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/recording/channel_map.hpp"
#include "veridyn/numerics/resample.hpp"

namespace veridyn::vehicle {

/// All standard names of vehicle recordings with their SI units: `steer` (road wheels), `steering_wheel` (hand wheel),
/// `speed` (forward, of the centre of gravity), `yaw_rate` (or `gyro_z`), `accel_x|y|z` (specific force),
/// `lateral_velocity` (of the centre of gravity), `sideslip`, `roll`, `pitch`, `yaw`, `course`, `roll_rate`,
/// `wheel_speed_fl|fr|rl|rr`, `pos_x`, `pos_y`.
[[nodiscard]] std::span<const recording::StandardChannel> standard_drive_channels();

/// What identification of a vehicle looks at. Axes ISO 8855, SI.
enum class DriveSignal : std::size_t {
  kSteer,            ///< delta at the road wheels, left positive [rad]
  kSpeed,            ///< u, forward speed of the centre of gravity [m/s]
  kYawRate,          ///< r [rad/s]
  kAccelY,           ///< at the sensor's place, gravity's share taken off as far as it is known [m/s^2]
  kAccelX,           ///< [m/s^2]
  kLateralVelocity,  ///< v of the centre of gravity [m/s]
  kX,                ///< position on the ground [m]
  kY,
  kYaw  ///< heading [rad], unwrapped
};
inline constexpr std::size_t kDriveSignals = 9;
inline constexpr std::array<std::string_view, kDriveSignals> kDriveSignalNames{
    "steer", "speed", "yaw_rate", "accel_y", "accel_x", "lateral_velocity", "pos_x", "pos_y", "yaw"};
inline constexpr std::array<std::string_view, kDriveSignals> kDriveSignalUnits{"rad", "m/s", "rad/s", "m/s^2", "m/s^2",
                                                                               "m/s", "m",   "m",     "rad"};

/// How recorded channels become signals. Study table `[signals]`; every key is optional.
struct DriveSignalOptions {
  double rate_Hz = 0.0;  ///< `rate`: of the common grid; 0 takes that of the yaw rate, at most 100 Hz
  /// `pass_band`: of the equation-error regressions, which differentiate [Hz]; 0 takes 2 Hz, or a tenth of the rate
  /// where that is less. Output error works on the unfiltered signals.
  double pass_Hz = 0.0;
  double steering_ratio = 0.0;  ///< `steering_ratio`: hand wheel over road wheels; needed with `steering_wheel`
  double rolling_radius = 0.0;  ///< `rolling_radius` [m]: speed from the rear wheels where there is no `speed`
  /// `accel_position = [x, y, z]`: of the accelerometer from the centre of gravity, forward, left, up [m].
  std::array<double, 3> accel_position{};
  /// `velocity_position`: how far ahead of the centre of gravity `lateral_velocity` and `sideslip` are measured [m].
  double velocity_position = 0.0;
  /// `roll_gradient` [rad/(m/s^2)]: how far the body leans outward per lateral acceleration. A sensor fixed to the
  /// body then shows (1 + g roll_gradient) a_y; 5 deg per g (0.0089) make 8.7 % of it, which would all be read as
  /// softer or stiffer tyres. Taken off; 0: not known. Ignored where `roll` is recorded, of which g sin(roll) is taken
  /// off.
  double roll_gradient = 0.0;
  /// `[signals.noise]`: standard deviation of a channel's white noise per sample by standard name; what is not given is
  /// measured from the channel's content above 0.2 of its rate.
  std::vector<std::pair<std::string, double>> noise = {};
  double gravity = 9.80665;  ///< [m/s^2]

  /// @throws InputError naming file, line and key.
  [[nodiscard]] static DriveSignalOptions read(const StudyTable& table);
};

/// One signal on the common grid.
struct GridSignal {
  std::vector<double> value;  ///< NaN where missing; empty when the recording has none
  double sigma = 0.0;         ///< white noise of one sample of the sensor
  double rate_Hz = 0.0;       ///< of the sensor: slower than the grid, its noise is not white there
  std::string origin;         ///< "steering_wheel / 16", "rear wheels x 0.31 m"
  [[nodiscard]] bool available() const { return !value.empty(); }
};

/// All signals of a drive on one uniform grid, unfiltered, in ISO 8855.
struct DriveSignals {
  std::string source;
  numerics::UniformGrid grid;
  std::array<GridSignal, kDriveSignals> signals;
  std::array<double, 3> accel_position{};
  bool gravity_removed = false;  ///< from roll or roll gradient
  std::vector<std::string> notes;

  [[nodiscard]] const GridSignal& operator[](DriveSignal s) const { return signals[static_cast<std::size_t>(s)]; }
  [[nodiscard]] GridSignal& operator[](DriveSignal s) { return signals[static_cast<std::size_t>(s)]; }
  [[nodiscard]] std::size_t size() const { return grid.count; }
  /// First and one-past-last grid index inside a span.
  [[nodiscard]] std::pair<std::size_t, std::size_t> indices(const TimeSpan& span) const;
};

/// A drive as the study's `[data]` names it: channels with standard names, in frame flu.
struct DriveLog {
  recording::MappedRecording mapped;
  std::vector<TimeSpan> runs;          ///< each recording's own stretch of time; runs that follow are laid behind
  std::vector<TimeSpan> holdout_runs;  ///< of these, those that identification must not see
  std::vector<std::filesystem::path> inputs;
};

/// Gives the channels of a log their standard names and turns them into flu.
///
/// `frame` says in which frame the log is, "flu" or "frd" (then y, z, yaw, steering and course change their sign);
/// empty: what the log itself says, flu with a note where it says nothing.
/// @throws InputError for unknown names, sources that the log lacks, units of another kind, an unknown frame.
[[nodiscard]] recording::MappedRecording map_drive_channels(const Recording& log, const StudyTable& map,
                                                     std::string_view frame = {}, std::string_view frame_place = {});

/// Reads `[data]`: `frame`, `[data.map]`, and what recording::read_study_data reads; or several drives of the same vehicle,
///
///     runs = ["run1.csv", "run2.csv"]       # for identification (and hold-out, where nothing else is named for that)
///     holdout_runs = ["run3.csv"]           # never seen by identification
///
/// which are laid one after the other on the time axis with 10 s between them.
/// @throws InputError
[[nodiscard]] DriveLog read_drive_log(const StudyTable& data);

/// Resamples the mapped channels to one grid and derives what is missing: steering from the hand wheel, speed from the
/// rear wheels (or, without them, the front wheels), yaw rate from `gyro_z`, lateral velocity from `sideslip`.
/// @throws InputError when yaw rate, speed or steering is missing (the latter only with `needs_steer`), a signal holds
/// no numbers, the yaw rate is slower than 5 Hz, or accel_y goes against yaw_rate x speed (a sign or frame error).
[[nodiscard]] DriveSignals prepare_drive_signals(const recording::MappedRecording& mapped, const DriveSignalOptions& options,
                                                 bool needs_steer = true);

}  // namespace veridyn::vehicle
