#include "fuzz/one_input.hpp"
#include "veridyn/io/matlab/mat.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  // As it is, with names for the columns of a matrix, and at a rate.
  for (const veridyn::io::TableOptions& options :
       {veridyn::io::TableOptions{}, veridyn::io::TableOptions{.columns = {"time", "p[deg/s]", "q"}},
        veridyn::io::TableOptions{.rate = 50.0}}) {
    static_cast<void>(veridyn::fuzz::one_input(
        data, size, [&](std::string_view bytes) { return veridyn::io::read_mat(bytes, "fuzz", options); }));
  }
  return 0;
}
