#include "veridyn/aircraft/reconstruction/reconstruct.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/aircraft/reconstruction/reconstruct_flight.hpp"
#include "tests/aircraft/stripped_recording.hpp"
#include "veridyn/aircraft/reconstruction/information_bound.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::without;

using testing::errors_of;
using testing::FlightCase;
using ::testing::HasSubstr;
using testing::MadeFlight;
using testing::make_flight;

ReconstructOptions known_sensors() {
  ReconstructOptions o;
  o.sensors = NoiseSource::kReference;
  o.turbulence = named_turbulence("low_moderate");
  return o;
}

Reconstruction run(const Recording& recording, const ReconstructOptions& options) {
  Progress quiet;
  return reconstruct(recording, options, quiet);
}

/// The recording without some channels.

const QuantityReport& quantity(const Reconstruction& r, const char* name) {
  return *std::find_if(r.quantities.begin(), r.quantities.end(), [&](const auto& q) { return q.quantity == name; });
}
const SensorReport& sensor(const Reconstruction& r, const char* name) {
  return *std::find_if(r.sensors.begin(), r.sensors.end(), [&](const auto& s) { return s.channel == name; });
}

// --- Against the information bound ----------------------------------------------------------------------------------

struct Campaign {
  double alpha_filter = 0, alpha_smoother = 0, beta_filter = 0, beta_smoother = 0;
  double worst_bias = 0, covered = 0, nis = 0;
};

Campaign fly(double speed, int seeds, double duration) {
  Campaign c;
  double intervals = 0, sensors = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const MadeFlight f = make_flight({.speed = speed, .duration = duration, .seed = static_cast<std::uint64_t>(seed)});
    const Reconstruction r = run(f.recording, known_sensors());
    const auto square = [](double x) { return x * x; };
    c.alpha_filter += square(errors_of(r.filtered, "alpha", f.alpha).rms) / seeds;
    c.beta_filter += square(errors_of(r.filtered, "beta", f.beta).rms) / seeds;
    c.alpha_smoother += square(errors_of(r.smoothed, "alpha", f.alpha).rms) / seeds;
    c.beta_smoother += square(errors_of(r.smoothed, "beta", f.beta).rms) / seeds;
    for (const Recording* which : {&r.filtered, &r.smoothed}) {
      c.worst_bias = std::max(c.worst_bias, std::abs(errors_of(*which, "airspeed", f.airspeed).bias));
      for (const auto& [name, truth] :
           {std::pair{"alpha", &f.alpha}, std::pair{"beta", &f.beta}, std::pair{"airspeed", &f.airspeed},
            std::pair{"wind_total_down", &f.wind_down}}) {
        c.covered += errors_of(*which, name, *truth).covered95;
        ++intervals;
      }
    }
    for (const SensorReport& s : r.sensors) {
      EXPECT_LT(s.innovations.rejected, s.innovations.count / 1000) << s.channel;
      c.nis += s.innovations.nis;
      ++sensors;
    }
  }
  c.covered /= intervals;
  c.nis /= sensors;
  for (double* x : {&c.alpha_filter, &c.alpha_smoother, &c.beta_filter, &c.beta_smoother}) *x = std::sqrt(*x);
  const InformationBound b = information_bound(gust_spectrum("low_moderate"), speed, 0.6 * kDegree, 100.0);
  std::printf(
      "  %g m/s, %d seeds, deg RMS (bound): alpha filter %.3f (%.3f), smoother %.3f (%.3f); beta filter %.3f (%.3f), "
      "smoother %.3f (%.3f); worst |Va bias| %.3f m/s; 95 %% bands cover %.1f %%; NIS %.3f\n",
      speed, seeds, c.alpha_filter / kDegree, b.alpha.filter / kDegree, c.alpha_smoother / kDegree,
      b.alpha.smoother / kDegree, c.beta_filter / kDegree, b.beta.filter / kDegree, c.beta_smoother / kDegree,
      b.beta.smoother / kDegree, c.worst_bias, 100.0 * c.covered, c.nis);
  // Specified: 1.2 times the bound. Reached: 1.03. The test keeps what was reached.
  EXPECT_LT(c.alpha_filter, 1.06 * b.alpha.filter);
  EXPECT_LT(c.alpha_smoother, 1.06 * b.alpha.smoother);
  EXPECT_LT(c.beta_filter, 1.06 * b.beta.filter);
  EXPECT_LT(c.beta_smoother, 1.06 * b.beta.smoother);
  EXPECT_GT(c.alpha_filter, 0.9 * b.alpha.filter) << "better than possible: the test itself would be wrong";
  EXPECT_LT(c.worst_bias, 0.2);
  EXPECT_GT(c.covered, 0.93);
  EXPECT_LT(c.covered, 0.97);
  EXPECT_NEAR(c.nis, 1.0, 0.02);
  return c;
}

TEST(Reconstruct, ReachesTheInformationBoundInModerateTurbulence) { fly(15.0, 2, 80.0); }

// The full campaign: half a minute of computing, so only where VERIDYN_SOAK is set (`make soak`).
class ReconstructSoak : public ::testing::TestWithParam<double> {};
TEST_P(ReconstructSoak, ReachesTheInformationBoundOverTenSeeds) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "long-running test; set VERIDYN_SOAK=1 to run it";
  fly(GetParam(), 10, 300.0);
}
INSTANTIATE_TEST_SUITE_P(Speeds, ReconstructSoak, ::testing::Values(15.0, 25.0));

TEST(Reconstruct, FindsTheTurbulenceAndTheNoiseByItself) {
  const MadeFlight f = make_flight({.duration = 80.0});
  const Reconstruction r = run(f.recording, {});
  EXPECT_NEAR(r.turbulence.sigma_w, 1.4, 0.45) << r.turbulence_origin;
  // Gusts change the vane's angle by some tenths of a degree from sample to sample, which counts as noise here.
  EXPECT_GT(r.sigma.alpha / kDegree, 0.58);
  EXPECT_LT(r.sigma.alpha / kDegree, 0.72);
  EXPECT_NEAR(r.sigma.dynamic_pressure, 10.0, 1.0);
  const InformationBound b = information_bound(gust_spectrum("low_moderate"), 15.0, 0.6 * kDegree, 100.0);
  EXPECT_LT(errors_of(r.smoothed, "alpha", f.alpha).rms, 1.2 * b.alpha.smoother);
  EXPECT_LT(errors_of(r.smoothed, "beta", f.beta).rms, 1.2 * b.beta.smoother);
}

TEST(Reconstruct, SmoothsBetterThanItFilters) {
  const MadeFlight f = make_flight({.duration = 60.0});
  const Reconstruction r = run(f.recording, known_sensors());
  EXPECT_LT(errors_of(r.smoothed, "airspeed", f.airspeed).rms, errors_of(r.filtered, "airspeed", f.airspeed).rms);
  EXPECT_LT(errors_of(r.smoothed, "wind_total_north", f.wind_north).rms, 0.3);
  const auto& s = r.smoothed.at("sigma_beta").value;
  const auto& p = r.filtered.at("sigma_beta").value;
  for (std::size_t i = 0; i < s.size(); i += 100) EXPECT_LE(s[i], p[i] * 1.0001);
}

// --- Fewer, worse and later sensors ---------------------------------------------------------------------------------

TEST(Reconstruct, WorksWithoutVanesAndReportsWhatIsThenUnknown) {
  const MadeFlight f = make_flight({.duration = 80.0});
  const Reconstruction r = run(without(f.recording, {"alpha", "beta"}), known_sensors());
  const auto beta = errors_of(r.smoothed, "beta", f.beta);
  EXPECT_GT(beta.rms, 3.0 * kDegree) << "lateral gusts of 2 m/s cannot be seen";
  EXPECT_GT(beta.covered95, 0.85);
  EXPECT_GT(errors_of(r.smoothed, "alpha", f.alpha).covered95, 0.85);
  EXPECT_LT(std::abs(errors_of(r.smoothed, "airspeed", f.airspeed).bias), 0.2);
  EXPECT_EQ(quantity(r, "airspeed").observability, Observability::kObservable);
  EXPECT_NE(quantity(r, "alpha").observability, Observability::kObservable);
  EXPECT_THAT(r.warnings, ::testing::Contains(HasSubstr("no beta vane")));
}

TEST(Reconstruct, WorksWithoutPitotAndWidensTheBandOfAirspeed) {
  const MadeFlight f = make_flight({.duration = 80.0});
  const Reconstruction with = run(f.recording, known_sensors());
  const Reconstruction r = run(without(f.recording, {"dynamic_pressure"}), known_sensors());
  EXPECT_GT(quantity(r, "airspeed").sigma, 3.0 * quantity(with, "airspeed").sigma);
  // The error changes over tens of seconds, so that one flight is few samples: within twice the sigma is all it shows.
  EXPECT_LT(errors_of(r.smoothed, "airspeed", f.airspeed).rms, 2.0 * quantity(r, "airspeed").sigma);
  EXPECT_LT(errors_of(r.smoothed, "alpha", f.alpha).rms, 0.6 * kDegree) << "the vanes still see the angles";
  EXPECT_THAT(r.warnings, ::testing::Contains(HasSubstr("no pitot tube")));
}

TEST(Reconstruct, CallsEverythingUnobservableWhenNothingFeelsTheAir) {
  const MadeFlight f = make_flight({.duration = 60.0});
  const Reconstruction r = run(without(f.recording, {"dynamic_pressure", "alpha", "beta"}), known_sensors());
  for (const char* name : {"airspeed", "alpha", "beta", "wind_north", "wind_east", "wind_down"}) {
    EXPECT_EQ(quantity(r, name).observability, Observability::kNotObservable) << name;
  }
  EXPECT_GT(errors_of(r.smoothed, "airspeed", f.airspeed).covered95, 0.9);
  EXPECT_THAT(r.warnings, ::testing::Contains(HasSubstr("neither pitot tube nor vanes")));
}

TEST(Reconstruct, DropsSpikes) {
  MadeFlight f = make_flight({.duration = 60.0});
  Recording bad = f.recording;
  numerics::RandomStream random(1, "spikes");
  std::size_t spikes = 0;
  for (const char* name : {"alpha", "beta", "dynamic_pressure", "vel_north", "roll"}) {
    Channel c = bad.at(name);
    for (std::size_t i = 10; i < c.size(); ++i) {
      if (random.uniform() < 0.01) {
        c.value[i] += name[0] == 'd' ? 500.0 : name[0] == 'v' ? 30.0 : 1.0;
        ++spikes;
      }
    }
    bad.set(c);
  }
  const Reconstruction clean = run(f.recording, known_sensors());
  const Reconstruction r = run(bad, known_sensors());
  std::size_t rejected = 0;
  for (const SensorReport& s : r.sensors) rejected += s.innovations.rejected;
  EXPECT_NEAR(static_cast<double>(rejected), static_cast<double>(spikes), 0.02 * static_cast<double>(spikes) + 3.0);
  EXPECT_LT(errors_of(r.smoothed, "alpha", f.alpha).rms, 1.05 * errors_of(clean.smoothed, "alpha", f.alpha).rms);
  EXPECT_LT(errors_of(r.smoothed, "airspeed", f.airspeed).rms,
            1.1 * errors_of(clean.smoothed, "airspeed", f.airspeed).rms);
}

TEST(Reconstruct, KeepsInnovationsInTheSensorsUnits) {
  const MadeFlight f = make_flight({.duration = 30.0});
  ReconstructOptions keep = known_sensors();
  keep.keep_innovations = true;
  const Reconstruction r = run(f.recording, keep);
  EXPECT_EQ(r.smoothed.at("alpha").value, run(f.recording, known_sensors()).smoothed.at("alpha").value);
  for (const SensorReport& s : r.sensors) {
    const auto& nu = r.innovations.at(s.channel).value;
    const auto& sigma = r.innovations.at("sigma_" + s.channel).value;
    const auto& refused = r.innovations.at("refused_" + s.channel).value;
    ASSERT_EQ(nu.size(), s.innovations.count) << s.channel;
    double sum = 0.0, squares = 0.0, expected = 0.0, used = 0.0;
    for (std::size_t i = 0; i < nu.size(); ++i) {
      if (refused[i] != 0.0) continue;
      ++used;
      sum += nu[i];
      squares += nu[i] * nu[i];
      expected += sigma[i] * sigma[i];
    }
    EXPECT_NEAR(s.innovations.mean_size, sum / used, 1e-12 * s.sigma);
    EXPECT_NEAR(s.innovations.rms_size, std::sqrt(squares / used), 1e-9 * s.sigma) << s.channel;
    EXPECT_NEAR(s.innovations.expected_size, std::sqrt(expected / used), 1e-9 * s.sigma) << s.channel;
    EXPECT_NEAR(s.innovations.rms_size / s.innovations.expected_size, 1.0, 0.1) << s.channel;
    EXPECT_GT(s.innovations.expected_size, s.sigma) << "the sensor's noise and what the filter did not know";
  }

  // A sample that is off by 10 deg, and one that is off by 0.3 deg, are seen off by just that.
  Recording off = f.recording;
  Channel vane = off.at("alpha");
  const std::size_t spike = vane.size() / 3, small = vane.size() / 2;
  vane.value[spike] += 10.0 * kDegree;
  vane.value[small] += 0.3 * kDegree;
  const double at_spike = vane.times()[spike];
  off.set(vane);
  const Reconstruction shifted = run(off, keep);
  const Channel& before = r.innovations.at("alpha");
  const Channel& after = shifted.innovations.at("alpha");
  const auto k = static_cast<std::size_t>(std::ranges::find(before.times(), at_spike) - before.times().begin());
  ASSERT_LT(k, before.size());
  EXPECT_NEAR(after.value[k] - before.value[k], 10.0 * kDegree, 1e-9);
  EXPECT_EQ(shifted.innovations.at("refused_alpha").value[k], 1.0);
  EXPECT_EQ(r.innovations.at("refused_alpha").value[k], 0.0);
  // The filter lost a sample at the spike, which is forgotten soon.
  EXPECT_NEAR(after.value[k + small - spike] - before.value[k + small - spike], 0.3 * kDegree, 0.01 * kDegree);
}

TEST(Reconstruct, EstimatesBiasesOfInertialSensors) {
  const MadeFlight f = make_flight({.duration = 120.0});
  Recording biased = f.recording;
  const auto shift = [&](const char* name, double scale, double bias) {
    Channel c = biased.at(name);
    for (double& v : c.value) v = scale * v + bias;
    biased.set(c);
  };
  shift("gyro_x", 1.0, 0.5 * kDegree);
  shift("accel_y", 1.0, 0.2);
  ReconstructOptions o = known_sensors();
  o.gyro_bias = o.accel_bias = true;
  const Reconstruction r = run(biased, o);
  const std::size_t last = r.smoothed.at("airspeed").size() - 1;
  const auto expect = [&](const char* name, double truth, double within) {
    const double value = r.smoothed.at(name).value[last];
    const double sigma = r.smoothed.at(std::string("sigma_") + name).value[last];
    EXPECT_NEAR(value, truth, 3.0 * sigma) << name;
    EXPECT_LT(sigma, within) << name;
  };
  expect("gyro_bias_x", 0.5 * kDegree, 0.05 * kDegree);
  expect("accel_bias_y", 0.2, 0.05);
}

TEST(Reconstruct, UsesEachSensorAtItsTimeStamps) {
  const MadeFlight f = make_flight({.duration = 60.0});
  Recording thin = without(f.recording, {"alpha", "beta", "dynamic_pressure", "roll", "pitch", "yaw"});
  const auto keep = [&](const char* name, std::size_t every, std::size_t from) {
    const Channel& c = f.recording.at(name);
    std::vector<double> t, v;
    for (std::size_t i = from; i < c.size(); i += every) {
      t.push_back(c.times()[i]);
      v.push_back(c.value[i]);
    }
    thin.add(make_channel(name, c.unit.name, make_time_base(t), v));
  };
  for (const char* name : {"roll", "pitch", "yaw"}) keep(name, 4, 1);
  keep("alpha", 2, 0);
  keep("beta", 7, 3);
  keep("dynamic_pressure", 10, 9);
  ReconstructOptions o = known_sensors();
  o.rate_Hz = 40.0;
  const Reconstruction r = run(thin, o);
  EXPECT_NEAR(r.smoothed.at("alpha").rate_Hz(), 40.0, 1e-6);
  const auto half = information_bound(gust_spectrum("low_moderate"), 15.0, 0.6 * kDegree, 50.0);
  EXPECT_LT(errors_of(r.smoothed, "alpha", f.alpha).rms, 1.25 * half.alpha.smoother);
  EXPECT_NEAR(errors_of(r.smoothed, "beta", f.beta).covered95, 0.95, 0.03);
  EXPECT_NEAR(sensor(r, "beta").innovations.nis, 1.0, 0.2);
}

TEST(Reconstruct, TakesOffDelays) {
  const MadeFlight f = make_flight({.duration = 60.0});
  Recording late = f.recording;
  for (const char* name : {"vel_north", "vel_east", "vel_down"}) {
    Channel c = late.at(name);
    std::vector<double> t(c.times().begin(), c.times().end());
    for (double& s : t) s += 0.25;
    c.time = make_time_base(t);
    late.set(c);
  }
  ReconstructOptions o = known_sensors();
  o.delay.velocity = 0.25;
  EXPECT_NEAR(sensor(run(late, o), "vel_east").innovations.nis, 1.0, 0.15);
  EXPECT_GT(sensor(run(late, known_sensors()), "vel_east").innovations.nis, 1.5) << "a delay does matter";
}

TEST(Reconstruct, KeepsALongGapAGap) {
  const MadeFlight f = make_flight({.duration = 60.0});
  Recording holed;
  holed.frame = Frame::kFrd;
  for (const Channel& c : f.recording.channels()) {
    std::vector<double> t, v;
    for (std::size_t i = 0; i < c.size(); ++i) {
      if (c.times()[i] > 25.0 && c.times()[i] < 31.0) continue;
      t.push_back(c.times()[i]);
      v.push_back(c.value[i]);
    }
    holed.add(make_channel(c.name, c.unit.name, make_time_base(t), v));
  }
  const Reconstruction r = run(holed, known_sensors());
  ASSERT_EQ(r.segments.size(), 2U);
  const Channel& alpha = r.smoothed.at("alpha");
  ASSERT_EQ(alpha.gaps(1.0).size(), 1U);
  EXPECT_NEAR(alpha.gaps(1.0)[0].begin, 25.0, 0.02);
  EXPECT_NEAR(alpha.gaps(1.0)[0].end, 31.0, 0.06);
  EXPECT_LT(errors_of(r.smoothed, "alpha", f.alpha, 32.0).rms, 0.5 * kDegree);
  EXPECT_THAT(r.warnings, ::testing::Contains(HasSubstr("2 parts")));
}

TEST(Reconstruct, GivesTheSameBytesTwice) {
  const MadeFlight f = make_flight({.duration = 30.0});
  const Reconstruction a = run(f.recording, {}), b = run(f.recording, {});
  for (const Channel& c : a.smoothed.channels()) EXPECT_EQ(c.value, b.smoothed.at(c.name).value) << c.name;
}

// --- Missing sensors ------------------------------------------------------------------------------------------------

// Flow angles and airspeed come from vanes and pitot tube; what is left out helps them little.
TEST(Reconstruct, KnowsTheAirWithoutMotionOverGroundHeadingOrAttitude) {
  const MadeFlight f = make_flight({.duration = 60.0});
  const double with_all = errors_of(run(f.recording, {}).smoothed, "alpha", f.alpha, 10.0).rms;
  const std::vector<std::vector<std::string>> steps{{"vel_north", "vel_east", "vel_down"},
                                                    {"vel_north", "vel_east", "vel_down", "yaw"},
                                                    {"yaw"},
                                                    {"roll", "pitch"},
                                                    {"roll", "pitch", "yaw"}};
  for (const std::vector<std::string>& missing : steps) {
    const Reconstruction r = run(without(f.recording, missing), {});
    ASSERT_FALSE(r.contradiction.has_value()) << missing.front();
    EXPECT_LT(errors_of(r.smoothed, "alpha", f.alpha, 10.0).rms, 1.5 * with_all) << missing.front();
    EXPECT_LT(errors_of(r.smoothed, "airspeed", f.airspeed, 10.0).rms, 0.5) << missing.front();
  }
}

TEST(Reconstruct, HasNoWindAndNoHeadingWhereNothingShowsThem) {
  const MadeFlight f = make_flight({.duration = 10.0});
  const Reconstruction r = run(without(f.recording, {"vel_north", "vel_east", "vel_down"}), {});
  for (const char* channel : {"wind_north", "wind_total_east", "wind_down", "vel_north"})
    EXPECT_FALSE(r.smoothed.has(channel)) << channel;
  EXPECT_TRUE(r.smoothed.has("yaw"));
  EXPECT_TRUE(r.smoothed.has("gust_x"));
  for (const QuantityReport& q : r.quantities) EXPECT_FALSE(q.quantity.starts_with("wind")) << q.quantity;
  EXPECT_THAT(r.warnings, ::testing::Contains(HasSubstr("no ground velocity")));
  const Reconstruction lost = run(without(f.recording, {"vel_north", "vel_east", "vel_down", "yaw"}), {});
  EXPECT_FALSE(lost.smoothed.has("yaw"));
}

// --- Bad input ------------------------------------------------------------------------------------------------------

std::string message_of(const Recording& recording) {
  try {
    static_cast<void>(run(recording, {}));
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Reconstruct, RefusesWhatItCannotUseInOneSentence) {
  const MadeFlight f = make_flight({.duration = 5.0});
  EXPECT_THAT(message_of(without(f.recording, {"gyro_y"})), HasSubstr("gyro_y"));
  EXPECT_THAT(message_of(without(f.recording, {"accel_x"})), HasSubstr("no accelerometer"));
  EXPECT_THAT(message_of(without(f.recording, {"roll", "vel_east"})), HasSubstr("neither attitude (roll, pitch) nor"));
  EXPECT_THAT(message_of(without(f.recording, {"vel_east", "dynamic_pressure"})),
              HasSubstr("neither ground velocity (vel_north, vel_east) nor airspeed"));
  EXPECT_THAT(message_of(without(f.recording, {"accel_x"})), HasSubstr("it has: ")) << "says what there is";
  Recording flu = f.recording;
  flu.frame = Frame::kFlu;
  EXPECT_THAT(message_of(flu), HasSubstr("frd"));
  Recording nan = f.recording;
  Channel roll = nan.at("roll");
  std::fill(roll.value.begin(), roll.value.end(), std::nan(""));
  nan.set(roll);
  EXPECT_EQ(message_of(nan), "") << "a roll that is never known is none";
  for (const char* north : {"vel_north", "vel_east"}) {
    Channel channel = nan.at(north);
    std::fill(channel.value.begin(), channel.value.end(), std::nan(""));
    nan.set(channel);
  }
  EXPECT_THAT(message_of(nan), HasSubstr("neither attitude (roll, pitch) nor"));
  EXPECT_THAT(message_of(make_flight({.duration = 0.5}).recording), HasSubstr("no second"));
}

}  // namespace
}  // namespace veridyn::aircraft
