#include "veridyn/report/figures/platform_figure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace veridyn::report {
namespace {

using cueing::Platform;
using cueing::PlatformAxis;
using cueing::PlatformState;
using testing::HasSubstr;
using testing::Not;

constexpr std::array kAxes = {PlatformAxis::kSurge, PlatformAxis::kSway,  PlatformAxis::kHeave,
                              PlatformAxis::kRoll,  PlatformAxis::kPitch, PlatformAxis::kYaw};

/// A run in which the platform is at `states`, one every 10 ms, for each of some algorithms.
cueing::CueingResult runs(const std::vector<PlatformState>& states, std::size_t algorithms = 1) {
  cueing::CueingResult result;
  for (std::size_t i = 0; i < algorithms; ++i) {
    cueing::AlgorithmResult a;
    a.run.algorithm = "algorithm " + std::to_string(i);
    for (std::size_t k = 0; k < states.size(); ++k) {
      a.run.vehicle.push_back({});
      a.run.vehicle.back().time = 5.0 + 0.01 * static_cast<double>(k);
      a.run.steps.push_back({.desired = {}, .ordered = {}, .reached = states[k]});
    }
    result.algorithms.push_back(std::move(a));
  }
  return result;
}

PlatformState at(PlatformAxis axis, double position) {
  PlatformState state;
  set_axis(state, axis, {.position = position});
  return state;
}

/// A point of the scene (forward, left, up) at a sample of the first motion: what the page does, by Eigen.
Eigen::Vector3d placed(const Scene& scene, const ScenePoint& point, std::size_t sample) {
  Eigen::Affine3d pose = Eigen::Affine3d::Identity();
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const SceneJoint& joint = scene.joints[j];
    const Eigen::Vector3d direction(joint.direction[0], joint.direction[1], joint.direction[2]);
    const double by = joint.scale * scene.motions.front().values[j][sample];
    if (joint.turns) {
      pose.rotate(Eigen::AngleAxisd(by, direction));
    } else {
      pose.translate(by * direction);
    }
  }
  const Eigen::Vector3d place(point.x, point.y, point.z);
  return point.moves ? Eigen::Vector3d(pose * place) : place;
}

std::vector<SceneShape> shapes_of(const Scene& scene, SceneShape::Kind kind) {
  std::vector<SceneShape> found;
  for (const SceneShape& shape : scene.shapes) {
    if (shape.kind == kind) found.push_back(shape);
  }
  return found;
}

TEST(PlatformFigure, MovesAsItsAxesAreCalled) {
  const Platform& hexapod = cueing::built_in_platform("hexapod");
  const double by = 0.1;
  const ScenePoint front{1.0, 0.0, 0.0, true}, right{0.0, -1.0, 0.0, true};
  const auto moved = [&](PlatformAxis axis, const ScenePoint& point) -> Eigen::Vector3d {
    const Scene scene = platform_figure(hexapod, runs({at(axis, 0.0), at(axis, by)}));
    return placed(scene, point, 1) - placed(scene, point, 0);
  };
  const double turned = std::sin(by);
  EXPECT_NEAR(moved(PlatformAxis::kSurge, front).x(), by, 1e-12);
  EXPECT_NEAR(moved(PlatformAxis::kSway, front).y(), -by, 1e-12) << "to the right";
  EXPECT_NEAR(moved(PlatformAxis::kHeave, front).z(), by, 1e-12) << "up";
  EXPECT_NEAR(moved(PlatformAxis::kRoll, right).z(), -turned, 1e-12) << "right side down";
  EXPECT_NEAR(moved(PlatformAxis::kPitch, front).z(), turned, 1e-12) << "nose up";
  EXPECT_NEAR(moved(PlatformAxis::kYaw, front).y(), -turned, 1e-12) << "nose to the right";
}

TEST(PlatformFigure, ItsActuatorsAreAsLongAsThePlatformsLegsInAnyPose) {
  std::mt19937 random(7);
  for (const char* name : {"three_axis", "hexapod"}) {
    const Platform& platform = cueing::built_in_platform(name);
    std::vector<PlatformState> states(1);
    for (int k = 0; k < 20; ++k) {
      PlatformState state;
      for (const PlatformAxis axis : kAxes) {
        const cueing::AxisLimits& limits = platform.limits[axis];
        if (limits.moves())
          set_axis(state, axis,
                   {.position = std::uniform_real_distribution(0.5 * limits.lowest, 0.5 * limits.highest)(random)});
      }
      states.push_back(state);
    }
    const Scene scene = platform_figure(platform, runs(states));
    const cueing::Legs legs(*platform.legs, platform.limits);
    const std::vector<SceneShape> actuators = shapes_of(scene, SceneShape::Kind::kActuator);
    ASSERT_EQ(actuators.size(), static_cast<std::size_t>(legs.count()));
    for (std::size_t k = 1; k < states.size(); ++k) {
      const cueing::Legs::Lengths lengths = legs.lengths(states[k]);
      for (std::size_t i = 0; i < actuators.size(); ++i) {
        const auto length = [&](std::size_t sample) {
          return (placed(scene, actuators[i].points[1], sample) - placed(scene, actuators[i].points[0], sample)).norm();
        };
        EXPECT_NEAR(length(k) - length(0), lengths.position(i), 1e-12) << name;
      }
    }
  }
}

TEST(PlatformFigure, HoldsNoMoreNumbersThanItMayAndBothEnds) {
  std::vector<PlatformState> states;
  for (int k = 0; k <= 9000; ++k) states.push_back(at(PlatformAxis::kHeave, 1e-5 * k));
  const Scene scene = platform_figure(cueing::built_in_platform("three_axis"), runs(states, 9));
  ASSERT_EQ(scene.motions.size(), 9U);
  ASSERT_EQ(scene.joints.size(), 3U);
  EXPECT_LE(scene.samples.size() * 27, 20000U);
  EXPECT_GT(scene.samples.size() * 27, 19000U);
  EXPECT_EQ(scene.samples.front(), 5.0);
  EXPECT_EQ(scene.samples.back(), 95.0);
  for (std::size_t k = 0; k < scene.samples.size(); ++k)
    EXPECT_NEAR(scene.motions[8].values[0][k], scene.samples[k] - 5.0, 1e-9) << "heave [mm]";
  EXPECT_THAT(scene.caption, HasSubstr("740 in all"));
}

TEST(PlatformFigure, LeavesAShortRunAsItIs) {
  const Scene scene =
      platform_figure(cueing::built_in_platform("three_axis"), runs({at(PlatformAxis::kRoll, 0.1), PlatformState{}}));
  EXPECT_EQ(scene.samples, (std::vector<double>{5.0, 5.01}));
  EXPECT_THAT(scene.caption, Not(HasSubstr("in all")));
}

TEST(PlatformFigure, ShowsAPlatformWithoutLegsAndARiderLowInIt) {
  Platform platform = cueing::built_in_platform("ideal");
  platform.rider = {0.1, 0.0, 0.3};
  const Scene scene = platform_figure(platform, runs({PlatformState{}}));
  check({.sections = {{.title = "s", .blocks = {scene}}}});
  EXPECT_EQ(scene.joints.size(), 6U);
  EXPECT_EQ(shapes_of(scene, SceneShape::Kind::kActuator).size(), 1U);
  const std::vector<SceneShape> balls = shapes_of(scene, SceneShape::Kind::kBall);
  ASSERT_EQ(balls.size(), 1U) << "the rider's head";
  EXPECT_EQ(balls[0].points[0].z, -0.3);
}

}  // namespace
}  // namespace veridyn::report
