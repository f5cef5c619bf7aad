#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "veridyn/core/enum_array.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"
#include "veridyn/live/link/datagram.hpp"
#include "veridyn/live/telemetry/sender_clock.hpp"
#include "veridyn/recording/motion_sample.hpp"

namespace veridyn::live {

/// What became of a packet.
enum class PacketStatus {
  kAccepted,
  kWrongSize,    ///< of no layout that is looked for, or another start
  kImplausible,  ///< NaN, beyond reason, or of a menu: no drive
  kRepeated,     ///< the stamp of the packet before
  kOutOfOrder,   ///< an older stamp
  kStale,        ///< it waited on its way for longer than allowed
  kTeleporting,  ///< its place does not follow from that of the packet before
  kOtherSender,  ///< while another one is listened to
  kUnrecognised  ///< while it is found out which packets they are
};
inline constexpr std::size_t kPacketStatuses = 9;
template <class T>
using PerPacketStatus = EnumArray<PacketStatus, T, kPacketStatuses>;
/// "accepted", "of a wrong size", ...
[[nodiscard]] std::string_view name_of(PacketStatus fate);

/// How packets are taken in.
struct IntakeOptions {
  double stale_after = 0.25;     ///< how much later than the quickest ones a packet may come [s]
  double silent_after = 1.0;     ///< without packets of the sender, another one is listened to [s]
  std::size_t begins_again = 5;  ///< packets that follow one another, but not those before: the drive began again
};

/// A motion of the vehicle, as one packet says it.
struct Telemetry {
  recording::MotionSample sample;  ///< at the packet's place, frame flu; its time is the sender's [s]
  Nanoseconds arrival = 0;
  bool restarted = false;  ///< it does not follow the one before: a drive that began, or began again
};

/// Takes packets in one by one, lets those through that a drive consists of, and counts the others by kind and sender.
/// Which of several layouts they are follows from their content, as sizes alone do not: ten packets that one layout can
/// explain and no other. Packets without a time are stamped with their arrival. Accelerations and rates that they do
/// not hold are derived from the last 60 ms and are half of that late.
///
/// Nothing is allocated or thrown after construction.
class PacketIntake {
 public:
  /// @param layouts one, or several to choose from by content
  /// @throws InputError for layouts from which no motion can be had: no acceleration, nor attitude and velocity; not
  /// said whether accelerations hold gravity
  explicit PacketIntake(const std::vector<io::PacketLayout>& layouts, const IntakeOptions& options = {});

  /// @return the motion of an accepted packet
  std::optional<Telemetry> take(const Datagram& packet);

  [[nodiscard]] PacketStatus last_status() const { return last_status_; }
  /// The layout that packets have; null before it is known.
  [[nodiscard]] const io::PacketLayout* layout() const {
    return chosen_ ? &candidates_[*chosen_].decoder.layout() : nullptr;
  }
  [[nodiscard]] const SenderClock& clock() const { return clock_; }
  /// How often drives began, the first one included.
  [[nodiscard]] std::uint64_t drives() const { return drives_; }
  [[nodiscard]] PerPacketStatus<std::uint64_t> counts() const;  ///< of all senders
  /// What came from one sender.
  struct FromSender {
    Sender sender;
    PerPacketStatus<std::uint64_t> counts = {};
  };
  /// The first ones; those beyond are not counted separately.
  static constexpr std::size_t kSenders = 8;
  [[nodiscard]] std::vector<FromSender> senders() const;
  /// What is derived and how late that is, in words; empty where nothing is or it is not known yet.
  [[nodiscard]] std::string_view derived() const;

 private:
  struct Candidate {
    explicit Candidate(io::PacketLayout layout) : decoder(std::move(layout)), values(decoder.layout().fields.size()) {}
    io::PacketDecoder decoder;
    std::vector<double> values;
    std::optional<io::PacketMotion> last;
    std::size_t seen = 0, good = 0;  ///< of its size; plausible, and following the one before
  };

  void count(const Sender& sender, PacketStatus fate);
  PacketStatus judge(const Datagram& packet, io::PacketMotion& motion);
  PacketStatus recognise(const Datagram& packet);
  PacketStatus follow(const io::PacketMotion& motion, Nanoseconds arrival);
  void begin(const io::PacketMotion& motion, Nanoseconds arrival);
  void keep(const io::PacketMotion& motion);
  [[nodiscard]] recording::MotionSample sample_of_last();

  IntakeOptions options_;
  std::vector<Candidate> candidates_;
  std::optional<std::size_t> chosen_;
  std::optional<Sender> sender_;
  Nanoseconds last_arrival_ = 0;
  SenderClock clock_;
  static constexpr std::size_t kHistory = 64;
  std::array<io::PacketMotion, kHistory> history_;  ///< the last of this drive, in order
  std::size_t kept_ = 0;
  std::optional<io::PacketMotion> stray_;  ///< the last one that did not follow
  std::size_t strays_ = 0;                 ///< in a row, each following the one before
  bool restarted_ = false, derives_acceleration_ = false, derives_rate_ = false;
  std::uint64_t drives_ = 0;
  std::array<FromSender, kSenders> senders_{};
  std::size_t known_senders_ = 0;
  PacketStatus last_status_ = PacketStatus::kWrongSize;
};

}  // namespace veridyn::live
