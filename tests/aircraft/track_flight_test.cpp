#include "veridyn/aircraft/track_flight.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/recording/study_data.hpp"

namespace veridyn::aircraft {
namespace {

constexpr const char* kStudy = R"toml(seed = 1
[subject]
builtin = "unatrap"
[flight]
duration = 150
airspeed = 20
[[flight.change]]
time = 110
parameters = { Cm_alpha = -0.35 }
[[flight.manoeuvre]]
kind = "multisine"
start = 0
duration = 75
surfaces = ["elevator"]
[[flight.manoeuvre]]
kind = "multisine"
start = 75
duration = 75
surfaces = ["elevator"]
[reconstruct]
sensors = "reference"
turbulence = "none"
[delays]
automatic = false
[track]
coefficients = ["Cm", "CL"]
detection_learning = "30 s"
)toml";

FlightStudy flown_study(const std::string& more = "") {
  Progress silent;
  return read_study(Study::parse(std::string(kStudy) + more, "test.toml"), silent);
}

const TrackedCoefficient& of(const TrackedFlight& flight, Coefficient c) {
  for (const TrackedCoefficient& tracked : flight.tracker().coefficients()) {
    if (tracked.model.coefficient == c) return tracked;
  }
  throw std::logic_error("not tracked");
}

double value_of(const TrackedFlight& flight, const std::string& name) {
  return flight.tracker().estimate().find(name)->value;
}

TEST(TrackFlight, FollowsAnAircraftThatChangesAndSaysWhen) {
  Progress silent;
  FlightStudy study = flown_study();
  const TrackingAnalysis analysis = track_flight(study, silent);
  EXPECT_EQ(analysis.flight.air_data(), AirDataSource::kFilter);
  // Within four standard errors, and these are small.
  for (const auto& [name, truth] : {std::pair{"Cm_alpha", -0.35}, {"Cm_de", 1.0}, {"CL_alpha", 3.607}}) {
    const double sigma = analysis.flight.tracker().estimate().find(name)->sigma;
    EXPECT_NEAR(value_of(analysis.flight, name), truth, 4.0 * sigma) << name;
    EXPECT_LT(sigma, 0.1 * std::abs(truth)) << name;
  }
  std::vector<double> seen;
  for (const FlightChange& c : analysis.flight.tracker().changes()) {
    EXPECT_EQ(c.coefficient, Coefficient::kCm) << c.change.detected_s;
    seen.push_back(c.change.detected_s);
  }
  ASSERT_FALSE(seen.empty());
  EXPECT_NEAR(seen[0], 110.0, 5.0);
  const Recording history = history_recording(analysis.flight.tracker());
  EXPECT_NE(history.find("Cm_alpha"), nullptr);
  EXPECT_NE(history.find("lambda_Cm"), nullptr);
}

TEST(TrackFlight, ALogThatGrowsGivesWhatTheWholeLogGives) {
  Progress silent;
  FlightStudy study = flown_study();
  const TrackingAnalysis whole = track_flight(study, silent);
  TrackedFlight live(study);
  MappedRecording part = study.mapped;
  for (const double end : {3.0, 3.2, 10.0, 31.0, 31.5, 77.7, 112.3, 112.4, 140.0}) {
    part.recording = recording::cut(study.mapped.recording, {0.0, end});
    (void)live.advance(part, study, false, silent);
  }
  (void)live.advance(study.mapped, study, true, silent);
  EXPECT_EQ(live.tracker().rows(), whole.flight.tracker().rows());
  for (const char* name : {"Cm_alpha", "Cm_q", "Cm_de", "CL_alpha"}) {
    // Not to the last digit: W is averaged over what had been read, and the state estimate starts again in each window.
    const double sigma = whole.flight.tracker().estimate().find(name)->sigma;
    EXPECT_NEAR(value_of(live, name), value_of(whole.flight, name), sigma) << name;
  }
}

TEST(TrackFlight, SurvivesAGapOfTenSeconds) {
  Progress silent;
  FlightStudy study = flown_study();
  const TrackingAnalysis whole = track_flight(study, silent);
  FlightStudy gapped = flown_study();
  Recording with_gap;
  with_gap.source = study.mapped.recording.source;
  with_gap.frame = study.mapped.recording.frame;
  for (const Channel& c : study.mapped.recording.channels()) {
    std::vector<double> time, value;
    for (std::size_t i = 0; i < c.size(); ++i) {
      if (c.times()[i] > 60.0 && c.times()[i] < 70.0) continue;
      time.push_back(c.times()[i]);
      value.push_back(c.value[i]);
    }
    Channel rest{c.name, c.unit, c.recorded_unit, make_time_base(std::move(time)), std::move(value)};
    with_gap.add(std::move(rest));
  }
  gapped.mapped.recording = std::move(with_gap);
  const TrackingAnalysis analysis = track_flight(gapped, silent);
  const auto missing = static_cast<double>(whole.flight.tracker().rows() - analysis.flight.tracker().rows());
  EXPECT_NEAR(missing / analysis.flight.tracker().row_rate_Hz(), 10.0, 1.5);
  const double sigma = analysis.flight.tracker().estimate().find("Cm_alpha")->sigma;
  EXPECT_NEAR(value_of(analysis.flight, "Cm_alpha"), -0.35, 4.0 * sigma);
  EXPECT_LT(sigma, 0.05);
  for (const FlightChange& c : analysis.flight.tracker().changes())
    EXPECT_GT(c.change.detected_s, 105.0) << "the gap is no change";
}

TEST(TrackFlight, StartsFromAnEstimate) {
  Progress silent;
  FlightStudy study = flown_study();
  const TrackingAnalysis first = track_flight(study, silent);
  EXPECT_EQ(of(first.flight, Coefficient::kCm).start, "no estimate");
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "estimate.json";
  write_file(path, io::to_json(first.flight.tracker().estimate()));
  FlightStudy again = flown_study();
  again.track.estimate_file = path.string();
  const TrackingAnalysis second = track_flight(again, silent);
  EXPECT_EQ(of(second.flight, Coefficient::kCm).start, "batch estimate");
  // It knows Cm_alpha within a second, where a flight that starts from nothing does not: the change in the flight
  // behind the estimate left it error bars by which the first rows still hold a direction.
  const auto sigma_after_a_second = [](const TrackedFlight& flight) {
    return of(flight, Coefficient::kCm).tracker->history().sigma[1].at(5);
  };
  EXPECT_LT(sigma_after_a_second(second.flight), 0.3 * sigma_after_a_second(first.flight));
}

}  // namespace
}  // namespace veridyn::aircraft
