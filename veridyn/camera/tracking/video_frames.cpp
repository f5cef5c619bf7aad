#include "veridyn/camera/tracking/video_frames.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "veridyn/camera/tracking/video_library.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::camera {

struct VideoFrames::Reader {
  std::string name;
  std::unique_ptr<void, void (*)(void*)> video{nullptr, nullptr};
  int width = 0, height = 0;
  double rate = 0.0;
  long long announced = 0;  ///< frames; 0: the file does not say
  long long read = 0;
};

VideoFrames::VideoFrames(const std::filesystem::path& path) : reader_(std::make_unique<Reader>()) {
  Reader& r = *reader_;
  r.name = path.string();
  if (!std::filesystem::is_regular_file(path)) throw InputError(r.name, "is not a file");
  const VideoLibrary& library = video_library();
  VideoProperties properties;
  std::string error;
  r.video = {library.open_reader(r.name.c_str(), properties, error), library.close_reader};
  if (r.video == nullptr)
    throw InputError(r.name, error.empty() ? "is no video that can be read"
                                           : fmt::format("is no video that can be read ({})", error));
  constexpr double kLargest_px = 1e6;
  if (!(properties.width >= 1.0 && properties.height >= 1.0 && properties.width < kLargest_px &&
        properties.height < kLargest_px))
    throw InputError(r.name, "does not say how large its frames are");
  r.width = static_cast<int>(properties.width);
  r.height = static_cast<int>(properties.height);
  r.rate = properties.rate_Hz;
  r.announced = properties.frames > 0.0 && properties.frames < 1e12 ? std::llround(properties.frames) : 0;
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
  DecodedFrame decoded;
  std::string error;
  const VideoRead read = video_library().read(r.video.get(), decoded, error);
  if (read == VideoRead::kFailed) throw InputError(r.name, fmt::format("frame {} cannot be read ({})", r.read, error));
  if (read == VideoRead::kEnd) {
    if (r.read < r.announced)
      throw InputError(r.name, fmt::format("ends after {} of the {} frames that it announces", r.read, r.announced));
    return std::nullopt;
  }
  if (decoded.width != r.width || decoded.height != r.height)
    throw InputError(r.name, fmt::format("frame {} is {} x {} px, those before {} x {}", r.read, decoded.width,
                                         decoded.height, r.width, r.height));
  if (decoded.bits != 8) throw InputError(r.name, "its pixels are not of 8 bits");
  VideoFrame frame;
  frame.time = static_cast<double>(r.read) / r.rate;
  frame.image = grey_image(decoded);
  ++r.read;
  return frame;
}

struct VideoWriter::Writer {
  std::filesystem::path path;
  int width = 0, height = 0;
  std::unique_ptr<void, void (*)(void*)> video{nullptr, nullptr};
};

VideoWriter::VideoWriter(std::filesystem::path path, int width, int height, double rate_Hz)
    : writer_(std::make_unique<Writer>()) {
  const VideoLibrary& library = video_library();
  writer_->video = {library.open_writer(path.c_str(), width, height, rate_Hz), library.close_writer};
  if (writer_->video == nullptr) throw InputError(path.string(), "cannot be written as a video");
  writer_->path = std::move(path);
  writer_->width = width;
  writer_->height = height;
}

VideoWriter::~VideoWriter() = default;
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;

void VideoWriter::add(const GreyImage& image) {
  Writer& w = *writer_;
  if (image.width != w.width || image.height != w.height)
    throw InputError(w.path.string(), "pictures of a video must have one size");
  if (!video_library().write(w.video.get(), image.pixels.data()))
    throw InputError(w.path.string(), "cannot be written as a video");
}

void write_video(const std::filesystem::path& path, std::span<const GreyImage> images, double rate_Hz) {
  if (images.empty()) throw InputError(path.string(), "no pictures for a video");
  VideoWriter writer(path, images.front().width, images.front().height, rate_Hz);
  for (const GreyImage& image : images) writer.add(image);
}

}  // namespace veridyn::camera
