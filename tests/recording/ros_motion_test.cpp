#include "veridyn/recording/ros_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/ros_recording.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::recording {
namespace {

using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::RosRecording;

const std::vector<Eigen::Vector3d> kForces{{0.5, 0.1, 9.7}, {0.4, -0.2, 9.9}}, kRates{{0.1, 0.2, 0.3}, {0, 0.1, 0.2}};

void add_imu(RosRecording& made, const std::string& name, const std::string& frame, const Eigen::Matrix3d& R) {
  std::vector<Eigen::Vector3d> forces, rates;
  for (const auto& f : kForces) forces.push_back(R * f);
  for (const auto& w : kRates) rates.push_back(R * w);
  made.topic(name, "sensor_msgs/msg/Imu", frame);
  made.vectors(".linear_acceleration", "m/s^2", forces).vectors(".angular_velocity", "rad/s", rates);
}

TEST(RosMotion, TurnsAnImuIntoBaseLink) {
  RosRecording made(2);
  const Eigen::Matrix3d R_base_from_imu = Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()).toRotationMatrix() *
                                          Eigen::AngleAxisd(0.5 * kPi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  add_imu(made, "imu", "imu_link", R_base_from_imu.transpose());
  const Eigen::Quaterniond q(R_base_from_imu);
  made.transform("base_link", "imu_link",
                 "0 0 0 " + std::to_string(q.x()) + " " + std::to_string(q.y()) + " 0 " + std::to_string(q.w()));
  // On level ground, the car points 30 deg to the left of east.
  const Eigen::Matrix3d R_world_from_base = Eigen::AngleAxisd(kPi / 6.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  made.attitudes(".orientation", {R_world_from_base * R_base_from_imu,
                                  R_world_from_base * R_base_from_imu *
                                      Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()).toRotationMatrix()});
  const RosMotion motion = ros_motion(made.log());
  EXPECT_THAT(motion.notes, IsEmpty());
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR(motion.specific_force->value[axis][k], kForces[k](static_cast<Eigen::Index>(axis)), 1e-5);
      EXPECT_NEAR(motion.rates->value[axis][k], kRates[k](static_cast<Eigen::Index>(axis)), 1e-5);
    }
  EXPECT_NEAR(motion.attitude->yaw[0], kPi / 6.0, 1e-5);
  EXPECT_NEAR(motion.attitude->roll[0], 0.0, 1e-5);
  EXPECT_NEAR(motion.attitude->pitch[0], 0.0, 1e-5);
}

TEST(RosMotion, LeavesOutAnImuThatIsNotInTheseAxes) {
  RosRecording upside(2);
  add_imu(upside, "imu", "base_link", Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX()).toRotationMatrix());
  const RosMotion motion = ros_motion(upside.log());
  EXPECT_FALSE(motion.specific_force || motion.rates || motion.attitude);
  EXPECT_THAT(motion.notes, ElementsAre(HasSubstr("imu is left out: its upward acceleration has a median of -9.8")));
}

TEST(RosMotion, NotesWhatItTakesForGranted) {
  RosRecording made(2);
  add_imu(made, "imu", "imu_link", Eigen::Matrix3d::Identity());
  add_imu(made, "other", "base_link", Eigen::Matrix3d::Identity());
  const RosMotion motion = ros_motion(made.log());
  EXPECT_THAT(motion.notes, Contains("motion of imu, not of other: [data.map] takes others"));
  EXPECT_THAT(motion.notes, Contains(HasSubstr("the axes of imu, frame imu_link, are taken for those of base_link")));
}

RosRecording with_odometry() {
  RosRecording made(2);
  made.topic("odom", "nav_msgs/msg/Odometry", "odom", "base_link");
  made.vectors(".twist.twist.linear", "m/s", {{10, 0, 0}, {11, 1, 0}});
  made.vectors(".twist.twist.angular", "rad/s", {{0, 0, 0.1}, {0, 0, 0.2}});
  made.vectors(".pose.pose.position", "m", {{0, 0, 0}, {1, 2, 0}});
  made.attitudes(".pose.pose.orientation", {Eigen::AngleAxisd(0.5 * kPi, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                                            Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ()).toRotationMatrix()});
  return made;
}

TEST(RosMotion, TurnsTheVelocityOfAnOdometryIntoTheWorldByItsOwnAttitude) {
  const RosMotion motion = ros_motion(with_odometry().log());
  EXPECT_TRUE(motion.odometry_attitude);
  EXPECT_FALSE(motion.receiver_velocity);
  EXPECT_THAT(motion.velocity_body->value[0], ElementsAre(10.0, 11.0));
  EXPECT_THAT(motion.velocity_world->value[0], ElementsAre(DoubleNear(0.0, 1e-12), DoubleNear(-11.0, 1e-12)));
  EXPECT_THAT(motion.velocity_world->value[1], ElementsAre(DoubleNear(10.0, 1e-12), DoubleNear(-1.0, 1e-12)));
  EXPECT_THAT(motion.rates->value[2], ElementsAre(0.1, 0.2));
  EXPECT_THAT(motion.attitude->yaw, ElementsAre(DoubleNear(0.5 * kPi, 1e-12), DoubleNear(kPi, 1e-12)));
}

TEST(RosMotion, TakesAReceiversVelocityAndNoCommand) {
  RosRecording made = with_odometry();
  add_imu(made, "imu", "base_link", Eigen::Matrix3d::Identity());
  made.attitudes(".orientation",
                 {Eigen::Matrix3d::Identity(), Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()).toRotationMatrix()});
  made.topic("cmd_vel_stamped", "geometry_msgs/msg/TwistStamped", "map")
      .vectors(".twist.linear", "m/s", {{9, 9, 9}, {8, 8, 8}});
  made.topic("fix_velocity", "geometry_msgs/msg/TwistWithCovarianceStamped", "gps");
  made.vectors(".twist.twist.linear", "m/s", {{3, 4, 0}, {4, 5, 0.5}});
  made.topic("unnamed", "geometry_msgs/msg/TwistStamped").vectors(".twist.linear", "m/s", {{7, 7, 7}, {8, 8, 8}});
  const RosMotion motion = ros_motion(made.log());
  EXPECT_TRUE(motion.receiver_velocity);
  EXPECT_EQ(motion.velocity_world->source, "fix_velocity.twist.twist.linear");
  EXPECT_THAT(motion.velocity_world->value[1], ElementsAre(4.0, 5.0));
  EXPECT_FALSE(motion.odometry_attitude) << "east is the Imu's, not the Odometry's";
  EXPECT_NEAR(motion.attitude->yaw[1], 0.2, 1e-12);
}

}  // namespace
}  // namespace veridyn::recording
