#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "veridyn/camera/tracking/grey_image.hpp"

namespace veridyn::camera {

/// A frame of a video.
struct VideoFrame {
  double time = 0.0;  ///< [s] since the first frame, as the file says
  GreyImage image;
};

/// Frames of a video file, one after the other, in grey.
class VideoFrames {
 public:
  /// @throws InputError naming the file when it is missing, no video, or does not say its size and rate
  explicit VideoFrames(const std::filesystem::path& path);
  ~VideoFrames();
  VideoFrames(VideoFrames&&) noexcept;
  VideoFrames& operator=(VideoFrames&&) noexcept;

  /// The next frame; nothing at the end.
  /// @throws InputError naming the file and the frame (from 0) that has another size than the first or cannot be read
  /// although the file announces more
  [[nodiscard]] std::optional<VideoFrame> next();

  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  [[nodiscard]] double rate_Hz() const;

 private:
  struct Reader;
  std::unique_ptr<Reader> reader_;
};

/// Writes a video picture by picture (Motion JPEG in AVI).
class VideoWriter {
 public:
  /// @throws InputError when it cannot be written
  VideoWriter(std::filesystem::path path, int width, int height, double rate_Hz);
  ~VideoWriter();
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;

  /// @throws InputError when it cannot be written or is of another size
  void add(const GreyImage& image);

 private:
  struct Writer;
  std::unique_ptr<Writer> writer_;
};

/// The same of pictures that are all there.
/// @throws InputError when it cannot be written
void write_video(const std::filesystem::path& path, std::span<const GreyImage> images, double rate_Hz);

}  // namespace veridyn::camera
