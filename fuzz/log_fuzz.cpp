// The reader of one row of `io::log_formats`: that with the key VERIDYN_FUZZED_FORMAT, which CMakeLists.txt defines.
#include <cstdlib>

#include "fuzz/one_input.hpp"
#include "veridyn/io/log_formats.hpp"

namespace veridyn::fuzz {
namespace {

const io::LogFormat& fuzzed_format() {
  for (const io::LogFormat& format : io::log_formats())
    if (format.key == VERIDYN_FUZZED_FORMAT) return format;
  std::abort();
}

/// How a study may ask for a table, by a first byte below 9 or the vertical tabulator; any other byte belongs to the
/// log, read by content alone.
io::TableOptions take_options(std::string_view& bytes) {
  io::TableOptions options;
  const unsigned how = bytes.empty() ? 9U : static_cast<unsigned char>(bytes.front());
  if (how >= 9 && how != 11) return options;  // 9 and 10 are a tabulator and a line end
  bytes.remove_prefix(1);
  if (how < 5) options.delimiter = ",;\t  "[how];
  if (how == 4) options.decimal = ',';
  if (how == 5) options.rate = 50.0;
  if (how == 6) options.columns = {"time", "p[deg/s]", "q"};
  if (how == 7) options.part = 2;
  if (how == 8) options.skip_lines = 2;
  if (how == 11) {
    options.variable = "fdata";
    options.part = 2;
  }
  return options;
}

}  // namespace
}  // namespace veridyn::fuzz

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace veridyn;
  static const io::LogFormat& format = fuzz::fuzzed_format();
  std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const io::TableOptions options = format.table ? fuzz::take_options(bytes) : io::TableOptions();
  (void)format.is(bytes);
  return fuzz::one_input(bytes, [&](std::string_view log) { return format.read(log, "fuzz", options); });
}
