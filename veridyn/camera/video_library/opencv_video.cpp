// libveridyn_video.so: reading and writing videos by OpenCV, see video_library.hpp.
#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "veridyn/camera/tracking/video_library.hpp"

namespace veridyn::camera {
namespace {

struct Reader {
  cv::VideoCapture capture;
  cv::Mat frame, grey;  // kept, so that frames of equal size do not allocate
};

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

VideoRead read(void* of, DecodedFrame& frame, std::string& error) {
  Reader& r = *static_cast<Reader*>(of);
  try {
    if (!r.capture.read(r.frame) || r.frame.empty()) return VideoRead::kEnd;
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
           .bits = static_cast<int>(8 * r.grey.elemSize1())};
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
             .read = read,
             .close_reader = close_reader,
             .open_writer = open_writer,
             .write = write,
             .close_writer = close_writer};
}
