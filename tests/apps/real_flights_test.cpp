// veridyn on recordings of others: what it may not believe of them. They are not part of the project.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/io/results/estimate_json.hpp"

namespace veridyn {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

using RealFlights = ProgramTest;

/// What the program says of a study of a real flight, and the estimate.
struct RealFlight {
  Outcome said;
  estimation::Estimate estimate;
};
RealFlight identified_real(const std::string& study, const fs::path& out) {
  RealFlight flight;
  flight.said =
      run("identify " + (test::source_folder() / "examples/studies/real" / study).string() + " --out " + out.string());
  EXPECT_EQ(flight.said.exit_code, 0) << flight.said.text;
  if (flight.said.exit_code == 0) flight.estimate = io::read_estimate(out / "estimate.json");
  return flight;
}

// The Thor flight is closed loop in strong wind, without manoeuvres made for identification: the published derivatives
// of lift, drag and moments are not recovered from it by anyone's regression, and the tool has to say so. CY_beta
// is, within its interval.
TEST_F(RealFlights, RejectsTheThorFlight) {
  if (!fs::exists(test::shared_folder() / "data/flight/umn_thor/thor_flight75_airborne.csv"))
    GTEST_SKIP() << "the recordings beside the repository are missing";
  const RealFlight thor = identified_real("thor.toml", folder_ / "out");
  ASSERT_FALSE(thor.estimate.parameters.empty());
  constexpr double kPublishedCYBeta = -0.4889;  // built-in subject "thor"
  for (const auto& p : thor.estimate.parameters) {
    if (p.status != estimation::ParameterStatus::kIdentified) continue;
    EXPECT_EQ(p.name, "CY_beta") << p.value;
    EXPECT_LE(p.low95, kPublishedCYBeta);
    EXPECT_GE(p.high95, kPublishedCYBeta);
  }
  EXPECT_NE(thor.estimate.judgement.parameters.grade, estimation::Grade::kYes);
}

// Neither accelerometer nor vanes, and a pitot tube that fails for seconds: the moments are regressed, and rejected.
TEST_F(RealFlights, RejectsTheProtoFlight) {
  if (!fs::exists(test::shared_folder() / "data/flight/px4/proto_flt09"))
    GTEST_SKIP() << "the recordings beside the repository are missing";
  const RealFlight proto = identified_real("proto.toml", folder_ / "out");
  EXPECT_EQ(proto.estimate.parameters.size(), 12U);
  for (const auto& p : proto.estimate.parameters)
    EXPECT_EQ(p.status, estimation::ParameterStatus::kRejected) << p.name << " = " << p.value;
  EXPECT_THAT(proto.estimate.warnings, ::testing::Contains(HasSubstr("as of a stall or a blocked pitot tube")));
  const auto scale =
      std::ranges::find(proto.estimate.evidence, estimation::Check::kAirspeedScale, &estimation::Evidence::check);
  ASSERT_NE(scale, proto.estimate.evidence.end());
  EXPECT_NEAR(scale->value, 1.0, 0.005) << "by the headings flown";
}

// Every real flight log is read, or refused in one sentence.
TEST_F(RealFlights, InspectsEveryRealLogOrSaysWhyNot) {
  const fs::path logs = test::shared_folder() / "data/flight";
  if (!fs::exists(logs)) GTEST_SKIP() << "the recordings beside the repository are missing";
  std::size_t read = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(logs)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".bin" && extension != ".BIN" && extension != ".log" && extension != ".ulg" && extension != ".mat")
      continue;
    const Outcome outcome = run("inspect \"" + entry.path().string() + "\"");
    EXPECT_EQ(outcome.exit_code, 0) << entry.path() << outcome.text.substr(0, 300);
    ++read;
  }
  EXPECT_GE(read, 8u);
}

}  // namespace
}  // namespace veridyn
