#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/study_keys.hpp"
#include "veridyn/cueing/cueing_study.hpp"
#include "veridyn/live/link/datagram.hpp"
#include "veridyn/live/platform/order_format.hpp"
#include "veridyn/live/rig/car_study.hpp"
#include "veridyn/live/serial/serial_line.hpp"
#include "veridyn/live/telemetry/even_motion.hpp"
#include "veridyn/live/telemetry/packet_intake.hpp"
#include "veridyn/live/virtual/circuit_drive.hpp"
#include "veridyn/live/virtual/virtual_vehicle.hpp"

namespace veridyn::live {

/// When the signs of the telemetry are checked.
enum class SignCheck {
  kBefore,  ///< the platform stays parked until they are seen to be right
  kWhile,   ///< it starts at once and parks where they are seen to be wrong
  kOff,
};

/// How a rig runs.
struct RigOptions {
  double rate = 100.0;             ///< of orders to the platform [Hz]
  double soft_start = 3.0;         ///< until the platform follows the whole motion [s]
  double hold = 0.5;               ///< how long the last command stands without telemetry [s]
  double fade = 3.0;               ///< on the way to park [s]
  double lost_after = 0.25;        ///< without an accepted packet [s]
  double frozen_after = 1.0;       ///< with packets that say the same motion of a vehicle that moves [s]
  bool answers = true;             ///< whether the platform answers orders
  double unanswered_after = 0.25;  ///< the platform counts as lost [s]
  double slowest_packets = 20.0;   ///< fewer are no motion to follow [Hz]
  double spikes = 500.0;           ///< most change of a specific force, above that it is a crash or a landing [m/s^3]
  SignCheck signs = SignCheck::kBefore;
  IntakeOptions intake;
  EvenMotionOptions even;
  Eigen::Vector3d sensor =
      Eigen::Vector3d::Zero();  ///< where the motion is measured, from the centre of gravity, flu [m]
  Eigen::Vector3d driver = Eigen::Vector3d::Zero();  ///< the driver's head [m]
};

/// A camera above the track, from `[live.camera]`; `[live.camera.fusion]` is read by `camera::FusionOptions`.
struct CameraStudy {
  Sender address;

  [[nodiscard]] static const KeyTable<CameraStudy>& keys();
};

/// A study of `veridyn cue --live`: platform, algorithm and rider as `veridyn cue` has them, and in `[live]` where
/// motion comes from and goes to.
struct LiveStudy {
  cueing::CueingStudy cueing;  ///< without a drive; one algorithm
  std::vector<io::PacketLayout> layouts;
  Sender telemetry;                   ///< where we listen; with a car, for emergency stops only; port 0: nowhere
  std::optional<CarStudy> car;        ///< its reports are the telemetry
  std::optional<DriverStudy> driver;  ///< of the car
  std::optional<CameraStudy> camera;  ///< above its track
  Sender platform;                    ///< where orders go
  SerialOptions platform_line;        ///< or the serial line on which they go; its device is empty where there is none
  OrderFormatOptions format;
  std::shared_ptr<const vehicle::Circuit> circuit;  ///< of the virtual vehicle or car; null: none
  CircuitDriveOptions circuit_drive;                ///< around it
  std::optional<Sender> page;                       ///< where the run's page is shown
  std::filesystem::path page_token;                 ///< file of its token; empty: one is drawn and printed
  double page_rate = 20.0;                          ///< of its statuses [Hz]
  RigOptions options;

  /// `[live]`; what depends on its other keys and on `[platform]` is read by `read_live_study`.
  [[nodiscard]] static const KeyTable<LiveStudy>& keys();
};

/// The keys of the tables of a live study besides those of cueing, in the order in which one writes them.
[[nodiscard]] std::vector<StudyKeys> study_keys();

/// Where orders go, for people: an address or a device.
[[nodiscard]] std::string platform_name(const LiveStudy& study);

/// All keys but those of a drive are read; [data], [drive], [subject], [road] are known and left alone.
/// @throws InputError for anything that is wrong in it.
[[nodiscard]] LiveStudy read_live_study(const Study& study);

/// The same study without names of files that a replay needs: calibration of a wheel and platform by their numbers.
[[nodiscard]] Study self_contained(const Study& study, const LiveStudy& live);

/// `[live.vehicle]`: how the virtual vehicle sends.
[[nodiscard]] const KeyTable<VirtualVehicleOptions>& virtual_vehicle_keys();

/// "127.0.0.1:4123". @throws InputError at `place`
[[nodiscard]] Sender parse_address(std::string_view text, const std::string& place);

}  // namespace veridyn::live
