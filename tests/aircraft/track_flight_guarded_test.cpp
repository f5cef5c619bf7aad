#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>

#include "veridyn/aircraft/track_flight.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/recording/study_data.hpp"

// Tracker and guarded filter in one loop.
namespace veridyn::aircraft {
namespace {

constexpr const char* kGuarded = R"toml(seed = {}
[subject]
builtin = "unatrap"
[subject.model.stall]
form = "none"
[reconstruct]
sensors = "reference"
turbulence = "low_moderate"
[delays]
automatic = false
[flight]
duration = {}
airspeed = 20
altitude = 300
turbulence = "low_moderate"
{}
[track]
coefficients = ["CL", "CD", "CY"]
filter = "guarded"
{}
)toml";

FlightStudy guarded_study(const std::string& track = "", double duration = 150.0, int seed = 2,
                          const std::string& flight = "") {
  Progress silent;
  return read_study(Study::parse(fmt::format(kGuarded, seed, duration, flight, track), "test.toml"), silent);
}

/// The study's aircraft with all of CL, CD and CY times a factor, as what is trusted at the start.
void trust_at_start(FlightStudy& study, double factor) {
  study.filter_subject = study.subject;
  for (const Coefficient c : kForceCoefficients)
    for (double& v : study.filter_subject->model.at(c).values) v *= factor;
}

TrackedFilterError error_of(const FlightStudy& study, const TrackedFlight& flight, const std::string& quantity) {
  for (const TrackedFilterError& e : flight.filter().errors(*study.truth))
    if (e.quantity == quantity) return e;
  throw std::logic_error("no such quantity");
}

double mean_within(const Recording& r, const char* name, TimeSpan span) {
  const Channel& c = r.at(name);
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < c.size(); ++k) {
    if (c.times()[k] < span.begin || c.times()[k] > span.end) continue;
    sum += c.value[k];
    count += 1.0;
  }
  return sum / count;
}

double share_used(const TrackedFlight& flight, double from, double to) {
  return mean_within(flight.filter().recording(), "model_based", {from, to});
}

TEST(TrackGuarded, AWrongModelAtTheStartDoesNotSurvive) {
  Progress silent;
  FlightStudy study = guarded_study();
  trust_at_start(study, 0.5);
  const TrackedFlight flight = track_flight(study, silent).flight;
  const FilterHistory& filter = flight.filter();
  EXPECT_EQ(filter.models().front().source[0], ModelSource::kStudy);
  EXPECT_GE(filter.reverts() + (filter.model_free().front().begin < 3.0 ? 1 : 0), 1u) << "the wrong model was trusted";
  const FilterModel& last = filter.models().back();
  for (const ModelSource source : last.source) EXPECT_EQ(source, ModelSource::kTracked);
  const double lift = *last.aero->at(Coefficient::kCL).value_of("alpha");
  EXPECT_NEAR(lift, 3.607, 0.15) << "trusted at the start: 1.8";
  EXPECT_GT(share_used(flight, 120.0, 150.0), 0.9);
  for (const char* quantity : {"alpha", "beta", "airspeed"}) {
    const TrackedFilterError e = error_of(study, flight, quantity);
    EXPECT_LT(e.guarded, 1.02 * e.model_free) << quantity;
  }
  const TrackedFilterError alpha = error_of(study, flight, "alpha");
  EXPECT_LT(alpha.guarded, 0.95 * alpha.model_free) << "once it is right the model helps";
}

TEST(TrackGuarded, NoModelConfirmsItself) {
  Progress silent;
  FlightStudy study = guarded_study();
  trust_at_start(study, 1.5);
  const estimation::Estimate with_model = track_flight(study, silent).flight.tracker().estimate();
  study.track.filter = TrackFilter::kModelFree;
  const estimation::Estimate without = track_flight(study, silent).flight.tracker().estimate();
  ASSERT_EQ(with_model.parameters.size(), without.parameters.size());
  for (std::size_t i = 0; i < without.parameters.size(); ++i) {
    EXPECT_EQ(with_model.parameters[i].value, without.parameters[i].value) << without.parameters[i].name;
    EXPECT_EQ(with_model.parameters[i].sigma, without.parameters[i].sigma) << without.parameters[i].name;
  }
}

TEST(TrackGuarded, StartsFromNothingAndThenHasWhatItTracked) {
  Progress silent;
  const FlightStudy study = guarded_study("start_model = \"none\"\n");
  const TrackedFlight flight = track_flight(study, silent).flight;
  const FilterHistory& filter = flight.filter();
  ASSERT_GE(filter.models().size(), 2u);
  EXPECT_FALSE(filter.models().front().aero.has_value());
  EXPECT_EQ(share_used(flight, 0.0, 20.0), 0.0) << "the tracker takes 20 s to know its noise";
  EXPECT_EQ(filter.models().back().source[0], ModelSource::kTracked);
  EXPECT_GT(share_used(flight, 120.0, 150.0), 0.9);
  const TrackedFilterError alpha = error_of(study, flight, "alpha");
  EXPECT_LT(alpha.guarded, 0.95 * alpha.model_free);
}

TEST(TrackGuarded, FollowsAnAircraftThatLosesLift) {
  Progress silent;
  const FlightStudy study =
      guarded_study("", 150.0, 2, "[[flight.change]]\ntime = 75\nparameters = { CL_alpha = 2.6 }\n");
  const TrackedFlight flight = track_flight(study, silent).flight;
  EXPECT_GT(share_used(flight, 50.0, 75.0), 0.9);
  EXPECT_LT(share_used(flight, 78.0, 84.0), 0.1) << "the guard drops what no longer holds";
  const FilterModel& last = flight.filter().models().back();
  EXPECT_EQ(last.source[0], ModelSource::kTracked);
  EXPECT_NEAR(*last.aero->at(Coefficient::kCL).value_of("alpha"), 2.6, 0.2);
  EXPECT_GT(share_used(flight, 140.0, 150.0), 0.5);
  const TrackedFilterError alpha = error_of(study, flight, "alpha");
  EXPECT_LT(alpha.guarded, 1.02 * alpha.model_free);
}

TEST(TrackGuarded, ALogThatGrowsIsFilteredAsTheWhole) {
  Progress silent;
  const FlightStudy study = guarded_study();
  const TrackedFlight whole = track_flight(study, silent).flight;
  TrackedFlight live(study);
  MappedRecording part = study.mapped;
  for (const double end : {40.0, 41.0, 120.0}) {
    part.recording = recording::cut(study.mapped.recording, {0.0, end});
    (void)live.advance(part, study, false, silent);
  }
  (void)live.advance(study.mapped, study, true, silent);
  EXPECT_EQ(live.filter().time(), whole.filter().time());
  EXPECT_EQ(live.filter().models().back().source, whole.filter().models().back().source);
  const double of_live = error_of(study, live, "alpha").guarded, of_whole = error_of(study, whole, "alpha").guarded;
  EXPECT_NEAR(of_live, of_whole, 0.05 * of_whole);
}

TEST(TrackGuarded, NamesOptionsThatContradictEachOther) {
  const auto why = [](const std::string& more) {
    Progress silent;
    try {
      const FlightStudy study = guarded_study(more);
      (void)TrackedFlight(study);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(why(""), "");
  EXPECT_THAT(why("air_data = \"sensors\"\n"), ::testing::HasSubstr("contradicts air_data"));
  EXPECT_THAT(why("start_model = \"nothing\"\n"), ::testing::HasSubstr("track.start_model"));
  Progress silent;
  FlightStudy study = guarded_study();
  study.reconstruct.filter = FilterKind::kModelBased;
  EXPECT_THROW((void)TrackedFlight(study), InputError);
  study.reconstruct.filter = FilterKind::kModelFree;
  study.reconstruct.beta_bias = true;
  EXPECT_THROW((void)TrackedFlight(study), InputError);
}

// --- Faults of vane and pitot tube ----------------------------------------------------------------------------------

constexpr TimeSpan kFault{200.0, 230.0};

/// Changes a channel within the fault; `held` is its value at the beginning.
void spoil(Recording& recording, const char* name, const std::function<double(double value, double held)>& as) {
  Channel c = recording.at(name);
  double held = kNaN;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (c.times()[i] < kFault.begin || c.times()[i] > kFault.end) continue;
    if (std::isnan(held)) held = c.value[i];
    c.value[i] = as(c.value[i], held);
  }
  recording.set(std::move(c));
}

/// RMS against the truth over part of the flight [rad].
double rms_within(const Recording& estimate, const Recording& truth, const char* name, TimeSpan span) {
  const Channel &e = estimate.at(name), &t = truth.at(name);
  double sum = 0.0, count = 0.0;
  std::size_t j = 0;
  for (std::size_t i = 0; i < e.size(); ++i) {
    if (e.times()[i] < span.begin || e.times()[i] > span.end) continue;
    while (j + 1 < t.size() && t.times()[j + 1] <= e.times()[i] + 1e-9) ++j;
    sum += std::pow(e.value[i] - t.value[j], 2);
    count += 1.0;
  }
  return std::sqrt(sum / count);
}

struct SensorFault {
  const char* name;
  std::function<void(Recording&)> apply;
};

/// Model-free; guarded with the right model, fixed; guarded and tracked, from nothing and from 50 % off.
std::array<Recording, 4> filtered_in_four_ways(FlightStudy study) {
  Progress silent;
  ReconstructOptions o = study.reconstruct;
  std::array<Recording, 4> results;
  results[0] = reconstruct(study.mapped.recording, o, silent).filtered;
  o.filter = FilterKind::kGuarded;
  results[1] = reconstruct(study.mapped.recording, o, silent, &study.subject).filtered;
  study.track.starts_from_study = false;
  results[2] = track_flight(study, silent).flight.filter().recording();
  study.track.starts_from_study = true;
  trust_at_start(study, 0.5);
  results[3] = track_flight(study, silent).flight.filter().recording();
  return results;
}

// Writes guarded_tracking.md: the table of docs/tracking.md.
TEST(TrackGuardedSoak, ErrorsWithFaultsOfVaneAndPitotTube) {
  if (std::getenv("VERIDYN_SOAK") == nullptr) GTEST_SKIP() << "long-running test; set VERIDYN_SOAK=1 to run it";
  const auto held = [](double, double first) { return first; };
  const auto plus = [](double by) { return [by](double value, double) { return value + by; }; };
  const std::vector<SensorFault> faults{
      {"none", [](Recording&) {}},
      {"alpha vane frozen", [&](Recording& r) { spoil(r, "alpha", held); }},
      {"alpha vane + 3 deg", [&](Recording& r) { spoil(r, "alpha", plus(3.0 * kDegree)); }},
      {"beta vane frozen", [&](Recording& r) { spoil(r, "beta", held); }},
      {"beta vane + 3 deg", [&](Recording& r) { spoil(r, "beta", plus(3.0 * kDegree)); }},
      {"pitot tube frozen", [&](Recording& r) { spoil(r, "dynamic_pressure", held); }},
      {"pitot tube + 50 Pa", [&](Recording& r) { spoil(r, "dynamic_pressure", plus(50.0)); }}};
  constexpr int kSeeds = 4;
  constexpr std::array<TimeSpan, 3> kSpans{{{10.0, 300.0}, {200.0, 230.0}, {230.0, 260.0}}};
  constexpr std::array<const char*, 3> kSpanNames{"whole flight", "fault", "30 s after it"};
  std::string table =
      "| fault | over | model-free | right model, fixed | tracked, from nothing | tracked, from 50 % off |\n"
      "|---|---|---|---|---|---|\n";
  for (const SensorFault& fault : faults) {
    std::array<std::array<std::array<double, 2>, 4>, 3> square{};  // span, way, alpha and beta
    std::array<double, 4> used{};
    for (int seed = 1; seed <= kSeeds; ++seed) {
      FlightStudy study = guarded_study("", 300.0, seed);
      fault.apply(study.mapped.recording);
      const std::array<Recording, 4> results = filtered_in_four_ways(study);
      for (std::size_t w = 0; w < results.size(); ++w) {
        for (const char* name : {"airspeed", "alpha", "beta"})
          for (const double v : results[w].at(name).value) ASSERT_TRUE(std::isfinite(v)) << fault.name << ' ' << name;
        for (std::size_t k = 0; k < kSpans.size(); ++k) {
          square[k][w][0] += std::pow(rms_within(results[w], *study.truth, "alpha", kSpans[k]), 2);
          square[k][w][1] += std::pow(rms_within(results[w], *study.truth, "beta", kSpans[k]), 2);
        }
        if (w > 0) used[w] += mean_within(results[w], "model_based", kFault) / kSeeds;
      }
    }
    for (std::size_t k = 0; k < kSpans.size(); ++k) {
      table += fmt::format("| {} | {} |", k == 0 ? fault.name : "", kSpanNames[k]);
      for (std::size_t w = 0; w < 4; ++w) {
        const auto rms = [&](std::size_t q) { return std::sqrt(square[k][w][q] / kSeeds) / kDegree; };
        table += fmt::format(" {:.2f} / {:.2f}", rms(0), rms(1));
        if (k == 1 && w > 0) table += fmt::format(" ({:.0f} %)", 100.0 * used[w]);
        table += " |";
      }
      table += "\n";
    }
    // Without a fault the model helps, whatever was trusted at the start.
    if (std::string_view(fault.name) != "none") continue;
    for (std::size_t w = 1; w < 4; ++w) EXPECT_LT(square[1][w][0], square[1][0][0]) << w;
  }
  std::ofstream("guarded_tracking.md") << table;
}

}  // namespace
}  // namespace veridyn::aircraft
