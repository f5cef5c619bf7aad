#pragma once

#include <string>
#include <string_view>

#include "veridyn/io/log/log.hpp"
#include "veridyn/io/packets/packet_layout.hpp"

namespace veridyn::io {

/// Which packets bytes are, one after the other as a socket gave them: that of `known_packets` with a time of which
/// most are plausible and follow one another as a drive does; null where none is.
[[nodiscard]] const PacketLayout* packets_in(std::string_view bytes);

/// Packets one after the other as a drive in frame flu: `accel_x|y|z`, `gyro_x|y|z`, `roll`, `pitch`, `yaw`, `speed`,
/// and the layout's other fields under their names. Accelerations and rates that a packet does not hold are derived
/// from velocity and attitude over 0.1 s, since stamps jitter by as much as they are apart. Packets that are not
/// plausible, repeat a stamp or go back are left out and counted; where time starts again, the longest run is kept.
/// @throws InputError with fewer than ten packets of a drive, and of packets without a time.
[[nodiscard]] Log packet_log(const PacketLayout& layout, std::string_view bytes, const std::string& source);

}  // namespace veridyn::io
