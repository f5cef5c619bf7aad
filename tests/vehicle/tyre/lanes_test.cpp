#include "veridyn/vehicle/tyre/lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace veridyn::vehicle {
namespace {

using in_lanes::Both;
using in_lanes::Four;

constexpr double kUlp = std::numeric_limits<double>::epsilon();

using Numbers = std::array<double, 4>;

/// A function of lanes as one of arrays, compiled for the registers that every processor has.
template <typename Function>
Numbers in_narrow(const Function& function, const Numbers& x) {
  const Four y = function(in_lanes::from(x.data()));
  Numbers out;
  std::memcpy(out.data(), &y, sizeof y);
  return out;
}

struct ArcTangent {
  [[gnu::always_inline]] Four operator()(Four x) const { return in_lanes::arc_tangent(x); }
};
struct Sine {
  [[gnu::always_inline]] Four operator()(Four x) const { return in_lanes::sine(x); }
};
struct Exponential {
  [[gnu::always_inline]] Four operator()(Four x) const { return in_lanes::exponential(x); }
};
struct Root {
  [[gnu::always_inline]] Four operator()(Four x) const { return in_lanes::root(x); }
};

/// Four numbers of either sign, of sizes from `least` to `most`: all alike in one group of four, of any mixture in
/// another, so that both branches of the functions are met.
std::vector<Numbers> numbers(double least, double most, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> exponent(std::log(least), std::log(most));
  std::vector<Numbers> out(50000);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double shared = exponent(random);
    for (double& x : out[k]) {
      const double size =
          std::exp(k % 2 == 0 ? std::min(shared + 0.01 * exponent(random), std::log(most)) : exponent(random));
      x = random() % 2 == 0 ? size : -size;
    }
  }
  return out;
}

TEST(Lanes, ArcTangentsAreThoseOfLongDoubleOverAllNumbers) {
  double worst = 0.0, at = 0.0;
  for (const auto& [least, most] : {std::pair{1e-300, 1e-3}, {0.01, 20.0}, {0.3, 0.4}, {1.0, 1e300}}) {
    for (const Numbers& x : numbers(least, most, 1)) {
      const Numbers angles = in_narrow(ArcTangent{}, x);
      for (std::size_t i = 0; i < 4; ++i) {
        const long double exact = std::atan(static_cast<long double>(x[i]));
        const auto error = static_cast<double>(std::abs((angles[i] - exact) / exact));
        if (error > worst) worst = error, at = x[i];
      }
    }
  }
  EXPECT_LE(worst, 2.0 * kUlp) << at;
}

TEST(Lanes, SinesAreThoseOfLongDoubleUpToTheirLimit) {
  double worst = 0.0, at = 0.0;
  for (const auto& [least, most] : {std::pair{1e-300, 1e-3}, {0.01, 4.0}, {0.7, 0.8}, {1.0, 1e5}}) {
    for (const Numbers& x : numbers(least, most, 2)) {
      const Numbers sines = in_narrow(Sine{}, x);
      for (std::size_t i = 0; i < 4; ++i) {
        const auto error = static_cast<double>(std::abs(sines[i] - std::sin(static_cast<long double>(x[i]))));
        if (error > worst) worst = error, at = x[i];
      }
    }
  }
  EXPECT_LE(worst, kUlp) << at;
}

TEST(Lanes, SmallSinesKeepTheirRelativeAccuracy) {
  for (const Numbers& x : numbers(1e-300, 0.78, 3)) {
    const Numbers sines = in_narrow(Sine{}, x);
    for (std::size_t i = 0; i < 4; ++i) {
      const long double exact = std::sin(static_cast<long double>(x[i]));
      ASSERT_LE(static_cast<double>(std::abs((sines[i] - exact) / exact)), kUlp) << x[i];
    }
  }
}

TEST(Lanes, ExponentialsAreThoseOfLongDouble) {
  for (const Numbers& x : numbers(1e-10, 700.0, 4)) {
    const Numbers powers = in_narrow(Exponential{}, x);
    for (std::size_t i = 0; i < 4; ++i) {
      const long double exact = std::exp(static_cast<long double>(x[i]));
      ASSERT_LE(static_cast<double>(std::abs((powers[i] - exact) / exact)), 2.0 * kUlp) << x[i];
    }
  }
}

TEST(Lanes, TakeSpecialNumbersAsTheLibraryDoes) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const double nan = std::nan(""), least = std::numeric_limits<double>::denorm_min();
  const Numbers far = in_narrow(ArcTangent{}, {kInf, -kInf, nan, 1e308});
  EXPECT_EQ(far[0], std::atan(kInf));
  EXPECT_EQ(far[1], -std::atan(kInf));
  EXPECT_TRUE(std::isnan(far[2]));
  EXPECT_EQ(far[3], std::atan(1e308));
  // Alone, and with a large one beside them, which takes the other branch.
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  for (const double beside : {0.0, 3.0}) {
    for (const double x : {0.0, -0.0, least, -least, 1e-310}) {
      EXPECT_EQ(bits(in_narrow(ArcTangent{}, {x, 0.1, 0.2, beside})[0]), bits(x)) << x << " beside " << beside;
      EXPECT_EQ(bits(in_narrow(Sine{}, {x, 0.1, 0.2, beside})[0]), bits(x == 0.0 ? 0.0 : x)) << x << " by " << beside;
    }
  }
  EXPECT_TRUE(std::isnan(in_narrow(Sine{}, {nan, 0.0, 0.0, 0.0})[0]));
  EXPECT_EQ(in_narrow(Exponential{}, {0.0, -0.0, 0.0, 0.0}), (Numbers{1.0, 1.0, 1.0, 1.0}));
  const Numbers roots = in_narrow(Root{}, {0.0, 2.0, kInf, -1.0});
  EXPECT_EQ(roots[0], 0.0);
  EXPECT_EQ(roots[1], std::sqrt(2.0));
  EXPECT_EQ(roots[2], kInf);
  EXPECT_TRUE(std::isnan(roots[3]));
}

/// What stands in the other lanes decides the branch, and must not decide the bits. Odd to the last bit as well.
template <typename Function>
void expect_lanes_do_not_see_each_other(double least, double most) {
  for (const Numbers& x : numbers(least, most, 5)) {
    const Numbers together = in_narrow(Function{}, x);
    for (std::size_t i = 0; i < 4; ++i) {
      const Numbers alone = in_narrow(Function{}, {x[i], x[i], x[i], x[i]});
      ASSERT_EQ(together[i], alone[0]) << x[i];
      ASSERT_EQ(in_narrow(Function{}, {-x[i], 100.0, 0.0, 0.0})[0], -alone[3]) << x[i];
    }
  }
}
TEST(Lanes, DoNotSeeEachOther) {
  expect_lanes_do_not_see_each_other<ArcTangent>(0.1, 3.0);
  expect_lanes_do_not_see_each_other<Sine>(0.1, 4.0);
}

TEST(Lanes, OfBothDirectionsAreThoseOfEach) {
  const std::vector<Numbers> along = numbers(0.01, 10.0, 7), across = numbers(0.1, 1.0, 8);
  for (std::size_t k = 0; k < along.size(); ++k) {
    const Both x{in_lanes::from(along[k].data()), in_lanes::from(across[k].data())};
    const Both angles = in_lanes::arc_tangent(x), sines = in_lanes::sine(x);
    const Numbers along_angles = in_narrow(ArcTangent{}, along[k]), across_angles = in_narrow(ArcTangent{}, across[k]);
    const Numbers along_sines = in_narrow(Sine{}, along[k]), across_sines = in_narrow(Sine{}, across[k]);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto lane = static_cast<int>(i);
      ASSERT_EQ(angles.x[lane], along_angles[i]);
      ASSERT_EQ(angles.y[lane], across_angles[i]);
      ASSERT_EQ(sines.x[lane], along_sines[i]);
      ASSERT_EQ(sines.y[lane], across_sines[i]);
    }
  }
}

#if defined(__x86_64__) && !defined(__clang__)
template <typename Function>
[[gnu::target("avx2")]] Numbers in_wide(const Function& function, const Numbers& x) {
  const Four y = function(in_lanes::from(x.data()));
  Numbers out;
  std::memcpy(out.data(), &y, sizeof y);
  return out;
}
template <typename Function>
void expect_same_bits_in_wide_registers(double least, double most) {
  for (const Numbers& x : numbers(least, most, 6)) {
    const Numbers narrow = in_narrow(Function{}, x), wide = in_wide(Function{}, x);
    ASSERT_EQ((std::bit_cast<std::array<std::uint64_t, 4>>(narrow)),
              (std::bit_cast<std::array<std::uint64_t, 4>>(wide)))
        << x[0] << " " << x[1] << " " << x[2] << " " << x[3];
  }
}
TEST(Lanes, GiveTheSameBitsInRegistersOfAnyWidth) {
  if (__builtin_cpu_supports("avx2") == 0) GTEST_SKIP() << "no AVX2 here";
  expect_same_bits_in_wide_registers<ArcTangent>(1e-3, 1e3);
  expect_same_bits_in_wide_registers<Sine>(1e-3, 1e5);
  expect_same_bits_in_wide_registers<Exponential>(1e-3, 700.0);
}
#endif

}  // namespace
}  // namespace veridyn::vehicle
