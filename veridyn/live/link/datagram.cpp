#include "veridyn/live/link/datagram.hpp"

#include <fmt/format.h>

namespace veridyn::live {

std::string to_string(const Sender& s) {
  return fmt::format("{}.{}.{}.{}:{}", s.address >> 24U, (s.address >> 16U) & 0xffU, (s.address >> 8U) & 0xffU,
                     s.address & 0xffU, s.port);
}

}  // namespace veridyn::live
