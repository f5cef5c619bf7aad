#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "veridyn/cueing/chain/cueing_chain.hpp"
#include "veridyn/live/camera/pose_packet.hpp"
#include "veridyn/live/platform/platform_packet.hpp"
#include "veridyn/live/recording/live_record.hpp"
#include "veridyn/live/rig/car_link.hpp"
#include "veridyn/live/rig/live_study.hpp"
#include "veridyn/live/telemetry/spike_filter.hpp"

namespace veridyn::live {

/// A datagram of these bytes where telemetry comes in is an emergency stop, whoever sends it.
inline constexpr std::string_view kEmergencyPacket = "VSTOP1";

/// One step of a rig.
struct RigStep {
  Nanoseconds time = 0;
  RigState state = RigState::kParked;
  double share = 0.0;                ///< of the motion that the platform is given
  std::optional<EvenSample> motion;  ///< of the vehicle, at the driver's head
  cueing::CueingStep cueing;
  PlatformOrder to_platform;  ///< position and rate of each axis as the guard lets them through
  OrderBytes order = {};      ///< the same as the project's own packet, which is what is recorded
  std::uint32_t sequence = 0;
  CarLink::CommandBytes command = {};  ///< to the car
  std::size_t command_size = 0;        ///< 0: none with this step
};

/// Why a rig that is to run stays parked.
enum class Readiness {
  kReady,
  kNoTelemetry,  ///< none accepted, or not for a while
  kFrozen,       ///< packets say the same motion over and over
  kTooSlow,      ///< fewer packets than `slowest_packets`
  kNoAnswer,     ///< of the platform
  kRefused,      ///< the platform is commanded by another program, or at fault
  kSignsUnknown,
  kSignsWrong,
};
[[nodiscard]] std::string_view name_of(Readiness readiness);

/// The rig without clocks, sockets and threads: datagrams, the operator's requests and times in, orders to the platform
/// out. The same in gives the same out, bit for bit: a recorded run is replayed by feeding it again.
///
/// Platform and motion pass through `cueing::CueingChain` and its guard as in `veridyn cue`. Nothing is allocated or
/// thrown after construction.
class LiveRig {
 public:
  /// @param session of the orders @throws InputError as the intake and the chain
  LiveRig(const LiveStudy& study, std::uint32_t session);

  /// Something came in. @return of telemetry, the motion it holds where it was accepted
  std::optional<Telemetry> take(LinkOf link, const Datagram& datagram);
  /// Takes effect with the next step.
  void request(OperatorRequest request);
  /// An algorithm that was made elsewhere takes over, from where the platform is.
  /// @return the one before, for whoever frees it
  std::unique_ptr<cueing::Washout> take_over(std::unique_ptr<cueing::Washout> washout);
  /// One step. @param time later than that of the step before
  const RigStep& step(Nanoseconds time);

  [[nodiscard]] RigState state() const { return step_.state; }
  [[nodiscard]] Readiness readiness() const { return readiness_; }
  [[nodiscard]] const PacketIntake& intake() const { return intake_; }
  /// The car whose reports are the telemetry; null where they are packets.
  [[nodiscard]] CarLink* car() { return car_ ? &*car_ : nullptr; }
  [[nodiscard]] const CarLink* car() const { return car_ ? &*car_ : nullptr; }
  /// Of the telemetry, whichever it is: what became of it, and its clock against ours.
  [[nodiscard]] PerPacketStatus<std::uint64_t> packets() const { return car_ ? car_->counts() : intake_.counts(); }
  [[nodiscard]] const SenderClock& clock() const { return car_ ? car_->clock() : intake_.clock(); }
  /// Answers of the platform: how many, those that could not be read, the last one's verdict, orders that it counted
  /// outside its limits, and the round trip of the last.
  struct Answers {
    std::uint64_t count = 0, unreadable = 0;
    PlatformVerdict verdict = PlatformVerdict::kFollows;
    std::uint32_t outside_limits = 0;
    Nanoseconds round_trip = 0;
    cueing::PerPlatformAxis<float> reached = {};
    Sender commander;  ///< who commands it, where another program does and it says so; port 0: not known
  };
  [[nodiscard]] const Answers& answers() const { return answers_; }
  /// Poses of the camera above the track.
  struct Camera {
    std::uint64_t poses = 0, unreadable = 0;
    CameraPose last;
    SenderClock clock;  ///< of the camera against ours
  };
  [[nodiscard]] const Camera& camera() const { return camera_; }
  /// Steps, of those in which the platform followed the motion, for which it was continued beyond the last packet, and
  /// how far at most.
  struct Extrapolated {
    std::uint64_t steps = 0, of = 0;
    double longest = 0.0;  ///< [s]
  };
  [[nodiscard]] const Extrapolated& extrapolated() const { return extrapolated_; }
  /// Steps that came so late that the platform had to stop.
  [[nodiscard]] std::uint64_t gaps() const { return gaps_; }
  /// How often each state began.
  [[nodiscard]] const PerRigState<std::uint64_t>& entered() const { return entered_; }

 private:
  [[nodiscard]] Readiness ready_at(Nanoseconds time) const;
  void handle(RigEvent event, Nanoseconds time);
  void drive(double dt);
  [[nodiscard]] bool at_rest_in_neutral() const;
  void watch_frozen(const Telemetry& telemetry);
  void count_extrapolated();
  void accept(Telemetry& telemetry);
  void take_pose(const Datagram& datagram);
  [[nodiscard]] bool platform_follows(Nanoseconds time) const;
  void command_car(Nanoseconds time);

  RigOptions options_;
  PacketIntake intake_;
  std::optional<CarLink> car_;
  EvenMotion even_;
  SpikeFilter spikes_;
  cueing::CueingChain chain_;
  std::uint32_t session_;
  std::optional<recording::MotionSample> last_sample_;  ///< at the driver's head
  std::optional<Nanoseconds> last_packet_, last_answer_, last_verdict_bad_, last_command_;
  Nanoseconds same_since_ = 0, last_time_ = 0, state_since_ = 0;
  double rate_ = 0.0;  ///< of packets, low-passed [Hz]
  std::optional<recording::MotionSample> last_telemetry_;
  bool begun_ = false, restarted_ = false;
  bool wants_motion_ = false, wants_park_ = false, emergency_ = false, release_ = false;
  std::optional<bool> signs_right_;
  double phase_ = 0.0;  ///< of soft start and fade, 0 parked to 1
  Readiness readiness_ = Readiness::kNoTelemetry;
  RigStep step_;
  Answers answers_;
  Camera camera_;
  std::uint64_t gaps_ = 0;
  Extrapolated extrapolated_;
  PerRigState<std::uint64_t> entered_ = {};
};

/// Readiness in words; where the platform says which program commands it, with its address.
[[nodiscard]] std::string described(Readiness readiness, const LiveRig::Answers& answers);

}  // namespace veridyn::live
