#include "veridyn/aircraft/flight_sensitivity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/batches/block_store.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::ResponseIndices;
using ::testing::HasSubstr;

class FlightThreads : public Progress {
 public:
  explicit FlightThreads(int threads) : threads_(threads) {}
  [[nodiscard]] int threads() const override { return threads_; }

 private:
  int threads_;
};

/// An elevator doublet and an aileron doublet in calm air.
constexpr const char* kTwoDoublets = R"(
[subject]
builtin = "unatrap"
[flight]
duration = 16
airspeed = 20
step = 0.01
turbulence = "none"
[[flight.manoeuvre]]
kind = "doublet"
start = 2
surfaces = ["elevator"]
amplitude = "2 deg"
[[flight.manoeuvre]]
kind = "doublet"
start = 8
surfaces = ["aileron"]
amplitude = "3 deg"
[sensitivity]
longest = 3
index_samples = 64
)";
constexpr const char* kThreeInputs = R"(
[[sensitivity.input]]
parameter = "Cm_de"
[[sensitivity.input]]
parameter = "Cl_da"
[[sensitivity.input]]
parameter = "Jx"
)";

FlightSensitivityStudy read_varied(const std::string& text) {
  return read_flight_sensitivity(Study::parse(text, "study.toml").root());
}

ResponseIndices analyse_varied(const FlightSensitivityStudy& study, int threads = 2) {
  numerics::BlockStore store;
  FlightThreads progress(threads);
  return analyse_flight(study, store, progress);
}

const estimation::ResultIndices& indices_named(const ResponseIndices& r, const std::string& name) {
  const auto at = std::ranges::find_if(r.results, [&](const auto& one) { return one.result == name; });
  EXPECT_NE(at, r.results.end()) << name;
  return *at;
}

TEST(FlightSensitivity, SaysWhichManoeuvreTellsAboutWhat) {
  const ResponseIndices r = analyse_varied(read_varied(std::string(kTwoDoublets) + kThreeInputs));
  EXPECT_EQ(r.failed, 0u);
  EXPECT_EQ(r.runs, 64u * 5u);
  const auto& elevator = indices_named(r, "2 s: doublet elevator").variance.inputs;
  const auto& aileron = indices_named(r, "8 s: doublet aileron").variance.inputs;
  // Wings level in calm air only the elevator's moment moves anything; but for the aileron that holds against the
  // propeller's torque, a tenth of a degree whose moment is off by as much as Cl_da.
  EXPECT_GT(elevator[0].total, 20.0 * elevator[1].total);
  EXPECT_LT(elevator[1].total, 0.05);
  EXPECT_NEAR(elevator[2].total, 0.0, 1e-6);
  EXPECT_LE(elevator[2].first_low, 1e-9);
  EXPECT_GE(elevator[2].first_high, -1e-9);
  EXPECT_GT(aileron[1].total, 0.5);
  // Pitch rate by the elevator (and a little where the aircraft banks), roll rate by aileron and inertia.
  EXPECT_GT(indices_named(r, "q").variance.inputs[0].total, 0.85);
  EXPECT_LT(indices_named(r, "p").variance.inputs[0].total, 0.01);
  EXPECT_GT(indices_named(r, "p").variance.inputs[1].total, 0.5);
}

TEST(FlightSensitivity, IsTheSameOnAnyNumberOfThreads) {
  const FlightSensitivityStudy study = read_varied(std::string(kTwoDoublets) + kThreeInputs);
  const ResponseIndices a = analyse_varied(study, 1), b = analyse_varied(study, 3);
  ASSERT_EQ(a.results.size(), b.results.size());
  for (std::size_t k = 0; k < a.results.size(); ++k) {
    EXPECT_EQ(a.results[k].variance.mean, b.results[k].variance.mean);
    EXPECT_EQ(a.results[k].variance.inputs[0].total, b.results[k].variance.inputs[0].total);
  }
}

TEST(FlightSensitivity, VariesEveryNumberThatIsNotZero) {
  std::vector<std::string> names;
  for (const estimation::IndexInput& i : read_varied(kTwoDoublets).inputs) {
    names.push_back(i.name);
    EXPECT_NEAR(i.high - i.nominal, 0.1 * std::abs(i.nominal), 1e-12) << i.name;
  }
  for (const char* name : {"CL_alpha", "CD_0", "Cm_q", "Cn_beta", "mass", "Jz"})
    EXPECT_THAT(names, ::testing::Contains(name));
}

TEST(FlightSensitivity, RefusesWhatItCannotVary) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(read_varied(text));
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  };
  const std::string input = std::string(kTwoDoublets) + "[[sensitivity.input]]\n";
  EXPECT_THAT(refusal(input + "parameter = \"CL_alfa\""), HasSubstr("did you mean 'CL_alpha'?"));
  EXPECT_THAT(refusal(input + "parameter = \"Jx\"\nlow = -1\nhigh = 2"), HasSubstr("not positive definite"));
  EXPECT_THAT(refusal(input + "parameter = \"mass\"\nlow = 0\nhigh = 2"), HasSubstr("mass from 0: must be > 0"));
  EXPECT_THAT(refusal(std::string(kTwoDoublets) + "[[flight.change]]\ntime = 5\nparameters = { Cm_alpha = -0.3 }\n"),
              HasSubstr("flight.change: has no place"));
  EXPECT_THAT(refusal(std::string(kTwoDoublets) + "method = \"none\"\n"), HasSubstr("leaves nothing"));
  // Where no steady flight exists, the computation failed.
  numerics::BlockStore store;
  Progress progress;
  std::string low = kTwoDoublets;
  low.replace(low.find("airspeed = 20"), 13, "airspeed = 3 ");
  EXPECT_THROW(static_cast<void>(analyse_flight(read_varied(low), store, progress)), std::runtime_error);
}

}  // namespace
}  // namespace veridyn::aircraft
