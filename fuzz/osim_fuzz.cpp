#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

// A model is read or refused; what is read writes back as it was.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const veridyn::muscle::OsimFile file = veridyn::muscle::OsimFile::parse(text, "fuzz");
    VERIDYN_ASSERT(file.text_with(file.model()) == text);
  } catch (const veridyn::InputError&) {
  }
  return 0;
}
