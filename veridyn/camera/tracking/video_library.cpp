#include "veridyn/camera/tracking/video_library.hpp"

#include <dlfcn.h>

#include "veridyn/core/error.hpp"

namespace veridyn::camera {
namespace {

constexpr const char* kVideoLibrary = "libveridyn_video.so";

InputError without_video_library() {
  const char* why = dlerror();
  return InputError(kVideoLibrary, std::string("videos cannot be read: ") + (why != nullptr ? why : "it is damaged"));
}

VideoLibrary load_video_library() {
  // Never closed: OpenCV's own libraries do not bear it.
  void* library = dlopen(kVideoLibrary, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw without_video_library();
  void* entry = dlsym(library, kVideoLibraryEntry);
  if (entry == nullptr) throw without_video_library();
  VideoLibrary functions;
  reinterpret_cast<VideoLibraryEntry>(entry)(functions);
  return functions;
}

}  // namespace

GreyImage grey_image(const DecodedFrame& frame) {
  GreyImage image{.width = frame.width, .height = frame.height, .pixels = {}};
  image.pixels.reserve(static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height));
  for (int y = 0; y < frame.height; ++y) {
    const std::uint8_t* row = frame.pixels + static_cast<std::size_t>(y) * frame.row_bytes;
    image.pixels.insert(image.pixels.end(), row, row + frame.width);
  }
  return image;
}

const VideoLibrary& video_library() {
  static const VideoLibrary library = load_video_library();
  return library;
}

}  // namespace veridyn::camera
