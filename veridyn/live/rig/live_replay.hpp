#pragma once

#include <array>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/live/recording/drive_table.hpp"
#include "veridyn/live/recording/live_file.hpp"
#include "veridyn/live/rig/live_loop.hpp"
#include "veridyn/live/rig/pedal_trace.hpp"

namespace veridyn::live {

/// What a replay says of a car that was driven over a line.
struct CarReplay {
  LinkQuality quality;
  std::uint64_t restarts = 0;
  std::uint64_t commands = 0, commands_different = 0;  ///< sent, and of these those that differ in any bit
  DriveTable drive;                                    ///< what its sensors said
  PedalTrace::Result pedal_to_platform;
  /// What its inertial sensors felt and where a camera saw it, by our clock, in the order in which both came in.
  struct Inertial {
    double time = 0.0;  ///< [s]
    Eigen::Vector3d rate, force;
  };
  struct Seen {
    double stamp = 0.0;  ///< [s]
    Eigen::Vector3d pose;
    Eigen::Matrix3d covariance;
    std::size_t after = 0;  ///< how many of `inertial` had come
  };
  std::vector<Inertial> inertial;
  std::vector<Seen> seen;
  LiveRig::Camera camera;
};

/// What a recorded run was, fed to a rig again.
struct LiveReplay {
  LiveStudy study;
  cueing::CueingRun run;         ///< steps at 100 Hz at most, while the platform moved; times from the run's start
  std::vector<RigState> states;  ///< of these steps
  std::vector<double> shares;    ///< of the motion
  struct Change {
    double time = 0.0;  ///< from the run's start [s]
    RigState to = RigState::kParked;
    Readiness readiness = Readiness::kReady;
  };
  std::vector<Change> changes;
  struct Turn {
    double time = 0.0;
    std::vector<double> values;  ///< of all knobs
  };
  std::vector<Turn> turns;
  LoopTimes times;  ///< `wait` and `work` are not recorded: empty, or those that the run itself measured
  PerPacketStatus<std::uint64_t> packets = {};
  std::vector<PacketIntake::FromSender> senders;
  std::uint64_t drives = 0, gaps = 0;
  LiveRig::Extrapolated extrapolated;
  std::string layout;  ///< the sender that packets were of
  std::string derived;
  double drift = 0.0;  ///< NaN: not known
  LiveRig::Answers answers;
  double duration = 0.0;                   ///< [s]
  std::optional<CarReplay> car;            ///< driven over a line
  std::uint64_t different = 0;             ///< orders that differ from the recorded ones in any bit
  std::uint64_t missing = 0;               ///< steps that were not recorded
  std::uint64_t outside = 0;               ///< orders beyond the platform's limits
  std::size_t damaged = 0, cut_bytes = 0;  ///< of the file
  std::string orders_fingerprint;          ///< CRC-32 of all orders, in hexadecimal
};

/// Feeds a recording to a rig of its study.
/// @param name of the file, for messages
/// @throws InputError for a study in it that cannot be read, and a recording without steps.
[[nodiscard]] LiveReplay replay(const LiveFile& file, const std::string& name, Progress& progress);

}  // namespace veridyn::live
