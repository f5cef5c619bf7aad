#pragma once

#include <string>
#include <string_view>

#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// Whether the bytes start as a telemetry log of MAVLink: a stamp of this century, a packet, and again.
[[nodiscard]] bool is_tlog(std::string_view bytes);

/// Reads a telemetry log (.tlog) as ground stations write it: before each MAVLink packet, of version 1 or 2, the moment
/// at which it was received, in microseconds since 1970 as 64 bits, most significant byte first. The messages are those
/// of `find_mavlink_message`, in SI or with their unit; others are skipped by their length and counted.
///
/// - Packets with a wrong checksum are left out and counted. After damage the reader goes on at the next packet whose
///   checksum is right.
/// - Systems are distinguished: topics of the one that sent most of the motion have the message's name; those of others
///   are `system2.ATTITUDE`, those of its other components (a gimbal) `component154.ATTITUDE`. Sensors and ports that a
///   message numbers are instances.
/// - Where messages hold their own time (since the sender started, or since 1970) that is taken: radio links deliver in
///   bursts. It is moved by the least delay that was seen, so that 0 is when the first packet was received. A message
///   without a time has that of the sender's message before it, plus what has passed since then.
/// - Where a sender restarts (its clock goes back by more than 10 s) its times go on after what came before.
/// - Parameters are those of PARAM_VALUE; events come from HEARTBEAT (armed) and STATUSTEXT, `vehicle` of the
///   information ("fixed wing", "ground rover") too.
/// @throws InputError when it is none.
[[nodiscard]] Log read_tlog(std::string_view bytes, std::string source);

}  // namespace veridyn::io
