#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>

#include "veridyn/vehicle/road/road.hpp"

namespace veridyn::vehicle::testing {

/// A point of a straight drive along x.
inline RoadPoint at(double distance, double offset = 0.75) { return {distance, offset, distance, offset}; }

/// A small OpenCRG file: header, and the surface in text and binary formats.
inline std::string crg_header(const std::string& format, const std::string& more_keys = "",
                              const std::string& more = "") {
  return "$CT ! comment\nany text = with signs $ and !\n$\n$ROAD_CRG\n"
         "reference_line_start_u = 0.0\nreference_line_end_u = 4.0 ! [m]\nREFERENCE_LINE_INCREMENT = 2.0\n"
         "* a comment\nlong_section_v_right = -1\nlong_section_v_increment = 1.5\nreference_line_start_x = 10\n" +
         more_keys + "$\n$KD_Definition\n#:" + format + "\nU:reference line u,m,0.0,2.0\n" + more +
         "D:long section 1,m\nD:long section 2,m\nD:long section 3,m\n$\n$$$$$$$$\n";
}

// z(u, v) row by row from right to left.
inline constexpr std::array<double, 9> kHeights{0.0, 0.1, 0.2, 0.5, 0.25, 0.125, -1.0, -2.0, 3.0};

template <typename Real, typename Bits>
std::string big_endian(const std::string& format) {
  std::string bytes = crg_header(format);
  for (const double z : kHeights) {
    const Bits bits = std::bit_cast<Bits>(static_cast<Real>(z));
    for (std::size_t k = sizeof(Bits); k-- > 0;) bytes += static_cast<char>(bits >> (8 * k) & 0xff);
  }
  for (std::size_t i = 0; i < 11 * sizeof(Bits); ++i) bytes += '\x7f';  // padding: NaN
  return bytes;
}

inline std::string text_crg() {
  return crg_header("LRFI") + " 0.0000000 0.1000000 0.2000000\n" + " 0.5000000 0.2500000 0.1250000\n" +
         "-1.0000000-2.0000000 3.0000000\n";
}

}  // namespace veridyn::vehicle::testing
