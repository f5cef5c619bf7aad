#include "veridyn/core/error.hpp"
#include "veridyn/live/recording/live_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace veridyn;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  // As the content of a block, whose CRC would keep most inputs out; then as a file.
  (void)live::for_each_record(bytes, [](const live::LiveRecord&) {});
  try {
    (void)live::parse_live_file(bytes, "fuzz");
  } catch (const InputError&) {
  }
  return 0;
}
