#include "bench/reproduction/aircraft/tracking_experiment.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/elevator_flight.hpp"

namespace veridyn::aircraft {
namespace {

TEST(TrackingExperiment, SettlesWhereItIsExcitedAndNeverWhereItIsBiased) {
  Progress silent;
  const std::string study =
      fmt::format("{}{}", test::elevator_flight(3),
                  "[experiment]\ncoefficient = \"Cm\"\nseeds = 2\nrate = 50\nsnr = 30\nregressor_snr = 15\n"
                  "[[experiment.tracker]]\nname = \"OLS\"\nmethod = \"OLS\"\nlambda = 1.0\n"
                  "forgetting = \"constant\"\n"
                  "[[experiment.tracker]]\nname = \"GTLS\"\nmethod = \"GTLS\"\nlambda = 1.0\n"
                  "forgetting = \"constant\"\n");
  const Study parsed = Study::parse(study, "test.toml");
  const ExperimentOptions o = ExperimentOptions::read(parsed.root());
  const TrackingExperiment e = run_tracking_experiment(o, read_trackers(parsed.root().table("experiment")), silent);
  // GTLS ends nearer to the truth than OLS, whose errors the noise on the regressors makes systematic.
  const auto error = [&](std::size_t tracker) {
    const TrackHistory& h = e.runs[tracker][0].history;
    double worst = 0.0;
    for (std::size_t i = 1; i < h.value.size(); ++i)
      worst = std::max(worst, std::abs(h.value[i].back() / e.rows.truth(i) - 1.0));
    return worst;
  };
  EXPECT_GT(error(0), 0.1);
  EXPECT_LT(error(1), 0.5 * error(0));
}

}  // namespace
}  // namespace veridyn::aircraft
