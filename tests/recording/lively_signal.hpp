#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "veridyn/numerics/random.hpp"

namespace veridyn::testing {

/// Of the samples of these signals.
inline constexpr double kLivelyRate_Hz = 100.0;

/// Band-limited noise: a random walk through a slow pole, the same for the same name.
inline std::vector<double> lively(std::size_t count, const char* name, std::uint64_t seed = 3) {
  numerics::RandomStream random(seed, name);
  std::vector<double> x(count);
  double fast = 0.0, slow = 0.0;
  for (double& v : x) {
    fast += 0.2 * (random.normal() - fast);
    slow += 0.2 * (fast - slow);
    v = slow;
  }
  return x;
}

/// The same, so many samples later; zero before.
inline std::vector<double> later(const std::vector<double>& x, std::size_t samples) {
  std::vector<double> y(x.size(), 0.0);
  for (std::size_t k = samples; k < x.size(); ++k) y[k] = x[k - samples];
  return y;
}

}  // namespace veridyn::testing
