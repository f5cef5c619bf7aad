#include "veridyn/camera/tracking/camera_device.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>

#include "veridyn/camera/tracking/video_library.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::camera {
namespace {

/// Whether it takes pictures, by the driver; asked before OpenCV, which does not say why it cannot open a device.
void require_camera(const std::string& device) {
  const int file = ::open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) throw InputError(device, internal::camera_refusal(errno));
  v4l2_capability capability{};
  const bool answers = ::ioctl(file, VIDIOC_QUERYCAP, &capability) == 0;
  ::close(file);
  if (!answers) throw InputError(device, "is no camera");
  const bool whole = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) == 0;
  const std::uint32_t can = whole ? capability.capabilities : capability.device_caps;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0)
    throw InputError(device, "takes no pictures; a camera often has several devices, of which the first does");
}

}  // namespace

std::string internal::camera_refusal(int system_error) {
  switch (system_error) {
    case ENOENT:
    case ENXIO:
    case ENODEV:
      return "there is no such device; is it plugged in?";
    case EACCES:
    case EPERM:
      return "no right to open it; members of the group 'video' have it";
    case EBUSY:
      return "in use by another program";
    default:
      return "cannot be opened: " + std::generic_category().message(system_error);
  }
}

const KeyTable<CameraDeviceOptions>& CameraDeviceOptions::keys() {
  using O = CameraDeviceOptions;
  static const char* const kAsSet = "as the camera is set";
  static const auto table =
      KeyTable<O>("device", "What is asked of a camera.")
          .count("width", &O::width, 0, 100'000, "of its pictures, together with `height` [px]")
          .otherwise(kAsSet)
          .count("height", &O::height, 0, 100'000, "of its pictures [px]")
          .otherwise(kAsSet)
          .number("rate", &O::rate_Hz, "Hz", from_to(0.0, 1000.0), "of its pictures")
          .otherwise(kAsSet)
          .text("format", &O::format, "four letters, as `MJPG` or `YUYV`")
          .otherwise("any that can be read")
          .check([](const StudyTable& t, O& o) {
            if ((o.width == 0) != (o.height == 0))
              t.fail(o.width == 0 ? "height" : "width", "needs the other one: width and height together");
            if (!o.format.empty() && o.format.size() != 4)
              t.fail("format", fmt::format("= \"{}\" must be four letters, as \"MJPG\" or \"YUYV\"", o.format));
          });
  return table;
}

struct CameraDevice::Reader {
  std::string name;
  std::unique_ptr<void, void (*)(void*)> video{nullptr, nullptr};
  int width = 0, height = 0;
  double rate = 0.0;
};

CameraDevice::CameraDevice(const std::filesystem::path& device, const CameraDeviceOptions& options)
    : reader_(std::make_unique<Reader>()) {
  Reader& r = *reader_;
  r.name = device.string();
  require_camera(r.name);
  const VideoLibrary& library = video_library();
  VideoProperties properties{.width = static_cast<double>(options.width),
                             .height = static_cast<double>(options.height),
                             .rate_Hz = options.rate_Hz};
  std::string error;
  r.video = {library.open_device(r.name.c_str(), options.format.c_str(), properties, error), library.close_reader};
  if (r.video == nullptr)
    throw InputError(r.name, error.empty() ? "in use by another program, or of a format that cannot be read"
                                           : fmt::format("cannot be read ({})", error));
  r.width = static_cast<int>(properties.width);
  r.height = static_cast<int>(properties.height);
  r.rate = std::isfinite(properties.rate_Hz) ? std::max(0.0, properties.rate_Hz) : 0.0;
  if (options.width > 0 && (r.width != options.width || r.height != options.height))
    throw InputError(r.name, fmt::format("gives {} x {} px where {} x {} are asked for (device.width, device.height)",
                                         r.width, r.height, options.width, options.height));
  constexpr double kSame = 0.02;  // 30000/1001 Hz are 30
  if (options.rate_Hz > 0.0 && r.rate > 0.0 && std::abs(r.rate / options.rate_Hz - 1.0) > kSame)
    throw InputError(r.name,
                     fmt::format("gives {:g} pictures a second where {:g} are asked for (device.rate); some cameras "
                                 "give more as device.format = \"MJPG\"",
                                 r.rate, options.rate_Hz));
}

CameraDevice::~CameraDevice() = default;
CameraDevice::CameraDevice(CameraDevice&&) noexcept = default;
CameraDevice& CameraDevice::operator=(CameraDevice&&) noexcept = default;

int CameraDevice::width() const { return reader_->width; }
int CameraDevice::height() const { return reader_->height; }
double CameraDevice::rate_Hz() const { return reader_->rate; }

DeviceFrame CameraDevice::next() {
  Reader& r = *reader_;
  DecodedFrame decoded;
  std::string error;
  switch (video_library().read(r.video.get(), decoded, error)) {
    case VideoRead::kFrame:
      break;
    case VideoRead::kEnd:
      throw InputError(r.name, "gives no more pictures; is it still plugged in?");
    case VideoRead::kFailed:
      throw InputError(r.name, fmt::format("a picture cannot be read ({})", error));
  }
  if (decoded.width != r.width || decoded.height != r.height || decoded.bits != 8)
    throw InputError(r.name, fmt::format("gives a picture of {} x {} px and {} bits, not {} x {} and 8", decoded.width,
                                         decoded.height, decoded.bits, r.width, r.height));
  return {.stamp = decoded.stamp, .image = grey_image(decoded)};
}

}  // namespace veridyn::camera
