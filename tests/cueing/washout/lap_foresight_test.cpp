#include "veridyn/cueing/washout/lap_foresight.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/cueing/chain/cueing_chain.hpp"
#include "veridyn/cueing/score/cueing_score.hpp"
#include "veridyn/cueing/score/felt_motion.hpp"
#include "veridyn/cueing/score/least_error.hpp"
#include "veridyn/cueing/washout/predictive_washout.hpp"

namespace veridyn::cueing {
namespace {

using recording::MotionSample;
using recording::Origin;

/// A sinuous track, y = 20 m sin(x / 40 m), driven at a speed that changes along it, by a factor faster or slower. All
/// its numbers follow from the geometry: a_y = v^2 kappa, a_x = v dv/ds.
class Track {
 public:
  static constexpr double kWidth = 20.0, kLength = 40.0;
  explicit Track(double pace, double offset = 0.0) : pace_(pace), offset_(offset) {}

  /// @param from to where it is driven along x [m]
  [[nodiscard]] std::vector<MotionSample> driven(double from, double to, double step) const {
    std::vector<MotionSample> samples;
    double x = from, t = 0.0;
    while (x < to) {
      samples.push_back(at(x, t));
      // Midpoint rule along x.
      const auto rate = [&](double at) { return speed(at) / std::hypot(1.0, slope(at)); };
      x += step * rate(x + 0.5 * step * rate(x));
      t += step;
    }
    return samples;
  }

 private:
  [[nodiscard]] static double slope(double x) { return kWidth / kLength * std::cos(x / kLength); }
  [[nodiscard]] double speed(double x) const { return pace_ * (20.0 + 5.0 * std::sin(x / 60.0)); }
  [[nodiscard]] MotionSample at(double x, double t) const {
    const double d1 = slope(x), d2 = -kWidth / (kLength * kLength) * std::sin(x / kLength);
    const double along = std::hypot(1.0, d1), v = speed(x), curvature = d2 / (along * along * along);
    const double dv = pace_ * 5.0 / 60.0 * std::cos(x / 60.0) / along;
    MotionSample s;
    s.time = t;
    s.frame = Frame::kFlu;
    s.force = recording::force_at_rest(Frame::kFlu) + Eigen::Vector3d(v * dv, v * v * curvature, 0.0);
    s.position = Eigen::Vector2d(x, kWidth * std::sin(x / kLength)) + offset_ * Eigen::Vector2d(-d1, 1.0) / along;
    s.position_from = s.force_from = Origin::kMeasured;
    return s;
  }
  double pace_, offset_;
};

/// Largest error of the forces that were foreseen `ahead` steps of the future later, and of holding the present ones.
struct Missed {
  double foreseen = 0.0, held = 0.0;
  int looks = 0;
};
Missed missed(Foresight& foresight, const std::vector<MotionSample>& drive, Eigen::Index axis, double settled) {
  constexpr std::size_t kAhead = 11;
  const double ahead = foreseen_middle(kAhead);
  Missed m;
  foresight.reset();
  for (std::size_t k = 0; k < drive.size(); ++k) {
    const MotionSample now = recording::in_frame(drive[k], Frame::kFrd);
    Foreseen f;
    const bool any = foresight.look(now, k == 0 ? 0.0 : drive[k].time - drive[k - 1].time, f);
    const auto later = static_cast<std::size_t>(std::lround(ahead / (drive[1].time - drive[0].time))) + k;
    if (!any || now.time < settled || later >= drive.size()) continue;
    const double then = recording::in_frame(drive[later], Frame::kFrd).force(axis), is = now.force(axis);
    m.foreseen = std::max(m.foreseen, std::abs(f.then[kAhead](axis) + is - f.now(axis) - then));
    m.held = std::max(m.held, std::abs(is - then));
    ++m.looks;
  }
  return m;
}

TEST(LapForesight, KnowsTheForcesAheadOnTheSameLap) {
  LapForesight foresight(Track(1.0).driven(0.0, 1500.0, 0.016));
  const auto drive = Track(1.0).driven(100.0, 1400.0, 0.01);
  const Missed sway = missed(foresight, drive, 1, 2.0), surge = missed(foresight, drive, 0, 2.0);
  EXPECT_GT(sway.looks, 4000);
  EXPECT_LT(sway.foreseen, 0.15);
  EXPECT_GT(sway.held, 2.5);
  EXPECT_LT(surge.foreseen, 0.1);
}

TEST(LapForesight, ComesSoonerAndStrongerWhereTheDriverIsFaster) {
  LapForesight foresight(Track(1.0).driven(0.0, 1500.0, 0.016));
  const auto faster = Track(1.25, 2.0).driven(100.0, 1400.0, 0.01);  // and two metres to the left
  const Missed m = missed(foresight, faster, 1, 2.0);
  EXPECT_GT(m.held, 4.0);
  EXPECT_LT(m.foreseen, 0.12 * m.held);
}

TEST(LapForesight, ForeseesNothingTheOtherWayRoundOrOffTheTrackAndComesBack) {
  LapForesight foresight(Track(1.0).driven(0.0, 1500.0, 0.016));
  auto there = Track(1.0).driven(100.0, 600.0, 0.01);
  std::vector<MotionSample> back(there.rbegin(), there.rend());
  for (std::size_t k = 0; k < back.size(); ++k) back[k].time = 0.01 * static_cast<double>(k);
  EXPECT_EQ(missed(foresight, back, 1, 0.0).looks, 0);

  foresight.reset();
  Foreseen f;
  for (std::size_t k = 0; k < there.size(); ++k) {
    MotionSample s = recording::in_frame(there[k], Frame::kFrd);
    const bool off = s.time > 5.0 && s.time < 8.0;
    if (off) s.position.y() += 40.0;
    if (s.time > 9.0 && s.time < 10.0) s.position_from = Origin::kAbsent;
    const bool foreseen = foresight.look(s, 0.01, f);
    if (off) {
      EXPECT_FALSE(foreseen) << s.time;
    }
    if (s.time > 9.0 && s.time < 10.0) {
      EXPECT_FALSE(foreseen);
    }
    if ((s.time > 1.0 && s.time < 5.0) || (s.time > 8.5 && s.time < 9.0) || s.time > 10.5) {
      EXPECT_TRUE(foreseen) << s.time;
    }
  }
}

TEST(LapForesight, AStandingVehicleIsForeseenToStand) {
  LapForesight foresight(Track(1.0).driven(0.0, 1500.0, 0.016));
  const auto drive = Track(1.0).driven(100.0, 300.0, 0.01);
  foresight.reset();
  Foreseen f;
  for (const MotionSample& s : drive) foresight.look(recording::in_frame(s, Frame::kFrd), 0.01, f);
  for (int k = 0; k < 500; ++k) foresight.look(recording::in_frame(drive.back(), Frame::kFrd), 0.01, f);
  for (const Eigen::Vector3d& then : f.then) EXPECT_LT((then - f.now).norm(), 1e-3);
}

TEST(LapForesight, WithItPlansComeNearTheLeastErrorThatIsPossible) {
  const Platform& platform = built_in_platform("three_axis");
  std::vector<MotionSample> drive;
  for (int k = 0; k < 6000; ++k) {
    MotionSample s;
    s.time = 0.01 * k;
    s.frame = Frame::kFlu;
    s.force = recording::force_at_rest(Frame::kFlu) + Eigen::Vector3d(0.0, std::sin(kPi / 6.0 * s.time), 0.0);
    s.position = {20.0 * s.time, 0.0};
    s.position_from = s.force_from = Origin::kMeasured;
    drive.push_back(s);
  }
  const VestibularModel& rider = vestibular_model("young_meiry");
  const auto error = [&](PredictiveDesign design) {
    design.shared.force_gain = {1.0, 1.0, 0.5};
    Progress silent;
    const CueingRun run = drive_platform(drive, *design.make(platform), platform, silent);
    return score(run, felt_motion(run, rider, usual_thresholds()), platform, 1).pairs[0].value;
  };
  const auto least = least_error(drive, platform, rider, usual_thresholds(), 0);
  ASSERT_TRUE(least);
  PredictiveDesign design;
  EXPECT_GT(error(design), 1.4 * least->error);
  design.foresee_from(LapForesight(drive));
  EXPECT_LT(error(design), 1.03 * least->error);
  EXPECT_GT(error(design), least->error);
}

TEST(LapForesight, BearsAnyPosition) {
  const Platform& platform = built_in_platform("three_axis");
  const auto drive = Track(1.1, 1.0).driven(50.0, 1400.0, 0.01);
  PredictiveDesign design;
  design.foresee_from(LapForesight(Track(1.0).driven(0.0, 1500.0, 0.016)));
  CueingChain chain(design.make(platform), platform);
  chain.reset(drive.front());
  for (std::size_t k = 1; k < drive.size(); ++k) {
    MotionSample s = drive[k];
    const double wild[] = {kInfinity, -1e300, std::nan(""), 1e7, 0.0};
    if (k % 3 == 0) s.position.x() = wild[k % 5];
    if (k % 7 == 0) s.position.y() = wild[(k / 7) % 5];
    const CueingStep step = chain.step(s, k % 11 == 0 ? std::nan("") : 0.01);
    ASSERT_TRUE(step.ordered.angle.allFinite()) << k;
  }
}

TEST(LapForesight, RefusesLapsThatSayNothing) {
  auto lap = Track(1.0).driven(0.0, 500.0, 0.016);
  EXPECT_EQ(why([&] { LapForesight(std::vector<MotionSample>{}); }),
            "lap: has no positions: channels pos_x and pos_y are needed");
  auto gap = lap;
  gap.erase(gap.begin() + 100, gap.begin() + 300);
  EXPECT_EQ(why([&] { LapForesight{gap}; }), "lap: has a gap of 3.22 s at 1.584 s");
  lap.resize(50);
  EXPECT_NE(why([&] { LapForesight{lap}; }).find("m long; takes 50 m or more"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::cueing
