#include <string_view>

#include "veridyn/core/assert.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/io/tables/number_table.hpp"

// A table has columns of equal length, each of numbers or of texts, and finds them by their names.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace veridyn;
  try {
    const io::NumberTable table =
        io::read_number_table(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz");
    VERIDYN_ASSERT(table.rows > 0 && !table.columns.empty());
    for (const io::NumberColumn& column : table.columns) {
      VERIDYN_ASSERT((column.is_number() ? column.number.size() : column.text.size()) == table.rows);
      VERIDYN_ASSERT(&table.at(column.name) == &column);
    }
  } catch (const InputError&) {
  }
  return 0;
}
