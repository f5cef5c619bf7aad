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

const VideoLibrary& video_library() {
  static const VideoLibrary library = load_video_library();
  return library;
}

}  // namespace veridyn::camera
