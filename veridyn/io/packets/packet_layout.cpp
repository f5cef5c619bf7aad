#include "veridyn/io/packets/packet_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/core/units.hpp"

namespace veridyn::io {
namespace {

constexpr long long kLargestPacket = 65507;  // of UDP over IPv4 [bytes]

const KeyTable<PacketField>& field_keys() {
  using F = PacketField;
  using enum GatherType;
  static const auto table =
      KeyTable<F>("field", "A number of a packet.")
          .text(
              "name", &F::name,
              "`time`, which is needed; in frame flu `accel_x`, `gyro_x`, `velocity_x`, ..., `speed`; in a world with "
              "z "
              "up `pos_x`, `world_velocity_x`, `world_accel_x`, ..., the body's axes `forward_x`, ..., `right_x`, ... "
              "or `yaw`, `pitch`, `roll`; any other becomes a channel of that name")
          .required()
          .count("offset", &F::offset, 0, kLargestPacket, "where it begins [bytes]")
          .required()
          .choice("type", &F::type,
                  {{"f32", kFloat},
                   {"f64", kDouble},
                   {"i8", kInt8},
                   {"u8", kUint8},
                   {"i16", kInt16},
                   {"u16", kUint16},
                   {"i32", kInt32},
                   {"u32", kUint32},
                   {"i64", kInt64},
                   {"u64", kUint64}},
                  "how it is written, little-endian")
          .text("unit", &F::unit, "of the number in the packet")
          .number("factor", &F::factor, "1", kAnyNumber, "a sign or a scale before the unit");
  return table;
}

/// In SI.
PacketField read_field(const StudyTable& table) {
  PacketField field = field_keys().read(table);
  Unit unit;
  try {
    unit = parse_unit(field.unit);
  } catch (const InputError& error) {
    table.fail("unit", error.what());
  }
  field.unit = unit.si_name();
  field.factor *= unit.scale;
  field.bias = unit.offset;
  return field;
}

template <typename T>
void write_as(double value, char* at) {
  T number{};
  if constexpr (std::is_integral_v<T>) {
    // Not the largest number itself, which a double cannot hold of 64 bits.
    constexpr double kLowest = static_cast<double>(std::numeric_limits<T>::min()),
                     kHighest = static_cast<double>(std::numeric_limits<T>::max());
    if (std::isnan(value)) {
      number = 0;
    } else if (value >= kHighest) {
      number = std::numeric_limits<T>::max();
    } else {
      number = static_cast<T>(std::round(std::max(value, kLowest)));
    }
  } else {
    number = static_cast<T>(value);
  }
  std::memcpy(at, &number, sizeof number);
}

void write_number(double value, GatherType type, char* at) {
  switch (type) {
    case GatherType::kInt8:
      return write_as<std::int8_t>(value, at);
    case GatherType::kUint8:
      return write_as<std::uint8_t>(value, at);
    case GatherType::kInt16:
      return write_as<std::int16_t>(value, at);
    case GatherType::kUint16:
      return write_as<std::uint16_t>(value, at);
    case GatherType::kInt32:
      return write_as<std::int32_t>(value, at);
    case GatherType::kUint32:
      return write_as<std::uint32_t>(value, at);
    case GatherType::kInt64:
      return write_as<std::int64_t>(value, at);
    case GatherType::kUint64:
      return write_as<std::uint64_t>(value, at);
    case GatherType::kFloat:
      return write_as<float>(value, at);
    case GatherType::kDouble:
      return write_as<double>(value, at);
    case GatherType::kHalf:
    case GatherType::kText:
      break;
  }
}

/// What is wrong with a layout, and with which field; empty where nothing is.
struct LayoutFault {
  std::size_t field = 0;
  std::string what;
};

LayoutFault fault_of(const PacketLayout& layout) {
  std::vector<std::size_t> order(layout.fields.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return layout.fields[a].offset < layout.fields[b].offset; });
  std::size_t end = layout.begins_with.size();
  std::string before = fmt::format("the first {} bytes, which are always the same", end);
  for (const std::size_t i : order) {
    const PacketField& f = layout.fields[i];
    const std::size_t bytes = size_of(f.type);
    if (bytes == 0) return {i, fmt::format("'{}' is of a type that packets do not have", f.name)};
    if (f.offset < end) return {i, fmt::format("'{}' at {} overlaps {}", f.name, f.offset, before)};
    if (f.offset > layout.size || bytes > layout.size - f.offset)
      return {i, fmt::format("'{}' ends at {}, the packet at {}", f.name, f.offset + bytes, layout.size)};
    if (layout.find(f.name) != i) return {i, fmt::format("'{}' is there twice", f.name)};
    end = f.offset + bytes;
    before = fmt::format("'{}'", f.name);
  }
  return {};
}

}  // namespace

std::size_t PacketLayout::find(std::string_view field) const {
  return static_cast<std::size_t>(
      std::find_if(fields.begin(), fields.end(), [&](const PacketField& f) { return f.name == field; }) -
      fields.begin());
}

std::size_t size_of(GatherType type) {
  switch (type) {
    case GatherType::kInt8:
    case GatherType::kUint8:
      return 1;
    case GatherType::kInt16:
    case GatherType::kUint16:
      return 2;
    case GatherType::kInt32:
    case GatherType::kUint32:
    case GatherType::kFloat:
      return 4;
    case GatherType::kInt64:
    case GatherType::kUint64:
    case GatherType::kDouble:
      return 8;
    case GatherType::kHalf:
    case GatherType::kText:
      break;
  }
  return 0;
}

void check(const PacketLayout& layout) {
  if (const LayoutFault fault = fault_of(layout); !fault.what.empty())
    throw InputError("packet " + layout.name, fault.what);
}

void encode(const PacketLayout& layout, std::span<const double> values, std::span<char> packet) {
  VERIDYN_ASSERT(values.size() == layout.fields.size() && packet.size() == layout.size);
  std::fill(packet.begin(), packet.end(), '\0');
  std::copy(layout.begins_with.begin(), layout.begins_with.end(), packet.begin());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const PacketField& f = layout.fields[i];
    write_number((values[i] - f.bias) / f.factor, f.type, packet.data() + f.offset);
  }
}

const KeyTable<PacketLayout>& packet_layout_keys() {
  using L = PacketLayout;
  static const auto table =
      KeyTable<L>("packet", "Packets of a sender of one's own.")
          .count("size", &L::size, 1, kLargestPacket, "of a whole packet, exactly [bytes]")
          .required()
          .text("begins_with", &L::begins_with, "the same bytes at the start of every packet")
          .choice("gravity", &L::gravity_in, {{"in", true}, {"out", false}},
                  "whether accelerations hold gravity, as an accelerometer's do")
          .otherwise("not known; required of a live rig")
          .tables("field", field_keys(), [](const StudyTable& t, L& layout) { layout.fields.push_back(read_field(t)); })
          .check([](const StudyTable& t, L& layout) {
            if (layout.fields.empty()) t.fail("field", "is missing: a packet has fields");
            if (const LayoutFault fault = fault_of(layout); !fault.what.empty())
              t.tables("field")[fault.field].fail("offset", fault.what);
            if (!layout.has("time")) t.fail("field", "without 'time': packets in a file are ordered by it");
          });
  return table;
}

PacketLayout read_packet_layout(const StudyTable& table) {
  PacketLayout layout = packet_layout_keys().read(table);
  layout.name = layout.sender = table.path();
  layout.seen = true;  // by whoever wrote it
  return layout;
}

}  // namespace veridyn::io
