#include "veridyn/aircraft/reconstruction/reconstruct_options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;

TEST(ReconstructOptions, ReadsEveryKeyAndRefusesWrongOnes) {
  const auto read = [](const char* text) {
    const Study study = Study::parse(text, "study.toml");
    const StudyTable table = study.root().table("reconstruct");
    const ReconstructOptions o = ReconstructOptions::keys().read(table);
    study.root().finish();
    return o;
  };
  const ReconstructOptions o = read(R"([reconstruct]
rate = "50 Hz"
sensors = "reference"
turbulence = "medium_light"
turbulence_scale = 1.5
estimate = ["alpha_bias", "pitot_scale"]
without = ["beta"]
airspeed_is = "equivalent"
beta_vane = "flank"
vane_position = [0.5, 0.0, -0.1]
wind_walk = 0.05
wind_down_walk = 0.02
initial_wind = "8 m/s"
initial_wind_down = "1 m/s"
min_airspeed = "5 m/s"
max_gap = "200 ms"
gate = 4.0
gate_recovery = "1 s"
dead_reckoning = "20 s"
[reconstruct.sigma]
alpha = "0.8 deg"
dynamic_pressure = 12.0
[reconstruct.delay]
velocity = "0.2 s"
)");
  EXPECT_EQ(o.rate_Hz, 50.0);
  EXPECT_EQ(o.turbulence.value().name, "medium_light");
  EXPECT_DOUBLE_EQ(o.gate.dead_reckoning_s, 20.0);
  EXPECT_TRUE(o.alpha_bias && o.pitot_scale && !o.beta_bias && !o.use_beta && o.use_alpha);
  EXPECT_TRUE(!o.airspeed_is_true && o.beta_is_flank);
  EXPECT_EQ(o.vane_position.x(), 0.5);
  EXPECT_NEAR(o.sigma.alpha.value_or(0.0), 0.8 * kDegree, 1e-12);
  EXPECT_EQ(o.max_gap, 0.2);
  EXPECT_EQ(o.delay.velocity, 0.2);
  const auto message = [&](const char* text) -> std::string {
    try {
      static_cast<void>(read(text));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(message("[reconstruct]\nturbulense = \"auto\"\n"), HasSubstr("turbulence"));
  EXPECT_THAT(message("[reconstruct]\nestimate = [\"alfa_bias\"]\n"), HasSubstr("alpha_bias"));
  EXPECT_THAT(message("[reconstruct]\nmax_gap = \"-1 s\"\n"), HasSubstr("max_gap"));
  EXPECT_THAT(message("[reconstruct]\nvane_position = [1, 2]\n"), HasSubstr("has 2 numbers, needs 3"));
  EXPECT_THAT(message("[reconstruct.sigma]\nalpha = \"2 Pa\"\n"), HasSubstr("rad"));
}

TEST(ReconstructOptions, LeaveTurbulenceAndNoiseToTheDataByDefault) {
  const Study study = Study::parse("[reconstruct]\n", "study.toml");
  const ReconstructOptions o = ReconstructOptions::keys().read(study.root().table("reconstruct"));
  EXPECT_FALSE(o.turbulence.has_value());
  EXPECT_EQ(o.sensors, NoiseSource::kMeasured);
}

TEST(ReconstructOptions, TakeASpectrumOfNumbersUnderTheNameStudy) {
  const Study study = Study::parse(
      "[reconstruct]\nturbulence = { Lu = 300, Lv = 200, Lw = 50, sigma_u = 2, sigma_v = 2, sigma_w = 1 }\n",
      "study.toml");
  const ReconstructOptions o = ReconstructOptions::keys().read(study.root().table("reconstruct"));
  ASSERT_TRUE(o.turbulence.has_value());
  EXPECT_EQ(o.turbulence->name, "study");
  EXPECT_EQ(o.turbulence->spectrum.Lu, 300.0);
}

}  // namespace
}  // namespace veridyn::aircraft
