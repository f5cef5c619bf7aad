#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/tables/npy.hpp"

// An array is read or refused; its columns are as long as it says.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const veridyn::io::NpyArray array = veridyn::io::read_npy(bytes, "fuzz");
    for (const veridyn::io::Column& column : array.columns) VERIDYN_ASSERT(column.size() == array.rows());
  } catch (const veridyn::InputError&) {
  }
  return 0;
}
