#pragma once

#include <array>
#include <cstddef>

namespace veridyn::muscle::internal {

/// Straight segments between the same two links, in the first one's frame: A
/// fixed there, B taken there by r and t.
struct SegmentLanes {
  std::array<const double*, 3> a, b;  ///< by axis, n values each
  std::size_t n = 0;                  ///< a multiple of 4
  const double* r = nullptr;          ///< 3 x 3, columns first
  const double* t = nullptr;
  const double* motion = nullptr;  ///< by coordinate: angular and linear
                                   ///< velocity of the second link, 6 values
  std::size_t coordinates = 0;     ///< 0: lengths only
  double* length = nullptr;        ///< n
  double* term = nullptr;          ///< dlength/dq, by coordinate n values
};

/// Lengths and their derivatives, four segments at a time: in registers of four
/// doubles where the processor has them (AVX2), with the same bits where it has
/// not.
void compute(const SegmentLanes& lanes);

/// With and without those registers, to compare.
void compute_without_avx2(const SegmentLanes& lanes);

}  // namespace veridyn::muscle::internal
