#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/io/log/gather.hpp"

namespace veridyn::io {

/// A number in a packet: at `offset`, little-endian; `factor * number + bias` is in `unit`.
///
/// The names say what it is. Of the body in frame flu: `accel_x|y|z`, `gyro_x|y|z`, `velocity_x|y|z`, `speed`; of a
/// world with z up, right-handed: `pos_x|y|z`, `world_velocity_x|y|z`, `world_accel_x|y|z`, the body's axes
/// `forward_x|y|z` and `right_x|y|z`, or `yaw`, `pitch`, `roll` from that world (nose down and left side up positive);
/// `time`. Senders with other axes have their numbers under the name of the axis that they mean, with the sign in
/// `factor`. Any other name becomes a channel of that name.
struct PacketField {
  std::string name;
  std::size_t offset = 0;  ///< [bytes]
  GatherType type = GatherType::kFloat;
  std::string unit = "1";
  double factor = 1.0;
  double bias = 0.0;
};

/// What a packet of one kind holds: a table, no code.
struct PacketLayout {
  std::string name;           ///< "outsim"
  std::string sender;         ///< "Live for Speed OutSim"
  std::size_t size = 0;       ///< of the whole packet, exactly [bytes]
  std::string begins_with{};  ///< the same bytes at the start of every packet; empty where there are none
  std::vector<PacketField> fields;
  /// Whether the signs were seen to be right on recorded packets, and not only read in the sender's description.
  bool seen = false;
  /// Whether accelerations hold gravity, as an accelerometer's do; nothing: not known. Those that are derived from
  /// velocity do not.
  std::optional<bool> gravity_in{};

  /// Where the field of that name lies in `fields`; its size where there is none.
  [[nodiscard]] std::size_t find(std::string_view field) const;
  [[nodiscard]] bool has(std::string_view field) const { return find(field) < fields.size(); }
};

/// Bytes that a number of this type takes.
[[nodiscard]] std::size_t size_of(GatherType type);

/// Fields named twice, that overlap, or that end beyond the packet's size; texts and half floats, which no packet has.
/// @throws InputError naming layout and fields
void check(const PacketLayout& layout);

/// The keys of a layout of one's own, `[data.packet]` with `[[data.packet.field]]`.
[[nodiscard]] const KeyTable<PacketLayout>& packet_layout_keys();

/// A layout by these keys, called by its table.
/// @throws InputError with file, line and key: as `check`, unknown types and units, no `time`
[[nodiscard]] PacketLayout read_packet_layout(const StudyTable& table);

/// The packet that decodes to these values, rounded to what its numbers can hold; what is not a field is zero.
/// @param values in the order of the layout's fields, in their units
/// @param packet of the layout's size
void encode(const PacketLayout& layout, std::span<const double> values, std::span<char> packet);

}  // namespace veridyn::io
