#include "veridyn/live/rig/live_rig.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/live/rig/driven_rig.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using cueing::PlatformAxis;
using test::DrivenRig;
using test::rig_study;

double largest_position(const RigStep& s) {
  double most = 0.0;
  for (std::size_t i = 0; i < cueing::kPlatformAxes; ++i)
    most = std::max(most, std::abs(axis(s.cueing.ordered, static_cast<PlatformAxis>(i)).position));
  return most;
}

void expect_within_limits(const DrivenRig& r) {
  EXPECT_EQ(r.platform.counts().outside, 0U);
  EXPECT_EQ(r.platform.counts().jumps, 0U);
  EXPECT_EQ(r.platform.counts().unreadable, 0U);
}

TEST(LiveRig, StaysParkedUntilItIsStarted) {
  DrivenRig r(rig_study());
  r.run(2.0, [](const RigStep& s) {
    EXPECT_EQ(s.state, RigState::kParked);
    EXPECT_EQ(largest_position(s), 0.0);
  });
  EXPECT_EQ(r.rig.readiness(), Readiness::kReady);
}

TEST(LiveRig, StartsSoftlyFollowsTheDriveAndParks) {
  DrivenRig r(rig_study());
  r.run(1.0);
  r.rig.request(OperatorRequest::kStart);
  double share = 0.0;
  r.run(2.9, [&](const RigStep& s) {
    EXPECT_EQ(s.state, RigState::kSoftStart);
    EXPECT_GE(s.share, share);
    share = s.share;
  });
  double most = 0.0;
  r.run(8.0, [&](const RigStep& s) { most = std::max(most, largest_position(s)); });
  EXPECT_EQ(r.rig.state(), RigState::kRunning);
  EXPECT_GT(most, 0.02);
  r.rig.request(OperatorRequest::kPark);
  r.run(0.02);
  EXPECT_EQ(r.rig.state(), RigState::kFade);
  r.run(6.0);
  EXPECT_EQ(r.rig.state(), RigState::kParked);
  r.run(1.0, [](const RigStep& s) { EXPECT_LT(largest_position(s), 1e-3); });
  expect_within_limits(r);
}

TEST(LiveRig, GivesThePlatformWhatTheReplayedDriveGivesIt) {
  // Once the whole motion is let through, the chain of `veridyn cue` on the same samples, with the rig's delay.
  LiveStudy study = rig_study("delay = 0\nsoft_start = 0.5\nsigns = 'off'\n");
  DrivenRig r(study);
  r.rig.request(OperatorRequest::kStart);
  std::vector<RigStep> steps;
  r.run(20.0, [&](const RigStep& s) { steps.push_back(s); });
  std::vector<recording::MotionSample> samples;
  for (const RigStep& s : steps) {
    samples.push_back(s.motion ? s.motion->sample : recording::MotionSample{});
    samples.back().time = seconds(s.time);
  }
  samples.erase(samples.begin(), samples.begin() + 10);
  Progress quiet;
  const auto washout = study.cueing.algorithms[0].design->make(study.cueing.platform);
  const cueing::CueingRun run = cueing::drive_platform(samples, *washout, study.cueing.platform, quiet);
  double worst = 0.0;
  for (std::size_t k = 1500; k < run.steps.size(); ++k) {
    worst = std::max(worst, (run.steps[k].ordered.angle - steps[k + 10].cueing.ordered.angle).norm());
    worst = std::max(worst, (run.steps[k].ordered.shift - steps[k + 10].cueing.ordered.shift).norm());
  }
  // What is left after 15 s of how differently they began.
  EXPECT_LT(worst, 2e-3);
}

TEST(LiveRig, HoldsFadesAndComesBackWithoutTelemetry) {
  DrivenRig r(rig_study());
  r.rig.request(OperatorRequest::kStart);
  r.run(8.0);
  ASSERT_EQ(r.rig.state(), RigState::kRunning);
  r.vehicle_sends = false;
  r.run(0.2);
  EXPECT_EQ(r.rig.state(), RigState::kRunning);
  r.run(0.2);
  EXPECT_EQ(r.rig.state(), RigState::kHold);
  EXPECT_EQ(r.rig.readiness(), Readiness::kNoTelemetry);
  r.vehicle_sends = true;
  r.run(0.3);  // back within the hold: on from the share that was left, which is all
  EXPECT_EQ(r.rig.state(), RigState::kRunning);
  r.vehicle_sends = false;
  r.run(1.0);
  EXPECT_EQ(r.rig.state(), RigState::kFade);
  r.run(7.0);
  EXPECT_EQ(r.rig.state(), RigState::kParked);
  r.vehicle_sends = true;
  r.run(6.0);
  EXPECT_EQ(r.rig.state(), RigState::kRunning);  // by itself: nobody asked it to park
  expect_within_limits(r);
}

TEST(LiveRig, HoldsAndFadesWhereThePlatformDoesNotAnswer) {
  DrivenRig r(rig_study());
  r.rig.request(OperatorRequest::kStart);
  r.run(6.0);
  r.platform_answers = false;
  r.run(0.4);
  EXPECT_EQ(r.rig.state(), RigState::kHold);
  EXPECT_EQ(r.rig.readiness(), Readiness::kNoAnswer);
  r.run(8.0);
  EXPECT_EQ(r.rig.state(), RigState::kParked);
  r.platform_answers = true;
  r.run(6.0);
  EXPECT_EQ(r.rig.state(), RigState::kRunning);
}

TEST(LiveRig, StopsWithinOneStepAndStaysUntilItIsReleased) {
  DrivenRig r(rig_study());
  r.rig.request(OperatorRequest::kStart);
  r.run(10.0);
  r.rig.request(OperatorRequest::kEmergency);
  bool first = true;
  RigStep before;
  r.run(2.0, [&](const RigStep& s) {
    EXPECT_EQ(s.state, RigState::kStopped);
    first = false;
    before = s;
  });
  EXPECT_FALSE(first);
  const double stopped_at = largest_position(before);
  r.rig.request(OperatorRequest::kStart);
  r.run(5.0, [&](const RigStep& s) {
    EXPECT_EQ(s.state, RigState::kStopped);
    EXPECT_EQ(largest_position(s), stopped_at);
  });
  r.rig.request(OperatorRequest::kPark);  // no release
  r.run(0.1);
  EXPECT_EQ(r.rig.state(), RigState::kStopped);
  r.rig.request(OperatorRequest::kRelease);
  r.run(0.02);
  EXPECT_EQ(r.rig.state(), RigState::kFade);
  r.run(6.0);
  EXPECT_EQ(r.rig.state(), RigState::kParked);
  expect_within_limits(r);
}

TEST(LiveRig, StopsOnAPacketWhoeverSendsIt) {
  DrivenRig r(rig_study());
  r.rig.request(OperatorRequest::kStart);
  r.run(5.0);
  r.rig.take(LinkOf::kTelemetry, {"VSTOP1", {0x7f000001, 9999}, r.now});
  r.run(0.01, [](const RigStep& s) { EXPECT_EQ(s.state, RigState::kStopped); });
  EXPECT_EQ(r.rig.intake().counts()[PacketStatus::kWrongSize], 0U);
}

TEST(LiveRig, AnEmergencyStopAndAReleaseAtOnceStop) {
  DrivenRig r(rig_study());
  r.rig.request(OperatorRequest::kStart);
  r.run(5.0);
  r.rig.request(OperatorRequest::kRelease);
  r.rig.request(OperatorRequest::kEmergency);
  r.run(1.0);
  EXPECT_EQ(r.rig.state(), RigState::kStopped);
}

TEST(LiveRig, DoesNotStartBeforeSignsAreCheckedNorOnAWrongOne) {
  DrivenRig before(rig_study("signs = 'before'\n"));
  before.rig.request(OperatorRequest::kStart);
  before.run(2.0);
  EXPECT_EQ(before.rig.state(), RigState::kParked);
  EXPECT_EQ(before.rig.readiness(), Readiness::kSignsUnknown);
  before.rig.request(OperatorRequest::kSignsRight);
  before.run(0.1);
  EXPECT_EQ(before.rig.state(), RigState::kSoftStart);

  DrivenRig during(rig_study("signs = 'while'\n"));
  during.rig.request(OperatorRequest::kStart);
  during.run(5.0);
  EXPECT_EQ(during.rig.state(), RigState::kRunning);
  during.rig.request(OperatorRequest::kSignsWrong);
  during.rig.request(OperatorRequest::kSignsRight);  // what was wrong once stays so
  during.run(8.0);
  EXPECT_EQ(during.rig.state(), RigState::kParked);
  EXPECT_EQ(during.rig.readiness(), Readiness::kSignsWrong);
}

TEST(LiveRig, IsNotReadyForFrozenOrSlowTelemetry) {
  DrivenRig slow(rig_study(), {.rate = 15.0});
  slow.rig.request(OperatorRequest::kStart);
  slow.run(5.0);
  EXPECT_EQ(slow.rig.state(), RigState::kParked);
  EXPECT_EQ(slow.rig.readiness(), Readiness::kTooSlow);

  LiveStudy study = rig_study("answers = false\nsigns = 'off'\n");
  LiveRig rig(study, 1);
  VirtualVehicle vehicle(test::weaving_drive(10.0));
  const std::string first(*vehicle.next());
  for (int k = 0; k < 300; ++k) {
    std::string packet = first;
    const double time = 1000.0 + 0.01 * k;
    std::memcpy(packet.data() + 8, &time, 8);
    // It says that it drives at 15 m/s, from the same place.
    rig.take(LinkOf::kTelemetry, {packet, {1, 1}, nanoseconds(0.01 * k)});
    rig.step(nanoseconds(0.01 * k + 0.001));
  }
  EXPECT_EQ(rig.readiness(), Readiness::kFrozen);
}

TEST(LiveRig, AnotherCommanderOfThePlatformIsNotFoughtWith) {
  LiveStudy study = rig_study();
  DrivenRig r(study);
  r.run(0.5);
  // The platform is taken by a program with another session first.
  VirtualPlatform platform(study.cueing.platform);
  PlatformOrder theirs;
  theirs.session = 99;
  for (std::uint32_t k = 1; k < 300; ++k) {
    r.now += 10 * kMillisecond;
    theirs.sequence = k;
    theirs.time = r.now;
    const OrderBytes bytes = encode(theirs);
    ASSERT_EQ(platform.take({{bytes.data(), bytes.size()}, {0x7f000001, 7000}, r.now})->verdict,
              PlatformVerdict::kFollows);
    const RigStep& s = r.rig.step(r.now);
    const auto answer = platform.take({{s.order.data(), s.order.size()}, DrivenRig::kRig, r.now});
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->verdict, PlatformVerdict::kCommandedByAnother);
    const AnswerBytes back = encode(*answer);
    r.rig.take(LinkOf::kPlatform, {{back.data(), back.size()}, DrivenRig::kPlatform, r.now});
    r.rig.request(OperatorRequest::kStart);
  }
  EXPECT_EQ(r.rig.state(), RigState::kParked);
  EXPECT_EQ(platform.commander(), "127.0.0.1:7000");
  EXPECT_EQ(platform.last_refused(), to_string(DrivenRig::kRig));
  EXPECT_EQ(platform.counts().refused, 299U);
}

TEST(LiveRig, KeepsThePlatformWithinItsLimitsWhateverHappens) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    DrivenRig r(rig_study("rate = '200 Hz'\nsigns = 'off'\n"), {.jitter = 0.03, .loss = 0.05, .seed = seed});
    numerics::RandomStream random(seed, "what happens");
    r.rig.request(OperatorRequest::kStart);
    for (int k = 0; k < 120; ++k) {
      r.vehicle_sends = random.uniform() < 0.8;
      r.platform_answers = random.uniform() < 0.9;
      const double what = random.uniform();
      if (what < 0.1) r.rig.request(OperatorRequest::kEmergency);
      if (what > 0.1 && what < 0.4) r.rig.request(OperatorRequest::kRelease);
      if (what > 0.4 && what < 0.8) r.rig.request(OperatorRequest::kStart);
      if (what > 0.9) r.rig.request(OperatorRequest::kPark);
      if (what > 0.8 && what < 0.85) r.now += nanoseconds(random.uniform(0.0, 3.0));  // the loop stood still
      r.run(random.uniform(0.05, 2.0));
    }
    expect_within_limits(r);
    EXPECT_GT(r.rig.entered()[RigState::kRunning], 0U);
    EXPECT_GT(r.rig.entered()[RigState::kStopped], 0U);
    EXPECT_GT(r.rig.gaps(), 0U);
  }
}

TEST(LiveRig, TheSameInGivesTheSameOut) {
  const auto orders = [] {
    DrivenRig r(rig_study(), {.jitter = 0.02});
    r.rig.request(OperatorRequest::kStart);
    std::string all;
    r.run(10.0, [&](const RigStep& s) { all.append(s.order.data(), s.order.size()); });
    return all;
  };
  EXPECT_EQ(orders(), orders());
}

TEST(LiveRig, AnotherAlgorithmTakesOverFromWhereThePlatformIs) {
  LiveStudy study = rig_study();
  DrivenRig r(study);
  r.rig.request(OperatorRequest::kStart);
  r.run(10.0);
  const auto other = cueing::washout_algorithm("tilt").design();
  const auto old = r.rig.take_over(other->make(study.cueing.platform));
  EXPECT_NE(old, nullptr);
  double before = -1.0, most = 0.0;
  r.run(5.0, [&](const RigStep& s) {
    const double at = s.cueing.ordered.angle.y();
    if (before != -1.0) most = std::max(most, std::abs(at - before));
    before = at;
  });
  EXPECT_LE(most, study.cueing.platform.limits[PlatformAxis::kPitch].rate * 0.01 * 1.001);
  expect_within_limits(r);
}

TEST(LiveRig, SaysWhoCommandsThePlatformWhereThatSaysSo) {
  LiveRig::Answers answers;
  answers.verdict = PlatformVerdict::kCommandedByAnother;
  EXPECT_EQ(described(Readiness::kRefused, answers), name_of(Readiness::kRefused));
  answers.commander = {0x7f000001, 4711};
  EXPECT_EQ(described(Readiness::kRefused, answers),
            "the platform refuses orders: the program at 127.0.0.1:4711 commands it");
  EXPECT_EQ(described(Readiness::kFrozen, answers), name_of(Readiness::kFrozen));
}

TEST(LiveRig, CountsTheOrdersWhoseMotionWasContinued) {
  // Four orders to a packet: three of them fall between packets.
  test::DrivenRig r(test::rig_study("signs = 'off'\ndelay = '0 ms'\nrate = 400\n"));
  r.rig.request(OperatorRequest::kStart);
  r.run(5.0);
  const LiveRig::Extrapolated& e = r.rig.extrapolated();
  EXPECT_GT(e.of, 300U);
  EXPECT_GT(e.steps, e.of / 2);
  EXPECT_GT(e.longest, 0.0);
  EXPECT_LE(e.longest, 0.03);
  test::DrivenRig late(test::rig_study("signs = 'off'\ndelay = '50 ms'\nrate = 400\n"));
  late.rig.request(OperatorRequest::kStart);
  late.run(5.0);
  EXPECT_EQ(late.rig.extrapolated().steps, 0U);
  EXPECT_GT(late.rig.extrapolated().of, 300U);
}

}  // namespace
}  // namespace veridyn::live
