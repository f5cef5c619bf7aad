// Compiled by itself and with -fno-math-errno, so that roots are taken in vector registers.
#include "veridyn/muscle/path/segment_lanes.hpp"

#include <cmath>
#include <cstring>

namespace veridyn::muscle::internal {
namespace {

using Four = double __attribute__((vector_size(32)));

[[gnu::always_inline]] inline void load_four(const double* from, Four& x) { std::memcpy(&x, from, sizeof x); }
[[gnu::always_inline]] inline void store_four(const Four& x, double* to) { std::memcpy(to, &x, sizeof x); }

[[gnu::always_inline]] inline void compute_lanes(const SegmentLanes& s) {
  const double* r = s.r;
  for (std::size_t i = 0; i < s.n; i += 4) {
    Four ax, ay, az, bx, by, bz, length;
    load_four(s.a[0] + i, ax);
    load_four(s.a[1] + i, ay);
    load_four(s.a[2] + i, az);
    load_four(s.b[0] + i, bx);
    load_four(s.b[1] + i, by);
    load_four(s.b[2] + i, bz);
    const Four x = bx * r[0] + by * r[3] + bz * r[6] + (s.t[0] - ax);
    const Four y = bx * r[1] + by * r[4] + bz * r[7] + (s.t[1] - ay);
    const Four z = bx * r[2] + by * r[5] + bz * r[8] + (s.t[2] - az);
    const Four square = x * x + y * y + z * z;
    for (int k = 0; k < 4; ++k) length[k] = std::sqrt(square[k]);
    store_four(length, s.length + i);
    if (s.coordinates == 0) continue;
    const Four per = 1.0 / length;
    const Four dx = x * per, dy = y * per, dz = z * per;
    const Four mx = ay * dz - az * dy, my = az * dx - ax * dz, mz = ax * dy - ay * dx;
    for (std::size_t j = 0; j < s.coordinates; ++j) {
      const double* c = s.motion + 6 * j;
      store_four(mx * c[0] + my * c[1] + mz * c[2] + (dx * c[3] + dy * c[4] + dz * c[5]), s.term + j * s.n + i);
    }
  }
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] void compute_with_avx2(const SegmentLanes& lanes) { compute_lanes(lanes); }
#endif

}  // namespace

void compute_without_avx2(const SegmentLanes& lanes) { compute_lanes(lanes); }

void compute(const SegmentLanes& lanes) {
#if defined(__x86_64__)
  static const bool has_avx2 = __builtin_cpu_supports("avx2");
  if (has_avx2) return compute_with_avx2(lanes);
#endif
  compute_without_avx2(lanes);
}

}  // namespace veridyn::muscle::internal
