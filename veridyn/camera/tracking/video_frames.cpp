#include "veridyn/camera/tracking/video_frames.hpp"

#include <fmt/format.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string>

#include "veridyn/core/error.hpp"

namespace veridyn::camera {

struct VideoFrames::Reader {
  std::string name;
  cv::VideoCapture capture;
  int width = 0, height = 0;
  double rate = 0.0;
  long long announced = 0;  ///< frames; 0: the file does not say
  long long read = 0;
  cv::Mat frame, grey;  ///< kept, so that frames of equal size do not allocate
};

VideoFrames::VideoFrames(const std::filesystem::path& path) : reader_(std::make_unique<Reader>()) {
  // A file that is no video is said here, in one line.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  Reader& r = *reader_;
  r.name = path.string();
  if (!std::filesystem::is_regular_file(path)) throw InputError(r.name, "is not a file");
  try {
    // By this library only: for a file that it cannot read OpenCV goes on to look for cameras on the USB.
    if (!r.capture.open(r.name, cv::CAP_FFMPEG)) throw InputError(r.name, "is no video that can be read");
    r.width = static_cast<int>(r.capture.get(cv::CAP_PROP_FRAME_WIDTH));
    r.height = static_cast<int>(r.capture.get(cv::CAP_PROP_FRAME_HEIGHT));
    r.rate = r.capture.get(cv::CAP_PROP_FPS);
    const double count = r.capture.get(cv::CAP_PROP_FRAME_COUNT);
    r.announced = count > 0.0 && count < 1e12 ? std::llround(count) : 0;
  } catch (const cv::Exception& error) {
    throw InputError(r.name, fmt::format("is no video that can be read ({})", error.err));
  }
  if (r.width < 1 || r.height < 1) throw InputError(r.name, "does not say how large its frames are");
  if (!(r.rate > 0.0 && std::isfinite(r.rate)))
    throw InputError(r.name, "does not say how many frames a second it has");
}

VideoFrames::~VideoFrames() = default;
VideoFrames::VideoFrames(VideoFrames&&) noexcept = default;
VideoFrames& VideoFrames::operator=(VideoFrames&&) noexcept = default;

int VideoFrames::width() const { return reader_->width; }
int VideoFrames::height() const { return reader_->height; }
double VideoFrames::rate_Hz() const { return reader_->rate; }

std::optional<VideoFrame> VideoFrames::next() {
  Reader& r = *reader_;
  try {
    if (!r.capture.read(r.frame) || r.frame.empty()) {
      if (r.read < r.announced)
        throw InputError(r.name, fmt::format("ends after {} of the {} frames that it announces", r.read, r.announced));
      return std::nullopt;
    }
    if (r.frame.cols != r.width || r.frame.rows != r.height)
      throw InputError(r.name, fmt::format("frame {} is {} x {} px, those before {} x {}", r.read, r.frame.cols,
                                           r.frame.rows, r.width, r.height));
    if (r.frame.channels() == 1) {
      r.grey = r.frame;
    } else {
      cv::cvtColor(r.frame, r.grey, cv::COLOR_BGR2GRAY);
    }
    if (r.grey.depth() != CV_8U) throw InputError(r.name, "its pixels are not of 8 bits");
  } catch (const cv::Exception& error) {
    throw InputError(r.name, fmt::format("frame {} cannot be read ({})", r.read, error.err));
  }
  VideoFrame frame;
  frame.time = static_cast<double>(r.read) / r.rate;
  frame.image.width = r.width;
  frame.image.height = r.height;
  for (int y = 0; y < r.height; ++y) {
    const std::uint8_t* row = r.grey.ptr<std::uint8_t>(y);
    frame.image.pixels.insert(frame.image.pixels.end(), row, row + r.width);
  }
  ++r.read;
  return frame;
}

void write_video(const std::filesystem::path& path, std::span<const GreyImage> images, double rate_Hz) {
  if (images.empty()) throw InputError(path.string(), "no pictures for a video");
  const cv::Size size(images.front().width, images.front().height);
  cv::VideoWriter writer(path.string(), cv::CAP_ANY, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate_Hz, size, true);
  if (!writer.isOpened()) throw InputError(path.string(), "cannot be written as a video");
  writer.set(cv::VIDEOWRITER_PROP_QUALITY, 95.0);
  for (const GreyImage& image : images) {
    if (image.width != size.width || image.height != size.height)
      throw InputError(path.string(), "pictures of a video must have one size");
    cv::Mat grey(size, CV_8UC1), colour;
    for (int y = 0; y < image.height; ++y) std::copy_n(image.view().row(y), image.width, grey.ptr<std::uint8_t>(y));
    cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
    writer.write(colour);
  }
}

}  // namespace veridyn::camera
