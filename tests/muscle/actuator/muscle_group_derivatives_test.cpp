// Muscles with derivatives.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/muscle/actuator/muscle_variants.hpp"
#include "veridyn/muscle/simulation/system_linearization.hpp"

namespace veridyn::muscle {
namespace {

/// Every kind of muscle, off equilibrium and away from the corners of its curves.
struct MovingMuscles {
  MovingMuscles() {
    for (const test::Variant& v : test::variants()) {
      muscles.push_back(test::parameters_of(v, "TRIlong"));
      muscles.back().name += std::to_string(muscles.size());
    }
    for (const MuscleParameters& p : muscles) {
      const MusculotendonParameters<double>& m = p.musculotendon;
      input[0].push_back(0.7);
      input[1].push_back(0.5);
      input[2].push_back(1.05 * m.optimal_fiber_length);
      input[3].push_back(1.02 * m.tendon_slack_length + 1.05 * m.optimal_fiber_length * 0.97);
      input[4].push_back(0.05);
    }
  }
  std::vector<MuscleParameters> muscles;
  std::array<std::vector<double>, 5> input;  ///< as in MuscleInputs
};

using Rates = std::array<std::vector<double>, 3>;

Rates rates_of(const MuscleGroup<double>& group, const std::array<std::vector<double>, 5>& in) {
  Rates out;
  for (auto& values : out) values.resize(group.size());
  group.rates({in[0], in[1], in[2], in[3], in[4]}, {out[0], out[1], out[2]});
  return out;
}

TEST(MuscleGroupDerivatives, CarryTheValuesAndTheSlopesOfDifferences) {
  const MovingMuscles m;
  const MuscleGroup<double> group(m.muscles);
  const std::size_t n = group.size();
  std::vector<MusculotendonParameters<SimulationJet>> parameters;
  for (const MuscleParameters& p : m.muscles) parameters.push_back(p.musculotendon.cast<SimulationJet>());
  const MuscleGroup<SimulationJet> jets = group.with<SimulationJet>(parameters);
  std::array<std::vector<SimulationJet>, 5> in;
  std::array<std::vector<SimulationJet>, 3> out, flattened;
  for (std::size_t i = 0; i < 5; ++i) {
    for (const double value : m.input[i]) in[i].push_back(SimulationJet(value, static_cast<int>(i)));
  }
  for (std::size_t o = 0; o < 3; ++o) out[o].resize(n), flattened[o].resize(n);
  jets.rates({in[0], in[1], in[2], in[3], in[4]}, {out[0], out[1], out[2]});
  muscle_rates(jets, {in[0], in[1], in[2], in[3], in[4]}, {flattened[0], flattened[1], flattened[2]});
  const Rates value = rates_of(group, m.input);
  for (std::size_t i = 0; i < 5; ++i) {
    const auto difference = [&](double relative) {
      std::array<std::vector<double>, 5> up = m.input, down = m.input;
      for (std::size_t k = 0; k < n; ++k) {
        up[i][k] += relative * m.input[i][k];
        down[i][k] -= relative * m.input[i][k];
      }
      Rates by = rates_of(group, up);
      const Rates less = rates_of(group, down);
      for (std::size_t o = 0; o < 3; ++o)
        for (std::size_t k = 0; k < n; ++k) by[o][k] = (by[o][k] - less[o][k]) / (2.0 * relative * m.input[i][k]);
      return by;
    };
    const Rates coarse = difference(2e-5), fine = difference(1e-5);
    for (std::size_t o = 0; o < 3; ++o) {
      for (std::size_t k = 0; k < n; ++k) {
        SCOPED_TRACE(m.muscles[k].name + ", output " + std::to_string(o) + " by input " + std::to_string(i));
        EXPECT_NEAR(out[o][k].a, value[o][k], 1e-9 * (1.0 + std::abs(value[o][k])));
        const double expected = (4.0 * fine[o][k] - coarse[o][k]) / 3.0;
        EXPECT_NEAR(out[o][k].v(i), expected, 1e-5 * (1.0 + std::abs(expected)));
        EXPECT_EQ(flattened[o][k].v(i), out[o][k].v(i));
      }
    }
  }
}

}  // namespace
}  // namespace veridyn::muscle
