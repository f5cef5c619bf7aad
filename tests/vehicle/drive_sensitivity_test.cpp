#include "veridyn/vehicle/drive_sensitivity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/numerics/batches/block_store.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::ResponseIndices;
using ::testing::HasSubstr;

class DriveThreads : public Progress {
 public:
  explicit DriveThreads(int threads) : threads_(threads) {}
  [[nodiscard]] int threads() const override { return threads_; }

 private:
  int threads_;
};

constexpr const char* kVariedStep = R"(
seed = 3
[subject]
kind = "vehicle"
builtin = "reference"
[drive]
model = "linear bicycle"
manoeuvre = "step steer"
amplitude = "1 deg"
speed = "20 m/s"
duration = 6
step = 0.01
[sensitivity]
index_samples = 512
)";

DriveSensitivityStudy read_varied(const std::string& text) {
  return read_drive_sensitivity(Study::parse(text, "study.toml").root(), Progress());
}

ResponseIndices analyse_varied(const DriveSensitivityStudy& study, int threads = 2) {
  numerics::BlockStore store;
  DriveThreads progress(threads);
  return analyse_drive(study, store, progress);
}

std::size_t result_named(const ResponseIndices& r, const std::string& name) {
  const auto at = std::ranges::find_if(r.responses, [&](const auto& one) { return one.name == name; });
  EXPECT_NE(at, r.responses.end()) << name;
  return static_cast<std::size_t>(at - r.responses.begin());
}

std::size_t input_named(const ResponseIndices& r, const std::string& name) {
  const std::vector<std::string> names = r.input_names();
  const auto at = std::ranges::find(names, name);
  EXPECT_NE(at, names.end()) << name;
  return static_cast<std::size_t>(at - names.begin());
}

/// Steady yaw rate per steer of the linear bicycle (textbook): u/(L + K u^2), K = m/(2 L) (b/C_f - a/C_r).
double yaw_gain(double mass, double a, double C_f, double C_r) {
  constexpr double kL = 2.25, kU = 20.0;
  return kU / (kL + mass / (2.0 * kL) * ((kL - a) / C_f - a / C_r) * kU * kU);
}

/// First-order indices of the gain for uniform inputs within 10 %, by midpoint sums over all four: V(E(y|x_i))/V(y).
std::array<double, 4> exact_first_orders() {
  constexpr int kPoints = 24;
  constexpr std::array kNominal{1100.0, 1.25, 60000.0, 120000.0};
  const auto value = [&](std::size_t i, int k) { return kNominal[i] * (0.9 + 0.2 * (k + 0.5) / kPoints); };
  std::array<std::array<double, kPoints>, 4> conditional{};
  double mean = 0.0, square = 0.0;
  constexpr double kAll = 1.0 * kPoints * kPoints * kPoints * kPoints;
  for (int i = 0; i < kPoints; ++i) {
    for (int j = 0; j < kPoints; ++j) {
      for (int k = 0; k < kPoints; ++k) {
        for (int l = 0; l < kPoints; ++l) {
          const double y = yaw_gain(value(0, i), value(1, j), value(2, k), value(3, l));
          mean += y / kAll;
          square += y * y / kAll;
          const std::array<int, 4> at{i, j, k, l};
          for (std::size_t n = 0; n < 4; ++n) conditional[n][at[n]] += y * kPoints / kAll;
        }
      }
    }
  }
  std::array<double, 4> first{};
  for (std::size_t n = 0; n < 4; ++n) {
    for (const double e : conditional[n]) first[n] += std::pow(e - mean, 2) / kPoints;
    first[n] /= square - mean * mean;
  }
  return first;
}

TEST(DriveSensitivity, OfTheYawGainIsThatOfItsClosedForm) {
  const DriveSensitivityStudy study = read_varied(kVariedStep);
  const ResponseIndices r = analyse_varied(study);
  EXPECT_EQ(r.failed, 0u);
  EXPECT_EQ(r.runs, 512u * 7u);
  const std::size_t gain = result_named(r, "yaw_rate_gain");
  EXPECT_NEAR(r.responses[gain].nominal, yaw_gain(1100.0, 1.25, 60000.0, 120000.0), 1e-4);
  const auto& inputs = r.results[gain].variance.inputs;
  const std::array<double, 4> exact = exact_first_orders();
  double sum = 0.0;
  for (const auto& [name, first] : {std::pair{"mass", exact[0]}, std::pair{"cg_position", exact[1]},
                                    std::pair{"C_f", exact[2]}, std::pair{"C_r", exact[3]}}) {
    const auto& found = inputs[input_named(r, name)];
    EXPECT_LE(found.first_low, first) << name;
    EXPECT_GE(found.first_high, first) << name;
    EXPECT_NEAR(found.first, first, 0.02) << name;
    sum += found.first;
  }
  EXPECT_NEAR(sum, 1.0, 0.03);  // nearly linear
  // The yaw inertia has no part in a steady state.
  EXPECT_NEAR(inputs[input_named(r, "I_z")].first, 0.0, 1e-3);
  EXPECT_NEAR(inputs[input_named(r, "I_z")].total, 0.0, 1e-4);
  // It has in how soon that is reached.
  EXPECT_GT(r.results[result_named(r, "yaw_rate_response_time")].variance.inputs[input_named(r, "I_z")].total, 0.2);
}

TEST(DriveSensitivity, IsTheSameOnAnyNumberOfThreads) {
  // A driver with a state, on a path.
  const std::string text = R"(
[subject]
kind = "vehicle"
builtin = "reference"
[drive]
model = "bicycle"
manoeuvre = "double lane change"
speed = "15 m/s"
step = 0.01
[sensitivity]
index_samples = 4
)";
  const DriveSensitivityStudy study = read_varied(text);
  const ResponseIndices a = analyse_varied(study, 1), b = analyse_varied(study, 3);
  ASSERT_EQ(a.results.size(), b.results.size());
  ASSERT_FALSE(a.results.empty());
  for (std::size_t k = 0; k < a.results.size(); ++k) {
    EXPECT_EQ(a.results[k].variance.mean, b.results[k].variance.mean) << a.responses[k].name;
    for (std::size_t i = 0; i < a.inputs.size(); ++i)
      EXPECT_EQ(a.results[k].variance.inputs[i].first, b.results[k].variance.inputs[i].first);
  }
}

TEST(DriveSensitivity, GivesNothingToWhatTheModelDoesNotHave) {
  const DriveSensitivityStudy study =
      read_varied(std::string(kVariedStep) +
                  "[[sensitivity.input]]\nparameter = \"track_f\"\n[[sensitivity.input]]\nparameter = "
                  "\"C_f\"\n");
  ASSERT_EQ(study.inputs.size(), 2u);
  const ResponseIndices r = analyse_varied(study);
  for (const estimation::ResultIndices& one : r.results) {
    EXPECT_EQ(one.variance.inputs[0].first, 0.0) << one.result;
    EXPECT_EQ(one.variance.inputs[0].total, 0.0) << one.result;
    // All there is, as nearly as the indices themselves say: twice half of their 95 % interval.
    const auto& all = one.variance.inputs[1];
    EXPECT_LT(all.total_high - all.total_low, 0.1) << one.result;
    EXPECT_NEAR(all.total, 1.0, all.total_high - all.total_low) << one.result;
  }
}

TEST(DriveSensitivity, CountsDrivesThatCannotBeFinished) {
  // The stiffer the tyres, the shorter the steps that the model needs.
  const std::string text = R"(
[subject]
kind = "vehicle"
builtin = "reference"
[drive]
model = "bicycle"
manoeuvre = "step steer"
amplitude = "1 deg"
speed = "20 m/s"
step = 0.05
output_step = 0.05
[sensitivity]
index_samples = 16
[[sensitivity.input]]
parameter = "C_r"
low = 90000
high = 400000
)";
  const ResponseIndices r = analyse_varied(read_varied(text));
  EXPECT_GT(r.failed, 0u);
  EXPECT_LT(r.failed, r.runs);
  EXPECT_THAT(r.warnings.front(), HasSubstr("runs could not finish"));
}

TEST(DriveSensitivity, VariesByDefaultWhatTheModelUses) {
  const auto names = [](const std::string& text) {
    std::vector<std::string> list;
    for (const estimation::IndexInput& i : read_varied(text).inputs) list.push_back(i.name);
    return list;
  };
  EXPECT_THAT(names(kVariedStep), ::testing::UnorderedElementsAre("mass", "I_z", "C_f", "C_r", "cg_position"));
  std::string four = kVariedStep;
  four.replace(four.find("linear bicycle"), 14, "four-wheel");
  const std::vector<std::string> all = names(four);
  EXPECT_THAT(all, ::testing::Contains("track_f"));
  EXPECT_THAT(all, ::testing::Contains("K_sf"));
  EXPECT_THAT(all, ::testing::Not(::testing::Contains("a")));
  EXPECT_THAT(all, ::testing::Not(::testing::Contains("K_bf")));  // this car has no bar
}

TEST(DriveSensitivity, RefusesWhatNoVehicleCanHave) {
  const auto refusal = [](const std::string& more) -> std::string {
    try {
      static_cast<void>(read_varied(std::string(kVariedStep) + more));
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_THAT(refusal("[[sensitivity.input]]\nparameter = \"C_ff\"\n"), HasSubstr("did you mean 'C_f'?"));
  EXPECT_THAT(refusal("[[sensitivity.input]]\nparameter = \"mass\"\nlow = -5\nhigh = 5\n"),
              HasSubstr("mass from -5: mass is -5 kg; must be > 0"));
  EXPECT_THAT(refusal("[[sensitivity.input]]\nparameter = \"a\"\n[[sensitivity.input]]\nparameter = \"cg_position\"\n"),
              HasSubstr("exclude each other"));
  EXPECT_THAT(refusal("method = \"none\"\n"), HasSubstr("leaves nothing to compute"));
}

}  // namespace
}  // namespace veridyn::vehicle
