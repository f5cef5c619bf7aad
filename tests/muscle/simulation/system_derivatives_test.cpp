// Systems with derivatives.
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

/// The state of an arm in motion whose fibres are off their equilibrium.
std::vector<double> moving_state(const MusculoskeletalSystem& system, SystemEvaluator<double>& evaluator) {
  const StateLayout& layout = system.layout();
  std::vector<double> x(layout.size, 0.0), activation(system.muscles().size(), 0.2);
  x[0] = 0.3;
  x[1] = 0.9;
  x[2] = 0.5;
  x[3] = -0.8;
  evaluator.set_motion(x.data(), x.data() + layout.free);
  evaluator.start_muscles(activation.data(), x.data());
  for (const int l : layout.fiber_length) x[l] *= 0.99;
  return x;
}

// Against differences of the evaluator in double precision, of steps h and h/2, extrapolated.
TEST(SystemDerivatives, OfTheStateAreThoseOfDifferences) {
  const MusculoskeletalSystem system(load_model("arm").model(), {.paths = PathSource::kFitted});
  SystemEvaluator<double> plain(system);
  SystemEvaluator<SimulationJet> jets(system);
  const std::vector<double> x = moving_state(system, plain);
  const std::vector<double> u(system.muscles().size(), 0.4);
  const std::size_t n = x.size();
  constexpr std::size_t kWidth = SimulationJet::DIMENSION;
  std::vector<double> rate(n), more(n), less(n);
  ASSERT_TRUE(plain.derivative(x.data(), {u, {}}, rate.data()));
  for (std::size_t first = 0; first < n; first += kWidth) {
    std::vector<SimulationJet> xj(x.begin(), x.end()), rj(n);
    for (std::size_t j = 0; j < kWidth && first + j < n; ++j) xj[first + j].v(j) = 1.0;
    ASSERT_TRUE(jets.derivative(xj.data(), {u, {}}, rj.data()));
    for (std::size_t j = 0; j < kWidth && first + j < n; ++j) {
      const auto difference = [&](double h) {
        std::vector<double> up = x, down = x, by(n);
        up[first + j] += h;
        down[first + j] -= h;
        EXPECT_TRUE(plain.derivative(up.data(), {u, {}}, more.data()));
        EXPECT_TRUE(plain.derivative(down.data(), {u, {}}, less.data()));
        for (std::size_t i = 0; i < n; ++i) by[i] = (more[i] - less[i]) / (2.0 * h);
        return by;
      };
      const std::vector<double> coarse = difference(2e-5), fine = difference(1e-5);
      double largest = 1.0;
      for (const double value : fine) largest = std::max(largest, std::abs(value));
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_NEAR(rj[i].a, rate[i], 1e-9 * (1.0 + std::abs(rate[i]))) << system.state_name(i);
        EXPECT_NEAR(rj[i].v(j), (4.0 * fine[i] - coarse[i]) / 3.0, 1e-6 * largest)
            << system.state_name(i) << " by " << system.state_name(first + j);
      }
    }
  }
}

// Equilibrium's derivative by implicit differentiation, against differences of solved equilibria.
TEST(SystemDerivatives, OfMusclesAtTheStartAreThoseOfDifferences) {
  const MusculoskeletalSystem system(load_model("arm").model(), {.paths = PathSource::kFitted});
  const StateLayout& layout = system.layout();
  const auto started = [&](double elbow) {
    SystemEvaluator<double> evaluator(system);
    std::vector<double> x(layout.size, 0.0), activation(system.muscles().size(), 0.2);
    x[0] = 0.3;
    x[1] = elbow;
    evaluator.set_motion(x.data(), x.data() + layout.free);
    evaluator.start_muscles(activation.data(), x.data());
    return x;
  };
  SystemEvaluator<SimulationJet> jets(system);
  std::vector<SimulationJet> xj(layout.size), activation(system.muscles().size(), SimulationJet(0.2));
  xj[0] = SimulationJet(0.3);
  xj[1] = SimulationJet(0.9, 0);
  jets.set_motion(xj.data(), xj.data() + layout.free);
  jets.start_muscles(activation.data(), xj.data());
  const double h = 1e-4;
  const std::vector<double> up = started(0.9 + h), down = started(0.9 - h);
  double largest = 0.0;
  for (const int l : layout.fiber_length) {
    const double expected = (up[l] - down[l]) / (2.0 * h);
    largest = std::max(largest, std::abs(expected));
    EXPECT_NEAR(xj[l].v(0), expected, 1e-7) << system.state_name(at(l));
  }
  EXPECT_GT(largest, 1e-3) << "the elbow's angle lengthens fibres";
}

}  // namespace
}  // namespace veridyn::muscle
