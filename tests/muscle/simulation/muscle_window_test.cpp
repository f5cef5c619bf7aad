#include "veridyn/muscle/simulation/muscle_window.hpp"

#include <gtest/gtest.h>

#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {
namespace {

TEST(MuscleWindow, TheExcitationItFindsEndsAtTheDesiredForce) {
  const MusculoskeletalSystem system(load_model("arm").model());
  SystemEvaluator<double> evaluator(system);
  std::vector<double> x(system.layout().size, 0.0), a(6, 0.1);
  x[1] = 0.8;
  evaluator.set_motion(x.data(), x.data() + 2);
  evaluator.start_muscles(a.data(), x.data());
  MuscleWindow window(system.muscles());
  std::array<std::vector<double>, MuscleWindow::kNodes> lengths;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    lengths[k].assign(evaluator.path_length().begin(), evaluator.path_length().end());
    for (double& l : lengths[k]) l += 1e-4 * static_cast<double>(k);
  }
  window.set_paths(0.01, lengths);
  window.set_states(evaluator.activation(), evaluator.fiber_length());
  const std::vector<double> low(6, 0.02), high(6, 1.0);
  std::vector<double> force_low(6), force_high(6), desired(6), u(6), reached(6);
  ASSERT_TRUE(window.end_forces(low, 1e-8, force_low));
  ASSERT_TRUE(window.end_forces(high, 1e-8, force_high));
  for (std::size_t m = 0; m < 6; ++m) {
    EXPECT_GT(force_high[m], force_low[m]);
    desired[m] = force_low[m] + (0.1 + 0.15 * static_cast<double>(m)) * (force_high[m] - force_low[m]);
  }
  ASSERT_TRUE(window.find_excitations(low, high, force_low, force_high, desired, 1e-8, u));
  ASSERT_TRUE(window.end_forces(u, 1e-8, reached));
  for (std::size_t m = 0; m < 6; ++m) EXPECT_NEAR(reached[m], desired[m], 2e-6 * (force_high[m] - force_low[m]));
}

}  // namespace
}  // namespace veridyn::muscle
