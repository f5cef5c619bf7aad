#include "veridyn/live/driver/wheel_device.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/error.hpp"

#ifdef VERIDYN_WHEEL
#include <fcntl.h>
#include <libevdev/libevdev.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>

#include "veridyn/live/serial/serial_line.hpp"
#endif

namespace veridyn::live {

void check_wheel(std::string_view place, std::string_view name, std::span<const WheelAxis> axes) {
  const bool steers = std::any_of(axes.begin(), axes.end(),
                                  [](const WheelAxis& axis) { return axis.code == kAxisX || axis.code == kAxisWheel; });
  if (!steers) throw InputError(place, fmt::format("'{}' is not a wheel: it has neither ABS_X nor ABS_WHEEL", name));
  if (axes.size() < 2)
    throw InputError(place, fmt::format("'{}' is not a wheel with pedals: it has one axis only", name));
  for (const WheelAxis& axis : axes) {
    if (axis.lowest >= axis.highest)
      throw InputError(place, fmt::format("'{}': axis {} has no range: {} to {}", name, axis_name(axis.code),
                                          axis.lowest, axis.highest));
  }
}

#ifdef VERIDYN_WHEEL

bool has_wheel_devices() { return true; }

struct WheelDevice::Implementation {
  int descriptor = -1;
  libevdev* device = nullptr;
  std::string name;
  std::vector<WheelAxis> axes;
  bool catching_up = false;
  bool unplugged = false;

  Implementation() = default;
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;
  ~Implementation() {
    libevdev_free(device);
    if (descriptor >= 0) ::close(descriptor);
  }
};

WheelDevice::WheelDevice(const std::filesystem::path& path) : implementation_(std::make_unique<Implementation>()) {
  const std::string place = path.string();
  Implementation& self = *implementation_;
  self.descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (self.descriptor < 0) throw InputError(place, internal::open_refusal(errno, "input"));
  if (libevdev_new_from_fd(self.descriptor, &self.device) != 0) {
    self.device = nullptr;
    throw InputError(place, "not an input device");
  }
  libevdev_set_clock_id(self.device, CLOCK_MONOTONIC);
  self.name = libevdev_get_name(self.device);
  for (std::uint16_t code = 0; code < kAxisCodes; ++code) {
    const input_absinfo* axis = libevdev_get_abs_info(self.device, code);
    if (axis == nullptr) continue;
    self.axes.push_back({.code = code, .lowest = axis->minimum, .highest = axis->maximum, .value = axis->value});
  }
  check_wheel(place, self.name, self.axes);
}

std::size_t WheelDevice::read(std::span<WheelEvent> out) {
  Implementation& self = *implementation_;
  std::size_t count = 0;
  while (count < out.size()) {
    input_event event = {};
    const unsigned mode = self.catching_up ? LIBEVDEV_READ_FLAG_SYNC : LIBEVDEV_READ_FLAG_NORMAL;
    const int status = libevdev_next_event(self.device, mode, &event);
    if (status == -EAGAIN && self.catching_up) {
      self.catching_up = false;
      continue;
    }
    if (status < 0) {
      if (status != -EAGAIN && status != -EINTR) self.unplugged = true;
      break;
    }
    // The library hands over the state that was missed as ordinary events; that some were dropped is of no interest
    // then.
    if (status == LIBEVDEV_READ_STATUS_SYNC && !self.catching_up) {
      self.catching_up = true;
      continue;
    }
    out[count++] = {.time = static_cast<Nanoseconds>(event.input_event_sec) * kSecond +
                            static_cast<Nanoseconds>(event.input_event_usec) * 1000,
                    .type = event.type,
                    .code = event.code,
                    .value = event.value};
  }
  return count;
}

const std::string& WheelDevice::name() const { return implementation_->name; }
const std::vector<WheelAxis>& WheelDevice::axes() const { return implementation_->axes; }
bool WheelDevice::unplugged() const { return implementation_->unplugged; }
int WheelDevice::descriptor() const { return implementation_->descriptor; }

#else

bool has_wheel_devices() { return false; }

struct WheelDevice::Implementation {
  std::string name;
  std::vector<WheelAxis> axes;
};

WheelDevice::WheelDevice(const std::filesystem::path& path) {
  throw InputError(path.string(), "this build reads no wheels: it was made without libevdev (VERIDYN_WHEEL)");
}
std::size_t WheelDevice::read(std::span<WheelEvent> /*out*/) { return 0; }
const std::string& WheelDevice::name() const { return implementation_->name; }
const std::vector<WheelAxis>& WheelDevice::axes() const { return implementation_->axes; }
bool WheelDevice::unplugged() const { return true; }
int WheelDevice::descriptor() const { return -1; }

#endif

WheelDevice::~WheelDevice() = default;
WheelDevice::WheelDevice(WheelDevice&&) noexcept = default;
WheelDevice& WheelDevice::operator=(WheelDevice&&) noexcept = default;

}  // namespace veridyn::live
