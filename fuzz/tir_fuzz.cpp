#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

// A tyre file is read or refused; a tyre that was read has finite forces.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const veridyn::vehicle::TirFile file = veridyn::vehicle::parse_tir(text, "fuzz");
    const auto none = file.tyre.forces(0.0, 0.1, 0.1, 0.0);
    VERIDYN_ASSERT(none.Fx == 0.0 && none.Fy == 0.0);
  } catch (const veridyn::InputError&) {
  }
  return 0;
}
