#include "veridyn/cueing/cueing_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kDrive =
    "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"bicycle\"\nmanoeuvre = \"sine\"\n"
    "amplitude = \"2 deg\"\nfrequency = \"0.3 Hz\"\nspeed = 15\nduration = 12\n";

CueingStudy read(const std::string& text) {
  const Study study = Study::parse(text, "rig.toml");
  Progress progress;
  CueingStudy s = read_study(study, progress);
  study.root().finish();
  return s;
}

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(read(text));
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(CueingStudy, ReadsDrivesAndScores) {
  const CueingStudy s = read(std::string("[cue]\nalgorithms = [\"classical\", \"optimal\"]\npreset = \"low\"\n"
                                         "[washout.classical]\nonset = [1, 1, 2]\n[platform]\nsubject = \"hexapod\"\n"
                                         "[omct]\nfrequencies = [1]\n") +
                             kDrive);
  ASSERT_EQ(s.algorithms.size(), 2u);
  EXPECT_GT(s.vehicle.size(), 1000u);
  for (const Knob& knob : s.algorithms[0].design->knobs()) {
    if (knob.name == "force_gain") {
      EXPECT_EQ(knob.values[0], 0.3);
    } else if (knob.name == "onset") {
      EXPECT_EQ(knob.values[2], 2.0);
    }
  }
  Progress progress;
  const CueingResult r = cue(s, progress);
  ASSERT_EQ(r.algorithms.size(), 2u);
  EXPECT_EQ(r.algorithms[0].run.steps.size(), s.vehicle.size());
  EXPECT_GT(r.algorithms[0].score.cues[Cue::kSway].pearson.value, 0.3);
  EXPECT_EQ(r.algorithms[0].response.size(), kCues);
}

TEST(CueingStudy, SaysWhereTheDriveIsShortOrHasGaps) {
  CueingStudy s = read(std::string("[cue]\nalgorithms = [\"classical\", \"tilt\"]\noptimum = false\n") + kDrive);
  for (std::size_t k = s.vehicle.size() / 2; k < s.vehicle.size(); ++k) s.vehicle[k].time += 0.5;
  Progress progress;
  const CueingResult r = cue(s, progress);
  EXPECT_THAT(r.notes, ::testing::ElementsAre(HasSubstr("1 gap longer than 0.1 s, up to 0.51 s"),
                                              HasSubstr("classical: the drive lasts 12.5 s, its slowest filter "
                                                        "(recentre = 0.2 rad/s) settles in 23 s")));
}

TEST(CueingStudy, TheDriversPlaceFeelsTheTurn) {
  const CueingStudy centre = read(std::string("[cue]\n") + kDrive),
                    ahead = read(std::string("[cue]\ndriver = [1.0, 0, 0]\n") + kDrive);
  double off = 0.0;
  for (std::size_t k = 0; k < centre.vehicle.size(); ++k) {
    const auto &c = centre.vehicle[k], &a = ahead.vehicle[k];
    EXPECT_NEAR(a.force.y(), c.force.y() + c.angular_acceleration.z(), 1e-9);
    EXPECT_NEAR(a.force.x(), c.force.x() - c.rate.z() * c.rate.z(), 1e-9);
    off = std::max(off, std::abs(a.force.y() - c.force.y()));
  }
  EXPECT_GT(off, 0.05);
}

TEST(CueingStudy, SaysWhatIsWrongAndWhere) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(refusal(std::string("[cue]\nalgorithms = [\"clasical\"]\n") + kDrive),
              HasSubstr("did you mean 'classical'"));
  EXPECT_THAT(refusal(std::string("[cue]\n[washout.classical]\nonset = [0, 1, 1]\n") + kDrive),
              HasSubstr("rig.toml:3: washout.classical.onset"));
  EXPECT_THAT(refusal(std::string("[cue]\n[washout.optimal]\nonst = 1\n") + kDrive), HasSubstr("onst"));
  EXPECT_THAT(refusal("[cue]\n"), HasSubstr("name a recorded drive, or simulate one"));
  EXPECT_THAT(refusal(std::string("[cue]\nperception = \"meiry\"\n") + kDrive), HasSubstr("perception"));
  EXPECT_THAT(refusal(std::string("[cue]\n[omct]\nfrequencies = [0]\n") + kDrive), HasSubstr("omct.frequencies"));
  EXPECT_THAT(
      refusal(std::string("[cue]\n[[omct.mask]]\ncue = \"surge\"\nfrequency = [1, 2]\nleast_gain = [1]\n") + kDrive),
      HasSubstr("has 1 values for 2 frequencies"));
}

/// A recorded drive of 10 s at 100 Hz in a file of `folder`; what is to be written into a study.
std::string recorded_drive(const test::TemporaryFolder& folder, const std::string& name, bool with_positions = false) {
  const std::filesystem::path file = folder.path() / name;
  std::ofstream out(file);
  out << "time[s],accel_x[m/s^2],accel_y[m/s^2],accel_z[m/s^2],gyro_x[rad/s],gyro_y[rad/s],gyro_z[rad/s]"
      << (with_positions ? ",pos_x[m],pos_y[m]\n" : "\n");
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.01 * k;
    out << t << "," << std::sin(t) << "," << std::cos(t) << ",9.81,0,0,0";
    if (with_positions) out << "," << 20.0 * t << ",0";
    out << "\n";
  }
  return "file = \"" + file.generic_string() + "\"\n";
}

TEST(CueingStudy, IsNamedAfterTheDriveThatIsScoredNotTheOneThatIsTunedOn) {
  const test::TemporaryFolder folder;
  const CueingStudy s = read("[cue]\n[data]\n" + recorded_drive(folder, "cueing_scored.csv") +
                             "[tune]\nevaluations = 1\n[tune.data]\n" + recorded_drive(folder, "cueing_tuned_on.csv"));
  EXPECT_FALSE(s.tune_on.empty());
  EXPECT_EQ(s.drive, "cueing_scored.csv");
}

TEST(CueingStudy, ForeseesFromTheDriverOrFromALap) {
  const test::TemporaryFolder folder;
  const std::string four_wheel =
      "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"four-wheel\"\nmanoeuvre = "
      "\"sine\"\namplitude = \"2 deg\"\nfrequency = \"0.3 Hz\"\nspeed = 15\nduration = 12\n";
  const std::string mpc = "[cue]\nalgorithms = [\"mpc\"]\noptimum = false\n";
  Progress progress;
  const auto account = [&](const CueingStudy& s) { return cue(s, progress).algorithms.front().run.account; };
  EXPECT_THAT(account(read(mpc + four_wheel)), Not(HasSubstr("foresaw")));
  const std::string by_driver = account(read(mpc + "foresee = \"driver\"\n" + four_wheel));
  EXPECT_THAT(by_driver, HasSubstr("the driver's steering and pedals foresaw 100 % of the time"));
  EXPECT_THAT(by_driver, Not(HasSubstr("misleads")));
  EXPECT_THAT(
      account(read(mpc + "[cue.vehicle]\nkind = \"vehicle\"\nbuiltin = \"reference\"\nmass = 1200\n" + four_wheel)),
      HasSubstr("steering and pedals foresaw"));

  const std::string lap = recorded_drive(folder, "cueing_lap.csv", true);
  const CueingStudy same = read(mpc + "[cue.lap]\n" + lap + "[data]\n" + lap);
  EXPECT_THAT(same.notes, Contains(HasSubstr("the lap cueing_lap.csv is also driven or tuned on")));
  EXPECT_THAT(account(same), HasSubstr("sway: the lap foresaw 100 %"));

  EXPECT_THAT(refusal(mpc + "[cue.lap]\n" + lap + "[data]\n" + recorded_drive(folder, "cueing_no_place.csv")),
              HasSubstr("rig.toml:4: cue.lap: is of no use: the drive has no positions"));
  EXPECT_THAT(refusal(mpc + "[cue.lap]\n" + recorded_drive(folder, "cueing_no_place.csv") + "[data]\n" + lap),
              HasSubstr("has no positions: channels pos_x and pos_y are needed"));
  EXPECT_THAT(refusal(mpc + "foresee = \"lap\"\n" + four_wheel), HasSubstr("needs a lap of the same track"));
  EXPECT_THAT(refusal(mpc + "foresee = \"driver\"\n[data]\n" + lap), HasSubstr("map a channel to `steer`"));
}

}  // namespace
}  // namespace veridyn::cueing
