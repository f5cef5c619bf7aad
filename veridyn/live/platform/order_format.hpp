#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/cueing/platform/platform.hpp"
#include "veridyn/io/packets/packet_layout.hpp"
#include "veridyn/live/platform/platform_packet.hpp"

namespace veridyn::live {

/// How orders to a platform are written.
enum class OrderFormatKind {
  kVeridyn,     ///< the project's own packet, the only one with answers
  kMotion68,    ///< the 68 bytes of `io::known_packet("motion_68")`
  kAmcAasd15a,  ///< 20 bytes for the AMC-AASD15A controller of six actuators: their strokes
  kFlypt,       ///< a line of text
};
/// How many there are.
inline constexpr std::size_t kOrderFormats = 4;
/// "veridyn", "motion_68", "amc_aasd15a", "flypt".
[[nodiscard]] std::string_view name_of(OrderFormatKind kind);

struct OrderFormatOptions {
  OrderFormatKind kind = OrderFormatKind::kVeridyn;
  /// Of kFlypt: `{AXIS}`, `{AXIS:UNIT}` or `{AXIS:UNIT:.3f}` is the position of an axis (surge, sway, heave in m, cm or
  /// mm; roll, pitch, yaw in rad or deg) with that many decimals, 0 to 9; `{{` and `}}` are braces; all else is sent as
  /// it is.
  std::string text = "P={pitch:deg:.3f},R={roll:deg:.3f},H={heave:mm:.2f}\n";
};

/// Writes orders in one of these formats. Nothing is allocated or thrown after construction.
///
/// - motion_68: time, attitude and place are those of the platform: yaw, pitch and roll the commanded angles, place
///   its shift; everything else is zero. The packet was made for a vehicle's motion; that a platform's program takes
///   it for positions is an assumption that was not tested on one.
/// - amc_aasd15a: ff ff, six u16 (high byte first; 0: the leg at its shortest, 65535: at its longest), four zeros,
///   0a 0d. Legs beyond those that the platform has stand in their middle. As programs that are public send it; it was
///   not seen on the hardware.
class OrderFormat {
 public:
  /// @throws InputError for a text that cannot be read, and a platform without legs where these are sent
  OrderFormat(const OrderFormatOptions& options, const cueing::Platform& platform);

  /// Whether it is the project's own.
  [[nodiscard]] bool own() const { return kind_ == OrderFormatKind::kVeridyn; }
  /// The bytes of an order; valid until the next call.
  [[nodiscard]] std::string_view encode(const PlatformOrder& order);
  /// The most bytes that an order takes.
  [[nodiscard]] std::size_t longest() const { return longest_; }

 private:
  /// A piece of text, and the axis that stands behind it.
  struct Part {
    std::string before;
    std::optional<cueing::PlatformAxis> axis;
    double factor = 1.0;  ///< from SI to the unit
    int decimals = 3;
  };
  void read_text(std::string_view text);
  static Part read_field(std::string_view field);
  std::string_view motion_68(const PlatformOrder& order);
  std::string_view strokes(const PlatformOrder& order);
  std::string_view text(const PlatformOrder& order);

  OrderFormatKind kind_;
  std::optional<cueing::Legs> legs_;
  std::vector<Part> parts_;
  io::PacketLayout layout_;  ///< motion_68
  std::vector<double> values_;
  std::array<char, 512> bytes_{};
  std::size_t longest_ = kOrderBytes;
};

}  // namespace veridyn::live
