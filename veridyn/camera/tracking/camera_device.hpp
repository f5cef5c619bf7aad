#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "veridyn/camera/tracking/grey_image.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::camera {

/// What is asked of a camera, `[device]`.
struct CameraDeviceOptions {
  int width = 0, height = 0;  ///< [px]; 0: as the camera is set
  double rate_Hz = 0.0;       ///< 0: as the camera is set
  std::string format;         ///< four letters, as "MJPG"; empty: any that can be read

  [[nodiscard]] static const KeyTable<CameraDeviceOptions>& keys();
};

/// A picture as a camera took it.
struct DeviceFrame {
  double stamp = 0.0;  ///< [s] when the driver had it, by the clock of the machine that does not jump (CLOCK_MONOTONIC)
  GreyImage image;
};

/// A camera of the machine (Video4Linux), its pictures one after the other, in grey.
class CameraDevice {
 public:
  /// @throws InputError naming the device when it is missing, no camera, not ours to open, in use by another program,
  /// or cannot do what is asked
  CameraDevice(const std::filesystem::path& device, const CameraDeviceOptions& options);
  ~CameraDevice();
  CameraDevice(CameraDevice&&) noexcept;
  CameraDevice& operator=(CameraDevice&&) noexcept;

  /// The next picture, waited for.
  /// @throws InputError naming the device when none comes (it was unplugged) or one is of another size
  [[nodiscard]] DeviceFrame next();

  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  /// As the driver says; 0: it does not.
  [[nodiscard]] double rate_Hz() const;

 private:
  struct Reader;
  std::unique_ptr<Reader> reader_;
};

namespace internal {

/// Why a device cannot be opened as a camera, of what the system says of it; the rest of a line.
[[nodiscard]] std::string camera_refusal(int system_error);

}  // namespace internal

}  // namespace veridyn::camera
