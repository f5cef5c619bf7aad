#include <optional>
#include <string>
#include <string_view>

#include "veridyn/core/units.hpp"
#include "veridyn/io/tables/unit_words.hpp"

// Whatever is taken for a unit is one that `parse_unit` reads: it throws otherwise, and the target stops.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const std::optional<std::string> unit = veridyn::io::unit_in_words(text)) (void)veridyn::parse_unit(*unit);
  return 0;
}
