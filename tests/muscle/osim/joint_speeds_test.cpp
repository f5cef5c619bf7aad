#include "veridyn/muscle/osim/joint_speeds.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>

#include "tests/muscle/muscle_studies.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/study/muscle_run.hpp"

// That these are Simbody's speeds is a test of every kind of joint in tests/muscle/dynamics/simbody_test.cpp.
namespace veridyn::muscle {
namespace {

using test::read_muscle_study;
using test::study_error;
using testing::HasSubstr;

/// A body on a ball, with default angles and OpenSim's default speeds.
std::string ball(const Eigen::Vector3d& angles, const Eigen::Vector3d& speeds) {
  std::string coordinates;
  for (Eigen::Index i = 0; i < 3; ++i)
    coordinates += fmt::format(
        "<Coordinate name=\"a{}\"><default_value>{}</default_value><default_speed_value>{}"
        "</default_speed_value></Coordinate>",
        i, angles(i), speeds(i));
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<OpenSimDocument Version=\"40000\"><Model name=\"m\">\n"
      "<BodySet><objects><Body name=\"link\"><mass>1</mass><inertia>1 1 1 0 0 0</inertia></Body></objects></BodySet>\n"
      "<JointSet><objects><BallJoint name=\"joint\"><socket_parent_frame>/ground</socket_parent_frame>"
      "<socket_child_frame>/bodyset/link</socket_child_frame><coordinates>{}</coordinates></BallJoint></objects>"
      "</JointSet></Model></OpenSimDocument>\n",
      coordinates);
}

Eigen::Matrix3d rotation(const Eigen::Vector3d& a) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return (AngleAxisd(a(0), Vector3d::UnitX()) * AngleAxisd(a(1), Vector3d::UnitY()) *
          AngleAxisd(a(2), Vector3d::UnitZ()))
      .toRotationMatrix();
}

/// Of the rotation itself: R' = [w] R.
Eigen::Vector3d turn_rate(const Eigen::Vector3d& angles, const Eigen::Vector3d& rates) {
  constexpr double kStep = 1e-6;
  const Eigen::Matrix3d W = (rotation(angles + kStep * rates) - rotation(angles - kStep * rates)) / (2.0 * kStep) *
                            rotation(angles).transpose();
  return {W(2, 1), W(0, 2), W(1, 0)};
}

const Eigen::Vector3d kAngles(0.4, -0.7, 1.1), kSpeeds(2.0, -1.0, 3.0);

TEST(JointSpeeds, OfABallAreItsAngularVelocity) {
  const Model model = OsimFile::parse(ball(kAngles, Eigen::Vector3d::Zero()), "ball.osim").model();
  const Eigen::Vector3d rates(0.5, 1.5, -2.5);
  const Eigen::VectorXd speeds = opensim_speeds(model, kAngles, rates);
  EXPECT_LT((speeds - turn_rate(kAngles, rates)).norm(), 1e-8);
  EXPECT_LT((rates_of_opensim_speeds(model, kAngles, speeds) - rates).norm(), 1e-14);
}

TEST(JointSpeeds, DefaultsAreReadAsOpenSims) {
  const Model model = OsimFile::parse(ball(kAngles, kSpeeds), "ball.osim").model();
  const Eigen::Vector3d rates = default_start(model).qdot;
  EXPECT_LT((turn_rate(kAngles, rates) - kSpeeds).norm(), 1e-8);
  // Where the second angle is 90 deg there are no such rates, but rest is rest.
  const Eigen::Vector3d singular(0.4, 0.5 * kPi, 0.0);
  EXPECT_EQ(OsimFile::parse(ball(singular, Eigen::Vector3d::Zero()), "ball.osim").model().coordinates[1].default_speed,
            0.0);
  try {
    static_cast<void>(OsimFile::parse(ball(singular, kSpeeds), "ball.osim"));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("ball.osim: default_speed_value"));
    EXPECT_THAT(error.what(), HasSubstr("joint 'joint' has a second angle of 1.5708 rad"));
  }
}

class SpeedsInFiles : public testing::Test {
 protected:
  SpeedsInFiles() { std::ofstream(folder_ / "ball.osim") << ball(kAngles, kSpeeds); }
  [[nodiscard]] static std::string study(const std::string& motion) {
    return "[subject]\nmodel = \"ball.osim\"\n[motion]\nduration = 0.2\n" + motion;
  }
  /// A study that starts in a file.
  [[nodiscard]] std::string from(const std::string& file, const std::string& content) const {
    std::ofstream(folder_ / file) << content;
    return study("start_file = \"" + file + "\"\n");
  }
  veridyn::test::TemporaryFolder scratch_;
  std::filesystem::path folder_ = scratch_.path();
};

TEST_F(SpeedsInFiles, OfStatesAreOpenSimsAndOfTablesRates) {
  const std::string storage = "states\nversion=1\ninDegrees=no\nendheader\n";
  const std::string row = "\n0\t0.1\t0.2\t0.3\t1\t2\t3\n1\t0.1\t0.2\t0.3\t1\t2\t3\n";
  const Eigen::Vector3d angles(0.1, 0.2, 0.3), given(1.0, 2.0, 3.0);
  const std::string values = "time\t/jointset/joint/a0/value\t/jointset/joint/a1/value\t/jointset/joint/a2/value";
  for (const std::string& columns :
       {values + "\t/jointset/joint/a0/speed\t/jointset/joint/a1/speed\t/jointset/joint/a2/speed",
        std::string("time\ta0\ta1\ta2\ta0_u\ta1_u\ta2_u")}) {
    const MuscleStudy read = read_muscle_study(from("states.sto", storage + columns + row), folder_);
    EXPECT_LT((turn_rate(angles, read.start.qdot) - given).norm(), 1e-8) << columns;
  }
  const MuscleStudy table =
      read_muscle_study(from("states.csv",
                             "time[s],a0[rad],a1[rad],a2[rad],a0_speed[rad/s],a1_speed[rad/s],a2_speed[rad/s]\n"
                             "0,0.1,0.2,0.3,1,2,3\n1,0.1,0.2,0.3,1,2,3\n"),
                        folder_);
  EXPECT_EQ(Eigen::Vector3d(table.start.qdot), given);
  // Without speeds the body turns as the model has it by default.
  const MuscleStudy pose = read_muscle_study(from("pose.sto", storage + "time\ta0\ta1\ta2\n0\t0.1\t0.2\t0.3\n"
                                                                        "1\t0.1\t0.2\t0.3\n"),
                                             folder_);
  EXPECT_LT((turn_rate(angles, pose.start.qdot) - kSpeeds).norm(), 1e-8);
  EXPECT_THAT(
      study_error(from("up.sto", storage + "time\ta1\ta2_u\n0\t1.5707963267949\t1\n1\t1.5707963267949\t1\n"), folder_),
      HasSubstr("no rates of its angles"));
}

TEST_F(SpeedsInFiles, WrittenAreOpenSimsAndReadBackTheyAreTheSameState) {
  const MuscleStudy read = read_muscle_study(study(""), folder_);
  Progress progress;
  const MuscleResult result = run_study(read, progress);
  const io::Storage states = state_storage(read, result);
  const auto last = static_cast<Eigen::Index>(result.trajectory.time.size()) - 1;
  const Eigen::Vector3d q = result.trajectory.q.row(last), rates = result.trajectory.qdot.row(last);
  const Eigen::Vector3d w(states.column(1).back(), states.column(3).back(), states.column(5).back());
  ASSERT_EQ(states.labels[3], "/jointset/joint/a1/speed");
  EXPECT_LT((w - turn_rate(q, rates)).norm(), 1e-8);
  // No moment acts on the equal inertias: the angular velocity stays, though the rates change.
  EXPECT_LT((w - kSpeeds).norm(), 1e-4);
  EXPECT_GT((rates - Eigen::Vector3d(read.start.qdot)).norm(), 0.1);
}

}  // namespace
}  // namespace veridyn::muscle
