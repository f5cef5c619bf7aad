#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "tests/support/refusal.hpp"
#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/aircraft/simulation/simulation.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/tables/csv.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;

/// A folder with short flights of UnATRaP, one of them sampled at half the rate of the others.
class ReadFlights : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    // Of this process alone: tests run side by side.
    folder = std::filesystem::temp_directory_path() / fmt::format("veridyn_read_flights_{}", ::getpid());
    std::filesystem::create_directories(folder);
    for (int k = 1; k <= 3; ++k) {
      Progress silent;
      const FlightStudy flown = read_study(
          Study::parse(fmt::format("seed = {}\n[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 100\nairspeed = "
                                   "20\nturbulence = \"none\"\nwind = [{}, 0, 0]\n[sensors.gyro]\nrate = {}\n",
                                   k, k, k == 3 ? 50 : 100),
                       "flown.toml"),
          silent);
      write_file(folder / fmt::format("flight{}.csv", k), io::to_csv(flown.mapped.recording));
    }
    write_file(
        folder / "taxi.csv", "time,gyro_x[rad/s],gyro_y[rad/s],gyro_z[rad/s],airspeed[m/s]\n" + [] {
          std::string rows;
          for (int i = 0; i < 2000; ++i) rows += fmt::format("{},0.01,0.01,{},3\n", 0.01 * i, 0.001 * (i % 7));
          return rows;
        }());
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder); }
  static std::vector<FlightStudy> read(const std::string& data, const std::string& more = {}) {
    Progress silent;
    return read_flights(study(data, more), silent);
  }
  static Study study(const std::string& data, const std::string& more = {}) {
    return Study::parse(
        "[subject]\nbuiltin = \"unatrap\"\n[reconstruct]\nsensors = \"reference\"\nturbulence = "
        "\"none\"\n[uncertainty]\nenabled = false\n" +
            more + "[data]\n" + data,
        "set.toml", folder);
  }
  static inline std::filesystem::path folder;
};

TEST_F(ReadFlights, GivesAStudyAFlightOfOneRate) {
  const std::vector<FlightStudy> flights =
      read("runs = ['flight1.csv', 'flight2.csv']\n[[data.run]]\nfile = 'flight3.csv'\nlongitudinal = [10, 30]\n");
  ASSERT_EQ(flights.size(), 3u);
  EXPECT_EQ(flights[0].run, "flight1.csv");
  EXPECT_EQ(flights[2].run, "flight3.csv");
  EXPECT_EQ(flights[0].inputs, (std::vector<std::filesystem::path>{folder / "flight1.csv"}));
  for (const FlightStudy& flight : flights) EXPECT_EQ(flight.signals.rate_Hz, 50.0) << "the slowest gyro's";
  EXPECT_TRUE(flights[0].segments.longitudinal.empty());
  EXPECT_EQ(flights[2].segments.longitudinal.size(), 1u);
  EXPECT_NE(flights[0].mapped.recording.at("gyro_x").value, flights[1].mapped.recording.at("gyro_x").value);
}

TEST_F(ReadFlights, HoldsOutWholeFlightsByName) {
  const std::vector<FlightStudy> flights = read("runs = ['flight1.csv']\nholdout_runs = ['flight2.csv']\n");
  ASSERT_EQ(flights.size(), 2u);
  EXPECT_FALSE(flights[0].held_out);
  EXPECT_TRUE(flights[1].held_out);
  EXPECT_EQ(flights[0].segments.holdout, 0.0) << "all of it is for identification";
  Progress silent;
  const FlightAnalysis analysis = identify(flights, silent);
  ASSERT_EQ(analysis.estimate.recordings.size(), 2u);
  EXPECT_EQ(analysis.estimate.recordings[0].use, "identification");
  EXPECT_EQ(analysis.estimate.recordings[1].use, "hold-out");
  EXPECT_TRUE(analysis.estimate.recordings[0].validation.empty());
  EXPECT_TRUE(analysis.estimate.recordings[1].validation.contains("CL"));
  EXPECT_TRUE(analysis.flights[0].segments.longitudinal.holdout.empty());
  EXPECT_TRUE(analysis.flights[1].segments.longitudinal.identification.empty());
  // Each in its own wind.
  EXPECT_NEAR(analysis.flights[0].reconstruction.smoothed.at("wind_north").value.back(), 1.0, 0.5);
  EXPECT_NEAR(analysis.flights[1].reconstruction.smoothed.at("wind_north").value.back(), 2.0, 0.5);
}

TEST_F(ReadFlights, RefusesByFileAndKey) {
  const auto refusal = [](const std::string& data, const std::string& more = {}) {
    return why([&] {
      Progress silent;
      static_cast<void>(identify(read(data, more), silent));
    });
  };
  EXPECT_THAT(refusal("runs = ['flight1.csv', 'none.csv']\n"), HasSubstr("none.csv"));
  EXPECT_THAT(refusal("runs = ['flight1.csv', 'taxi.csv']\n"), HasSubstr("taxi.csv: the aircraft never flies"));
  EXPECT_THAT(refusal("runs = ['flight1.csv', 'flight2.csv']\n", "[segments]\nlongitudinal = [10, 20]\n"),
              HasSubstr("segments.longitudinal: gives times of one recording"));
  EXPECT_THAT(refusal("runs = ['flight1.csv', 'flight2.csv']\n[data.map]\nalpha = 'nose'\n"), HasSubstr("flight1.csv"));
}

TEST_F(ReadFlights, IsForCommandsThatTakeSeveral) {
  const std::string message = why([] {
    Progress silent;
    static_cast<void>(read_study(study("runs = ['flight1.csv', 'flight2.csv']\n"), silent));
  });
  EXPECT_THAT(message, HasSubstr("data.runs: is for `identify` and `validate`: this needs one recording"));
}

}  // namespace
}  // namespace veridyn::aircraft
