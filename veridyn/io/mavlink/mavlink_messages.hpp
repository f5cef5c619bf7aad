#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "veridyn/io/log/gather.hpp"

namespace veridyn::io {

/// A field of a MAVLink message, where it lies in a payload that has all of its bytes.
struct MavlinkField {
  std::string_view name;
  GatherType type = GatherType::kUint8;
  std::string_view unit = "1";    ///< as `parse_unit` reads it
  double scale = 1.0;             ///< scale times the number is in `unit`
  std::uint32_t count = 1;        ///< elements of an array; of a text its bytes
  bool extension = false;         ///< of MAVLink 2 alone; no part of the check
  bool none_is_all_ones = false;  ///< an unsigned number with all bits set says that there is none
  std::uint32_t offset = 0;       ///< bytes

  [[nodiscard]] std::uint32_t element_size() const;
};

/// A message as the XML of MAVLink declares it.
struct MavlinkMessage {
  std::uint32_t id = 0;
  std::string_view name;
  std::vector<MavlinkField> fields;  ///< in the order of the declaration
  std::string_view instance = {};    ///< field that numbers the sensor or port; empty: there is one
  std::uint32_t size = 0;            ///< of a whole payload
  std::uint32_t least_size = 0;      ///< of a MAVLink 1 payload: without extensions
  /// CRC_EXTRA: what the checksum of a packet starts from besides its bytes, so that a message of another layout fails
  /// it. Computed of the layout as the generator of MAVLink does it: of the name and of type and name of each field in
  /// the order of the payload. A layout that is not the sender's cannot pass.
  std::uint8_t crc_extra = 0;

  /// Null where there is none.
  [[nodiscard]] const MavlinkField* find(std::string_view field) const;
};

/// The messages that are read, of common.xml and ardupilotmega.xml: motion, air data, servos, and what tells of the
/// vehicle (HEARTBEAT, PARAM_VALUE, STATUSTEXT). Null for others.
[[nodiscard]] const MavlinkMessage* find_mavlink_message(std::uint32_t id);

/// CRC-16/MCRF4XX (X.25 of MAVLink) of bytes, on from `crc`.
[[nodiscard]] std::uint16_t mavlink_crc(std::string_view bytes, std::uint16_t crc = 0xffff);

}  // namespace veridyn::io
