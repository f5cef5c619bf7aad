// libveridyn_video.so: reading and writing videos by OpenCV, see video_library.hpp.
#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <string_view>

#include "veridyn/camera/tracking/video_library.hpp"

namespace veridyn::camera {
namespace {

struct Reader {
  cv::VideoCapture capture;
  cv::Mat frame, grey;  // kept, so that frames of equal size do not allocate
  // OpenCV scales frames of another size to the first one's without a word: of Motion JPEG the pictures themselves are
  // looked at, too.
  cv::VideoCapture pictures;
  cv::Mat picture;
  bool is_device = false;
};

/// Size that the head of a JPEG says; nothing where it is none.
std::optional<cv::Size> jpeg_size(const cv::Mat& bytes) {
  const std::size_t size = bytes.total() * bytes.elemSize();
  const unsigned char* b = bytes.data;
  if (size < 4 || b[0] != 0xFF || b[1] != 0xD8) return std::nullopt;
  for (std::size_t at = 2; at + 9 <= size && b[at] == 0xFF;) {
    const unsigned marker = b[at + 1];
    const bool of_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (of_frame) return cv::Size(b[at + 7] * 256 + b[at + 8], b[at + 5] * 256 + b[at + 6]);
    at += 2U + b[at + 2] * 256U + b[at + 3];
  }
  return std::nullopt;
}

struct Writer {
  cv::VideoWriter writer;
  cv::Mat colour;
  int width = 0, height = 0;
};

void* open_reader(const char* path, VideoProperties& properties, std::string& error) {
  // A file that is no video is said by the caller, in one line.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  auto reader = std::make_unique<Reader>();
  try {
    // By this library only: for a file that it cannot read OpenCV goes on to look for cameras on the USB.
    if (!reader->capture.open(path, cv::CAP_FFMPEG)) return nullptr;
    reader->pictures.open(path, cv::CAP_FFMPEG, {cv::CAP_PROP_FORMAT, -1});
    properties = {.width = reader->capture.get(cv::CAP_PROP_FRAME_WIDTH),
                  .height = reader->capture.get(cv::CAP_PROP_FRAME_HEIGHT),
                  .rate_Hz = reader->capture.get(cv::CAP_PROP_FPS),
                  .frames = reader->capture.get(cv::CAP_PROP_FRAME_COUNT)};
  } catch (const cv::Exception& exception) {
    error = exception.err;
    return nullptr;
  }
  return reader.release();
}

void* open_device(const char* device, const char* format, VideoProperties& properties, std::string& error) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  auto reader = std::make_unique<Reader>();
  reader->is_device = true;
  try {
    cv::VideoCapture& camera = reader->capture;
    if (!camera.open(device, cv::CAP_V4L2)) return nullptr;
    // The format first: size and rate that a camera can do depend on it.
    if (const std::string_view f = format; f.size() == 4)
      camera.set(cv::CAP_PROP_FOURCC, cv::VideoWriter::fourcc(f[0], f[1], f[2], f[3]));
    if (properties.width > 0.0) {
      camera.set(cv::CAP_PROP_FRAME_WIDTH, properties.width);
      camera.set(cv::CAP_PROP_FRAME_HEIGHT, properties.height);
    }
    if (properties.rate_Hz > 0.0) camera.set(cv::CAP_PROP_FPS, properties.rate_Hz);
    // Of pictures that nobody took in time the newest counts: those before would only be late.
    camera.set(cv::CAP_PROP_BUFFERSIZE, 2);
    properties = {.width = camera.get(cv::CAP_PROP_FRAME_WIDTH),
                  .height = camera.get(cv::CAP_PROP_FRAME_HEIGHT),
                  .rate_Hz = camera.get(cv::CAP_PROP_FPS),
                  .frames = 0.0};
  } catch (const cv::Exception& exception) {
    error = exception.err;
    return nullptr;
  }
  return reader.release();
}

VideoRead read(void* of, DecodedFrame& frame, std::string& error) {
  Reader& r = *static_cast<Reader*>(of);
  try {
    if (!r.capture.read(r.frame) || r.frame.empty()) return VideoRead::kEnd;
    if (r.pictures.isOpened() && !r.pictures.read(r.picture)) r.pictures.release();
    if (r.pictures.isOpened() && !jpeg_size(r.picture)) r.pictures.release();  // of another kind
    if (r.frame.channels() == 1) {
      r.grey = r.frame;
    } else {
      cv::cvtColor(r.frame, r.grey, cv::COLOR_BGR2GRAY);
    }
  } catch (const cv::Exception& exception) {
    error = exception.err;
    return VideoRead::kFailed;
  }
  frame = {.pixels = r.grey.data,
           .row_bytes = r.grey.step[0],
           .width = r.grey.cols,
           .height = r.grey.rows,
           .bits = static_cast<int>(8 * r.grey.elemSize1()),
           .stamp = r.is_device ? 1e-3 * r.capture.get(cv::CAP_PROP_POS_MSEC) : 0.0};
  if (const std::optional<cv::Size> size = r.pictures.isOpened() ? jpeg_size(r.picture) : std::nullopt) {
    frame.width = size->width;
    frame.height = size->height;
  }
  return VideoRead::kFrame;
}

void close_reader(void* reader) { delete static_cast<Reader*>(reader); }

void* open_writer(const char* path, int width, int height, double rate_Hz) {
  auto w = std::make_unique<Writer>();
  w->width = width;
  w->height = height;
  try {
    w->writer.open(path, cv::CAP_ANY, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate_Hz, cv::Size(width, height),
                   true);
    if (!w->writer.isOpened()) return nullptr;
    w->writer.set(cv::VIDEOWRITER_PROP_QUALITY, 95.0);
  } catch (const cv::Exception&) {
    return nullptr;
  }
  return w.release();
}

bool write(void* to, const std::uint8_t* pixels) {
  Writer& w = *static_cast<Writer*>(to);
  try {
    cv::Mat grey(cv::Size(w.width, w.height), CV_8UC1);
    for (int y = 0; y < w.height; ++y)
      std::copy_n(pixels + static_cast<std::ptrdiff_t>(y) * w.width, w.width, grey.ptr<std::uint8_t>(y));
    cv::cvtColor(grey, w.colour, cv::COLOR_GRAY2BGR);
    w.writer.write(w.colour);
  } catch (const cv::Exception&) {
    return false;
  }
  return true;
}

void close_writer(void* writer) { delete static_cast<Writer*>(writer); }

}  // namespace
}  // namespace veridyn::camera

/// The library's only name.
extern "C" __attribute__((visibility("default"))) void veridyn_video_library(veridyn::camera::VideoLibrary& library) {
  using namespace veridyn::camera;
  library = {.open_reader = open_reader,
             .open_device = open_device,
             .read = read,
             .close_reader = close_reader,
             .open_writer = open_writer,
             .write = write,
             .close_writer = close_writer};
}
