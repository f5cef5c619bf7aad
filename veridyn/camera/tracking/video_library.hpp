#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "veridyn/camera/tracking/grey_image.hpp"

namespace veridyn::camera {

/// What a video says of itself.
struct VideoProperties {
  double width = 0.0, height = 0.0;  ///< [px]
  double rate_Hz = 0.0;
  double frames = 0.0;  ///< 0 or less: it does not say
};

/// View of a decoded frame in grey: the pixels are there until the next one is read.
struct DecodedFrame {
  const std::uint8_t* pixels = nullptr;
  std::size_t row_bytes = 0;
  int width = 0, height = 0;
  int bits = 0;        ///< of a pixel
  double stamp = 0.0;  ///< of a camera: when its driver had the picture [s]; 0: it does not say
};

/// A copy of a frame of 8 bits that stays.
[[nodiscard]] GreyImage grey_image(const DecodedFrame& frame);

/// How reading a frame ended.
enum class VideoRead {
  kFrame,
  kEnd,     ///< there is none
  kFailed,  ///< `error` says why
};

/// The functions of libveridyn_video.so, which is all that uses OpenCV. The program loads it where the first video is
/// opened: with the two hundred libraries that OpenCV brings every start of the program would take ten times as long.
/// Nothing is thrown across its border.
struct VideoLibrary {
  /// Null where the file is no video that can be read; `error` says what OpenCV said, if anything.
  void* (*open_reader)(const char* path, VideoProperties& properties, std::string& error) = nullptr;
  /// A camera of Video4Linux. Size and rate of `properties` are asked for where they are above 0; what the camera gives
  /// is written there. `format`: four letters, or empty. Null where it cannot be opened. Closed by `close_reader`.
  void* (*open_device)(const char* device, const char* format, VideoProperties& properties,
                       std::string& error) = nullptr;
  VideoRead (*read)(void* reader, DecodedFrame& frame, std::string& error) = nullptr;
  void (*close_reader)(void* reader) = nullptr;
  /// Of a Motion JPEG in AVI. Null where it cannot be written.
  void* (*open_writer)(const char* path, int width, int height, double rate_Hz) = nullptr;
  /// A grey frame of width x height pixels of 8 bits. False where it could not be written.
  bool (*write)(void* writer, const std::uint8_t* pixels) = nullptr;
  void (*close_writer)(void* writer) = nullptr;
};

/// The library's only name: fills in the table above.
using VideoLibraryEntry = void (*)(VideoLibrary& library);
inline constexpr const char* kVideoLibraryEntry = "veridyn_video_library";

/// The library, loaded at the first call.
/// @throws InputError when it cannot be loaded
const VideoLibrary& video_library();

}  // namespace veridyn::camera
