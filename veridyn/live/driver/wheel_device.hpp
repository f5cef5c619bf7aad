#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "veridyn/live/driver/wheel_event.hpp"

namespace veridyn::live {

/// Whether this build reads wheels (libevdev, CMake option VERIDYN_WHEEL).
[[nodiscard]] bool has_wheel_devices();

/// Axes without which a device is no wheel: ABS_X or ABS_WHEEL for the steering and one more for a pedal.
/// @param place what messages call the device  @param name what it calls itself
/// @throws InputError
void check_wheel(std::string_view place, std::string_view name, std::span<const WheelAxis> axes);

/// A steering wheel with pedals, an input device of Linux. Reading never waits.
class WheelDevice {
 public:
  /// @param path "/dev/input/event5", or a link of "/dev/input/by-id", which stays the same
  /// @throws InputError in one line naming the device: absent, no right to open it, not an input device, not a wheel;
  /// or this build does not read wheels
  explicit WheelDevice(const std::filesystem::path& path);
  ~WheelDevice();
  WheelDevice(WheelDevice&&) noexcept;
  WheelDevice& operator=(WheelDevice&&) noexcept;
  WheelDevice(const WheelDevice&) = delete;
  WheelDevice& operator=(const WheelDevice&) = delete;

  [[nodiscard]] const std::string& name() const;
  /// With their ranges, and where they were when the device was opened.
  [[nodiscard]] const std::vector<WheelAxis>& axes() const;
  /// Events since the last call, at most as many as `out` holds, stamped by the kernel on the clock of `RealClock`.
  /// Where the kernel dropped some, events that bring every axis up to date follow.
  std::size_t read(std::span<WheelEvent> out);
  /// The device is gone.
  [[nodiscard]] bool unplugged() const;
  /// File descriptor, to wait for it together with others.
  [[nodiscard]] int descriptor() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace veridyn::live
