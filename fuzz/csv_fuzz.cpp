#include "fuzz/one_input.hpp"
#include "veridyn/io/tables/csv.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  // The first byte says how the table is read, as a study may; most of its values, by content alone.
  veridyn::io::TableOptions options;
  const unsigned char how = size > 0 ? data[0] : 0;
  if (how < 5) options.delimiter = ",;\t  "[how];
  if (how == 4) options.decimal = ',';
  if (how == 5) options.rate = 50.0;
  if (how == 6) options.columns = {"time", "p[deg/s]", "q"};
  if (how == 7) options.part = 2;
  return veridyn::fuzz::one_input(
      data + (how < 8 && size > 0 ? 1 : 0), size - (how < 8 && size > 0 ? 1 : 0),
      [&](std::string_view bytes) { return veridyn::io::read_csv(bytes, "fuzz", options); });
}
