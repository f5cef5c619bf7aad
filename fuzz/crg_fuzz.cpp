#include <cmath>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/road/crg_reader.hpp"

// A road is read or refused; one that was read has a height everywhere.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const veridyn::vehicle::CrgRoad road = veridyn::vehicle::parse_crg(bytes, "fuzz");
    for (const double x : {-1e9, 0.0, 0.7, 1e9}) VERIDYN_ASSERT(std::isfinite(road.height({x, 0.3 * x, 0.0, 0.0})));
  } catch (const veridyn::InputError&) {
  }
  return 0;
}
