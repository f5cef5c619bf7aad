#include "veridyn/cueing/cueing_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

using ::testing::HasSubstr;

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

/// A recorded drive of 10 s at 100 Hz in a file of its own; what is to be written into a study.
std::string recorded_drive(const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / name;
  std::ofstream out(file);
  out << "time[s],accel_x[m/s^2],accel_y[m/s^2],accel_z[m/s^2],gyro_x[rad/s],gyro_y[rad/s],gyro_z[rad/s]\n";
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.01 * k;
    out << t << "," << std::sin(t) << "," << std::cos(t) << ",9.81,0,0,0\n";
  }
  return "file = \"" + file.generic_string() + "\"\n";
}

TEST(CueingStudy, IsNamedAfterTheDriveThatIsScoredNotTheOneThatIsTunedOn) {
  const CueingStudy s = read("[cue]\n[data]\n" + recorded_drive("cueing_scored.csv") +
                             "[tune]\nevaluations = 1\n[tune.data]\n" + recorded_drive("cueing_tuned_on.csv"));
  EXPECT_FALSE(s.tune_on.empty());
  EXPECT_EQ(s.drive, "cueing_scored.csv");
}

}  // namespace
}  // namespace veridyn::cueing
