#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/tables/npz.hpp"

// An archive is read or refused; the arrays of a log are as long as their stamps.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const veridyn::io::Log log = veridyn::io::read_npz(bytes, "fuzz");
    for (const veridyn::io::LogTopic& topic : log.topics) {
      for (const veridyn::io::LogField& field : topic.fields) VERIDYN_ASSERT(field.values.size() == topic.size());
    }
  } catch (const veridyn::InputError&) {
  }
  return 0;
}
