#include "fuzz/one_input.hpp"
#include "veridyn/io/ros/bag_database.hpp"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  return veridyn::fuzz::one_input(data, size,
                                  [](std::string_view bytes) { return veridyn::io::read_bag_database(bytes, "fuzz"); });
}
