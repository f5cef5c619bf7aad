#include "veridyn/muscle/simulation/system_stepper.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

/// The built-in arm, of whose layout only which states are fibre lengths matters here.
MusculoskeletalSystem stepped_arm(bool rigid) {
  Model model = load_model("arm").model();
  for (Muscle& muscle : model.muscles) muscle.parameters.rigid_tendon = rigid;
  return MusculoskeletalSystem(std::move(model));
}

/// All states decay with a rate of 1/s but the fibres, which are a thousand times as fast where they are stiff. An
/// implicit stage has to be solved: x = base - step rate x.
class Decay {
 public:
  Decay(const MusculoskeletalSystem& system, double stiff) : rate_(system.layout().size, 1.0) {
    for (const int l : system.layout().fiber_length)
      if (l >= 0) rate_[l] = stiff;
  }
  bool operator()(double, double step, double* x, double* rate) {
    implicit_ = implicit_ || step > 0.0;
    for (std::size_t i = 0; i < rate_.size(); ++i) {
      if (step > 0.0 && rate_[i] > 1.0) x[i] /= 1.0 + step * rate_[i];
      rate[i] = -rate_[i] * x[i];
    }
    return true;
  }
  [[nodiscard]] double exact(std::size_t i, double t) const { return std::exp(-rate_[i] * t); }
  [[nodiscard]] bool implicit() const { return implicit_; }

 private:
  std::vector<double> rate_;
  bool implicit_ = false;
};

/// Largest error at the end of a second of all states, which began at 1, and the steps that it took.
std::pair<double, long> decayed(const MusculoskeletalSystem& system, Decay& decay, double tolerance) {
  SystemStepper stepper(system, {.tolerance = tolerance});
  std::vector<double> x(system.layout().size, 1.0), between(x.size());
  double t = 0.0, worst = 0.0;
  const auto end = stepper.advance(
      [&](double time, double step, double* at, double* rate) { return decay(time, step, at, rate); }, t, x.data(), 1.0,
      [&](double from, double to) {
        const double middle = 0.5 * (from + to);
        stepper.interpolate(middle, between.data());
        worst = std::max(worst, std::abs(between[0] - decay.exact(0, middle)));
        return true;
      });
  EXPECT_EQ(end, numerics::IntegrationEnd::kReached);
  EXPECT_EQ(t, 1.0);
  for (std::size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(x[i] - decay.exact(i, 1.0)));
  return {worst, stepper.steps()};
}

TEST(SystemStepper, WithoutFibreStatesIsExplicitAndAsExactAsAsked) {
  const MusculoskeletalSystem arm = stepped_arm(true);
  Decay decay(arm, 1.0);
  const auto [coarse, few] = decayed(arm, decay, 1e-4);
  const auto [fine, many] = decayed(arm, decay, 1e-8);
  EXPECT_FALSE(decay.implicit());
  EXPECT_LT(coarse, 1e-3);
  EXPECT_LT(fine, 1e-7);
  EXPECT_LT(few, many);
}

TEST(SystemStepper, StepsStiffFibresImplicitlyOverManyOfTheirTimeConstants) {
  const MusculoskeletalSystem arm = stepped_arm(false);
  Decay decay(arm, 1000.0);
  const auto [error, steps] = decayed(arm, decay, 1e-5);
  EXPECT_TRUE(decay.implicit());
  EXPECT_LT(error, 1e-3);
  // An explicit method stays below three time constants of the fibres a step: 300 steps at least.
  EXPECT_LT(steps, 200);
}

TEST(SystemStepper, StopsWhereItIsToldTo) {
  const MusculoskeletalSystem arm = stepped_arm(true);
  Decay decay(arm, 1.0);
  SystemStepper stepper(arm, {.tolerance = 1e-6});
  std::vector<double> x(arm.layout().size, 1.0);
  double t = 0.0;
  const auto end =
      stepper.advance([&](double time, double step, double* at, double* rate) { return decay(time, step, at, rate); },
                      t, x.data(), 1.0, [](double, double) { return false; });
  EXPECT_EQ(end, numerics::IntegrationEnd::kReached);  // as far as it was let
  EXPECT_GT(t, 0.0);
  EXPECT_LT(t, 1.0);
  EXPECT_NEAR(x[0], std::exp(-t), 1e-5);
}

}  // namespace
}  // namespace veridyn::muscle
