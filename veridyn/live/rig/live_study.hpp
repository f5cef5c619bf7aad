#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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

/// A camera above the track, from `[live.camera]`:
///
///     address = "127.0.0.1:6123"   # of `veridyn camera track --serve`
///     [live.camera.fusion]         # with the car's inertial sensors, see camera::FusionOptions::read
struct CameraStudy {
  Sender address;
};

/// A study of `veridyn cue --live`: platform, algorithm and rider as `veridyn cue` has them, and where motion comes
/// from and goes to.
///
///     [live]
///     telemetry = "127.0.0.1:4123"  # listens here for packets; 0.0.0.0: at all of the machine's addresses
///                                   # or "car": reports of the car of [live.car], driven by [live.driver]
///     stop = "127.0.0.1:4123"       # with a car: where datagrams VSTOP1 are listened to; nowhere when left out
///     packet = "outsim"             # see io::known_packets; "any" (when left out) recognises them by content
///     [live.packet]                 # or a layout of one's own, see io::read_packet_layout
///     platform = "127.0.0.1:5123"   # orders go there
///     format = "veridyn"            # how orders are written, see OrderFormatKind; text = "P={pitch:deg:.3f}" of flypt
///     baud = 250000                 # where platform is a serial line: "/dev/ttyUSB0"
///     answers = true                # whether the platform answers them; formats of others have no answers
///     rate = "100 Hz"               # of orders, 20 Hz to 4 kHz
///     delay = "20 ms"               # of the motion, for packets that come late
///     extrapolate = "30 ms"         # how far it goes on where they come later still
///     spikes = "500 m/s^3"          # most change of a specific force, against crashes and landings
///     soft_start = 3                # [s], as hold = 0.5, fade = 3
///     lost_after = 0.25             # [s], as frozen_after = 1, stale_after = 0.25, unanswered_after = 0.25
///     page = "127.0.0.1:8090"       # the run's page in a browser; none when left out
///     page_token = "token.txt"      # file of what a control needs; needed beyond loopback, else one is drawn
///     page_rate = "20 Hz"           # how often it moves, 1 to 60 Hz
///     [live.circuit]                # of the virtual rig, see vehicle::read_circuit and CircuitDriveOptions
///     signs = "before"              # or "while" or "off": when the telemetry's signs are checked
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
};

/// Where orders go, for people: an address or a device.
[[nodiscard]] std::string platform_name(const LiveStudy& study);

/// All keys but those of a drive are read; [data], [drive], [subject], [road] are known and left alone.
/// @throws InputError for anything that is wrong in it.
[[nodiscard]] LiveStudy read_live_study(const Study& study);

/// The same study without names of files that a replay needs: calibration of a wheel and platform by their numbers.
[[nodiscard]] Study self_contained(const Study& study, const LiveStudy& live);

/// How the virtual vehicle sends, from `[live.vehicle]`:
///     rate = "100 Hz", jitter = "20 ms", loss = 0.01, clock_drift = 50e-6, seed = 1
/// @throws InputError with file, line and key
[[nodiscard]] VirtualVehicleOptions read_virtual_vehicle(const StudyTable& live);

/// "127.0.0.1:4123". @throws InputError at `place`
[[nodiscard]] Sender parse_address(std::string_view text, const std::string& place);

}  // namespace veridyn::live
