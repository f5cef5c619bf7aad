#include "veridyn/aircraft/simulation/simulate_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;

std::string simulate_message(std::string_view text) {
  const Study study = Study::parse(text, "s.toml");
  try {
    static_cast<void>(read_simulation(study.root()));
    study.root().finish();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

TEST(SimulateStudy, ReadsEveryKeyAndRefusesWrongOnes) {
  const std::string base = "[subject]\nbuiltin = \"unatrap\"\n";
  EXPECT_EQ(simulate_message(
                "seed = 4\n" + base +
                "[flight]\nduration = \"5 min\"\naltitude = 200\nground = 20\nairspeed = \"70 km/h\"\nheading = \"90 "
                "deg\"\nstep = 0.0025\ntruth_rate = 50\ngravity = 9.81\nwind = [1, 2, 0]\nwind_shear = "
                "0.14\nwind_shear_reference = 10\nwind_drift = 0.1\nwind_drift_time = 60\nturbulence = "
                "\"low_light\"\ngust_gradients = true\nlog_commands = true\nlost_rows = 0.2\nexcitation_gain = "
                "0.5\nplan = \"none\"\n[[flight.manoeuvre]]\nkind = "
                "\"multisine\"\nstart = 10\nduration = 20\nsurfaces = [\"elevator\", \"rudder\"]\namplitude = [\"2 "
                "deg\", \"3 deg\"]\nband = [0.1, 1.5]\n[[flight.manoeuvre]]\nkind = \"3211\"\nstart = "
                "40\nsurfaces = [\"aileron\"]\npulse = 0.3\n[[flight.manoeuvre]]\nkind = \"turn\"\nstart = "
                "50\nduration = 10\nbank = \"20 deg\"\n[sensors]\nset = \"perfect\"\n[sensors.gyro]\ntwo_sigma = "
                "\"1 deg/s\"\nbias = [0.1, 0, 0]\nrate = 50\ndelay = 0.02\njitter = 0.002\ntime_constant = "
                "0.01\n[sensors.alpha_vane]\nfrequency = 40\ndamping = 0.5\n[sensors.pitot]\nenabled = false\n"),
            "no error");
  EXPECT_THAT(simulate_message(base + "[flight]\nduration = 0\n"),
              HasSubstr("flight.duration: = 0 s must be above 0 and at most 86400 s"));
  EXPECT_THAT(simulate_message(base + "[flight]\nstep = 0.1\n"), HasSubstr("at most 0.02"));
  EXPECT_THAT(simulate_message(base + "[flight]\nwind = [1, 2]\n"), HasSubstr("has 2 numbers, needs 3"));
  EXPECT_THAT(simulate_message(base + "[flight]\naltitude = 10\nground = 10\n"),
              HasSubstr("is not below the altitude"));
  EXPECT_THAT(simulate_message(base + "[flight]\nspeed = 10\n"), HasSubstr("speed"));
  EXPECT_THAT(simulate_message(base + "[sensors.gyros]\nrate = 10\n"),
              HasSubstr("unknown sensor (did you mean 'gyro'?)"));
  EXPECT_THAT(simulate_message(base + "[sensors.gyro]\nsigma = \"1 m\"\n"), HasSubstr("sensors.gyro.sigma"));
  EXPECT_THAT(simulate_message(base + "[sensors.gyro]\nbias = [1, 2]\n"), HasSubstr("expected 1 or 3"));
  EXPECT_THAT(simulate_message(base + "[sensors.gyro]\ndropout = 1\n"), HasSubstr("must be at least 0 and below 1"));
  EXPECT_THAT(simulate_message(base + "[[flight.manoeuvre]]\nkind = \"loop\"\nstart = 1\n"), HasSubstr("kind"));
  EXPECT_THAT(
      simulate_message(base + "[[flight.manoeuvre]]\nkind = \"doublet\"\nstart = 1\nsurfaces = [\"elevater\"]\n"),
      HasSubstr("did you mean 'elevator'?"));
  EXPECT_THAT(simulate_message("[flight]\nduration = 3\n"), HasSubstr("subject"));
}

}  // namespace
}  // namespace veridyn::aircraft
