// A camera for tests: loaded before a program (LD_PRELOAD) it answers for the device VERIDYN_FAKE_CAMERA_DEVICE as a
// driver of Video4Linux does, with the grey pictures of the file VERIDYN_FAKE_CAMERA_PICTURES, of
// VERIDYN_FAKE_CAMERA_WIDTH x _HEIGHT pixels, VERIDYN_FAKE_CAMERA_RATE a second; after the last one it is unplugged.
// Buffers that nobody hands in in time are pictures that are missed, as with a real one.
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/select.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <deque>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

template <typename Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

std::string setting(const char* name) {
  const char* text = std::getenv(("VERIDYN_FAKE_CAMERA_" + std::string(name)).c_str());
  return text != nullptr ? text : "";
}

/// What the program has of it; -1: it has not opened it.
int file_of_camera = -1;

struct Camera {
  std::uint32_t width = 0, height = 0;
  double rate = 30.0;
  std::vector<std::uint8_t> pictures;
  std::array<std::uint8_t*, 8> memory{};
  std::deque<std::uint32_t> handed_in;
  double begin = -1.0;  ///< of the stream
  long given = -1;      ///< number of the last picture

  Camera()
      : width(static_cast<std::uint32_t>(std::atoi(setting("WIDTH").c_str()))),
        height(static_cast<std::uint32_t>(std::atoi(setting("HEIGHT").c_str()))) {
    if (const std::string r = setting("RATE"); !r.empty()) rate = std::atof(r.c_str());
    std::ifstream in(setting("PICTURES"), std::ios::binary);
    pictures.assign(std::istreambuf_iterator<char>(in), {});
  }
  [[nodiscard]] std::size_t size() const { return std::size_t{width} * height; }
  [[nodiscard]] long count() const { return size() > 0 ? static_cast<long>(pictures.size() / size()) : 0; }
};

Camera& camera() {
  static Camera one;
  return one;
}

double now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

int fails(int error) {
  errno = error;
  return -1;
}

void describe(v4l2_format& format) {
  const Camera& c = camera();
  format.fmt.pix.width = c.width;
  format.fmt.pix.height = c.height;
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_GREY;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  format.fmt.pix.bytesperline = c.width;
  format.fmt.pix.sizeimage = static_cast<std::uint32_t>(c.size());
}

/// Number of the picture that is there: when the next one begins.
long due_picture() { return static_cast<long>((now() - camera().begin) * camera().rate) - 1; }

int take_out(v4l2_buffer& buffer) {
  Camera& c = camera();
  const long due = due_picture();
  if (due >= c.count()) return fails(ENODEV);
  if (due <= c.given || c.handed_in.empty()) return fails(EAGAIN);
  c.given = due;
  buffer.index = c.handed_in.front();
  c.handed_in.pop_front();
  std::memcpy(c.memory[buffer.index], c.pictures.data() + static_cast<std::size_t>(due) * c.size(), c.size());
  buffer.bytesused = buffer.length = static_cast<std::uint32_t>(c.size());
  buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  const double stamp = c.begin + static_cast<double>(due) / c.rate;
  buffer.timestamp.tv_sec = static_cast<time_t>(stamp);
  buffer.timestamp.tv_usec = static_cast<suseconds_t>(1e6 * (stamp - static_cast<double>(buffer.timestamp.tv_sec)));
  buffer.sequence = static_cast<std::uint32_t>(due);
  return 0;
}

int answer(unsigned long request, void* argument) {
  Camera& c = camera();
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& capability = *static_cast<v4l2_capability*>(argument);
      capability = {};
      std::strcpy(reinterpret_cast<char*>(capability.card), "fake camera");
      capability.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
      return 0;
    }
    case VIDIOC_G_FMT:
    case VIDIOC_S_FMT:
    case VIDIOC_TRY_FMT:
      describe(*static_cast<v4l2_format*>(argument));
      return 0;
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM: {
      auto& parameters = *static_cast<v4l2_streamparm*>(argument);
      parameters.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
      parameters.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(1000.0 * c.rate)};
      return 0;
    }
    case VIDIOC_REQBUFS: {
      auto& asked = *static_cast<v4l2_requestbuffers*>(argument);
      asked.count = std::min<std::uint32_t>(asked.count, static_cast<std::uint32_t>(c.memory.size()));
      return 0;
    }
    case VIDIOC_QUERYBUF: {
      auto& buffer = *static_cast<v4l2_buffer*>(argument);
      if (buffer.index >= c.memory.size()) return fails(EINVAL);
      buffer.length = static_cast<std::uint32_t>(c.size());
      buffer.m.offset = buffer.index << 20U;
      return 0;
    }
    case VIDIOC_QBUF:
      c.handed_in.push_back(static_cast<v4l2_buffer*>(argument)->index);
      return 0;
    case VIDIOC_DQBUF:
      return take_out(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON:
      c.begin = now();
      c.given = -1;
      return 0;
    case VIDIOC_STREAMOFF:
      c.handed_in.clear();
      return 0;
    default:
      return fails(EINVAL);
  }
}

bool is_ours(const char* path) {
  const std::string device = setting("DEVICE");
  return !device.empty() && device == path;
}

int open_ours() {
  static_cast<void>(camera());  // reads its pictures
  file_of_camera = next<int (*)(const char*, int, ...)>("open")("/dev/null", O_RDWR);
  return file_of_camera;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = va_arg(more, mode_t);
  va_end(more);
  return is_ours(path) ? open_ours() : next<int (*)(const char*, int, ...)>("open")(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = va_arg(more, mode_t);
  va_end(more);
  return is_ours(path) ? open_ours() : next<int (*)(const char*, int, ...)>("open64")(path, flags, mode);
}

int ioctl(int file, unsigned long request, ...) noexcept {
  va_list more;
  va_start(more, request);
  void* argument = va_arg(more, void*);
  va_end(more);
  if (file >= 0 && file == file_of_camera) return answer(request, argument);
  return next<int (*)(int, unsigned long, ...)>("ioctl")(file, request, argument);
}

void* mmap(void* address, size_t length, int protection, int flags, int file, off_t offset) noexcept {
  static const auto real = next<void* (*)(void*, size_t, int, int, int, off_t)>("mmap");
  if (file < 0 || file != file_of_camera) return real(address, length, protection, flags, file, offset);
  void* memory = real(nullptr, length, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  camera().memory[static_cast<std::size_t>(offset) >> 20U] = static_cast<std::uint8_t*>(memory);
  return memory;
}

void* mmap64(void* address, size_t length, int protection, int flags, int file, off64_t offset) noexcept {
  return mmap(address, length, protection, flags, file, offset);
}

int select(int count, fd_set* to_read, fd_set* to_write, fd_set* exceptions, timeval* timeout) {
  const int file = file_of_camera;
  if (file >= 0 && to_read != nullptr && FD_ISSET(file, to_read)) {
    while (due_picture() <= camera().given) usleep(200);
    return 1;
  }
  return next<int (*)(int, fd_set*, fd_set*, fd_set*, timeval*)>("select")(count, to_read, to_write, exceptions,
                                                                           timeout);
}

int close(int file) {
  if (file >= 0 && file == file_of_camera) file_of_camera = -1;
  return next<int (*)(int)>("close")(file);
}

}  // extern "C"
