#include "veridyn/muscle/path/muscle_path.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include "tests/muscle/path/believable_arms.hpp"
#include "tests/muscle/path/posed_arm.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"

namespace veridyn::muscle {
namespace {

using test::PosedArm;

#define SKIP_WITHOUT_MODELS()                                                    \
  if (!std::filesystem::exists(veridyn::test::shared_folder() / "data/opensim")) \
  GTEST_SKIP() << "the OpenSim models of ../shared/data are not here"

Model arm26() { return read_osim(veridyn::test::shared_folder() / "data/opensim/arm26.osim"); }

/// Largest difference between dL/dq and central differences over the poses.
void expect_differences(PosedArm& arm, const std::vector<Eigen::VectorXd>& poses, double tolerance) {
  for (const Eigen::VectorXd& q : poses) {
    arm.pose(q);
    const std::vector<double> gradient = arm.workspace.gradient;
    for (int c = 0; c < arm.paths.coordinates(); ++c) {
      const double h = 1e-5;
      Eigen::VectorXd up = q, down = q;
      up[c] += h;
      down[c] -= h;
      arm.pose(up);
      const std::vector<double> longer = arm.workspace.length;
      arm.pose(down);
      std::vector<double> slope(longer.size());
      for (std::size_t m = 0; m < slope.size(); ++m) slope[m] = (longer[m] - arm.workspace.length[m]) / (2.0 * h);
      for (std::size_t k = 0; k < gradient.size(); ++k) {
        if (arm.paths.pairs()[k].coordinate != c) continue;
        const auto m = static_cast<std::size_t>(arm.paths.pairs()[k].muscle);
        EXPECT_NEAR(gradient[k], slope[m], tolerance)
            << arm.model.muscles[m].name() << " about " << arm.model.coordinates[c].name << " at " << q.transpose();
        slope[m] = 0.0;
      }
      for (const double left : slope) EXPECT_NEAR(left, 0.0, tolerance);  // no pair is missing
    }
  }
}

// Poses left out: TRIlong where OpenSim wraps over TRIlongglen and TRIlonghh at once. From shoulder 70.85 to 144.6 deg
// its path is one that it enters and leaves with jumps of 2.7 and 7.9 mm.
bool opensim_jumps(const std::string& muscle, double shoulder) {
  return muscle == "TRIlong" && shoulder > 70.85 && shoulder < 144.6;
}

// BIClong's second point lies inside the humeral head from shoulder 31.35 to 91.1 deg. OpenSim drops the wrap there,
// with jumps of 1.7 and 0.13 mm; ours lifts the point, by up to 1.7 mm.
bool opensim_drops_the_wrap(const std::string& muscle, double shoulder) {
  return muscle == "BIClong" && shoulder > 31.3 && shoulder < 91.15;
}

/// Where a length of arm26 differs by more than 1e-4 m from OpenSim's, and by how much: TRIlong lets go of the end of
/// its cylinder, onto which OpenSim's path jumps at 41.65 deg; BIClong's length has a spike in OpenSim near -78.4 deg,
/// and see `opensim_drops_the_wrap`.
double most_off(const std::string& muscle, double shoulder) {
  if (muscle == "TRIlong" && shoulder > 30.4 && shoulder < 41.65) return 1.9e-3;
  if (muscle == "BIClong" && shoulder > -79.5 && shoulder < -78.2) return 9e-4;
  if (opensim_drops_the_wrap(muscle, shoulder)) return 1.7e-3;
  return 1e-4;
}

// OpenSim's are those of the comparison mode, which bench/peers compares with OpenSim itself.
TEST(MusclePaths, OfArm26DifferFromTheComparisonModeWhereTheDocumentationSaysSo) {
  SKIP_WITHOUT_MODELS();
  PosedArm ours(arm26()), theirs(arm26(), WrapMode::kAsOpenSim);
  std::map<std::string, double> largest;
  for (int step = 0; step <= 1080; ++step) {
    const double shoulder = -90.0 + 0.25 * step;
    for (const double elbow : {0.0, 65.0, 130.0}) {
      ours.pose_deg(shoulder, elbow);
      theirs.pose_deg(shoulder, elbow);
      for (int m = 0; m < ours.paths.muscles(); ++m) {
        const std::string& name = ours.model.muscles[static_cast<std::size_t>(m)].name();
        if (opensim_jumps(name, shoulder)) continue;
        const double off = std::abs(ours.workspace.length[m] - theirs.workspace.length[m]);
        EXPECT_LT(off, most_off(name, shoulder)) << name << " at " << shoulder << ", " << elbow;
        largest[name] = std::max(largest[name], off);
      }
    }
  }
  EXPECT_GT(largest["TRIlong"], 1.7e-3);
  EXPECT_GT(largest["BIClong"], 1.5e-3);
}

TEST(MusclePaths, OfArm26AreContinuousInBothJoints) {
  SKIP_WITHOUT_MODELS();
  PosedArm arm(arm26());
  // The trapezoidal rule with dL/dq at both ends of a step leaves a jump whole, and of a kink at most a quarter of the
  // change of dL/dq times the step: 2.8e-5 m here.
  constexpr double kStepDeg = 0.125, kJump = 5e-5;
  for (const double fixed : {0.0, 60.0, 120.0}) {
    for (const int moving : {0, 1}) {
      std::vector<double> length(6), arms(6);
      const int steps = static_cast<int>((moving == 0 ? 270.0 : 130.0) / kStepDeg);
      for (int i = 0; i <= steps; ++i) {
        const double angle = (moving == 0 ? -90.0 : 0.0) + kStepDeg * i;
        moving == 0 ? arm.pose_deg(angle, fixed) : arm.pose_deg(fixed, angle);
        for (int m = 0; m < arm.paths.muscles(); ++m) {
          const double now = arm.workspace.length[m], arm_now = arm.moment_arm(m, moving);
          if (i > 0) {
            EXPECT_NEAR(now - length[m], -0.5 * (arms[m] + arm_now) * kStepDeg * kDegree, kJump)
                << arm.model.muscles[m].name() << " at " << angle << ", the other " << fixed;
          }
          length[m] = now;
          arms[m] = arm_now;
        }
      }
    }
  }
}

TEST(MusclePaths, MomentArmsOfArm26AreTheDerivativesOfItsLengths) {
  SKIP_WITHOUT_MODELS();
  PosedArm arm(arm26());
  std::vector<Eigen::VectorXd> poses;
  for (double s = -90.0; s < 180.0; s += 3.1)
    for (const double e : {5.0, 50.0, 110.0}) poses.push_back(Eigen::Vector2d(s * kDegree, e * kDegree));
  expect_differences(arm, poses, 3e-7);
}

/// Random poses over the whole ranges: no arm sticks out of those within 1 deg of it along a coordinate by half or
/// more, and arms are the slopes of lengths but where a side change is named.
void expect_believable_arms(const Model& model, int poses) {
  const test::ArmCounts counts = test::count_arms(model, poses);
  testing::Test::RecordProperty(
      model.name, fmt::format("{}: {} stick out, {} are no slopes, {} of them "
                              "unnamed, largest {:.1f} mm",
                              counts.arms, counts.stick_out, counts.no_slope, counts.unnamed, 1e3 * counts.largest));
  EXPECT_GT(counts.arms, poses);
  EXPECT_EQ(counts.stick_out, 0) << counts.where;
  EXPECT_EQ(counts.unnamed, 0) << counts.where;
  EXPECT_LE(counts.no_slope, poses / 300);
}

TEST(MusclePaths, OfArm26HaveArmsThatNeverStickOut) {
  SKIP_WITHOUT_MODELS();
  expect_believable_arms(arm26(), 3000);
}

TEST(MusclePaths, OfTheOtherModelsHaveArmsThatNeverStickOut) {
  expect_believable_arms(load_model("arm").model(), 3000);
  SKIP_WITHOUT_MODELS();
  for (const char* file :
       {"leg6dof9musc.osim", "gait10dof18musc.osim", "gait2354_simbody.osim", "gait2392_thelen2003muscle.osim"})
    expect_believable_arms(read_osim(veridyn::test::shared_folder() / "data/opensim" / file), 300);
}

/// A muscle over two cylinders as the gastrocnemius of gait models has them, on the proximal bone behind the joint and
/// on the distal one `shank_below` it [m]; and the same with a point that dips into the first.
Model over_two_cylinders(double shank_below) {
  Model model = load_model("arm").model();
  const int humerus = model.body("humerus"), forearm = model.body("forearm");
  const Eigen::Vector3d elbow = model.joints[1].parent_frame.translation;
  const auto cylinder = [&](const char* name, int body, const Eigen::Vector3d& at, double radius) {
    WrapObject object;
    object.name = name;
    object.shape = WrapShape::kCylinder;
    object.body = body;
    object.placement.translation = at;
    object.dimensions = {radius, 0.2, 0.0};
    model.wrap_objects.push_back(object);
    return static_cast<int>(model.wrap_objects.size()) - 1;
  };
  const int condyle = cylinder("condyle", humerus, elbow, 0.025);
  const int shank = cylinder("shank", forearm, Eigen::Vector3d(0.0, -shank_below, 0.0), 0.028);
  Muscle gastrocnemius = model.muscles[model.muscle("brachialis")];
  gastrocnemius.parameters.name = "gastrocnemius";
  const auto point = [](const char* name, int body, const Eigen::Vector3d& at) {
    PathPoint p;
    p.name = name;
    p.body = body;
    p.location = at;
    return p;
  };
  const auto wrap = [](int object) {
    PathWrap w;
    w.object = object;
    return w;
  };
  gastrocnemius.points = {point("origin", humerus, elbow + Eigen::Vector3d(0.02, 0.03, 0.01)),
                          point("heel", forearm, {0.03, -0.2, -0.01})};
  gastrocnemius.wraps = {wrap(condyle), wrap(shank)};
  Muscle dipping = gastrocnemius;
  dipping.parameters.name = "dipping";
  // On the forearm, so that it goes into the condyle and comes out of it as the joint turns.
  dipping.points.insert(dipping.points.begin() + 1, point("via", forearm, {0.022, 0.004, 0.004}));
  model.muscles = {gastrocnemius, dipping};
  return model;
}

TEST(MusclePaths, OverTwoCylindersAndWithAnEndThatDipsInHaveArmsThatNeverStickOut) {
  const Model model = over_two_cylinders(0.05);
  expect_believable_arms(model, 1000);
  PosedArm arm(model);
  const int m = 0;
  int touches = 0;
  for (double e = 0.0; e < 130.0; e += 5.0) {
    arm.pose_deg(0.0, e);
    touches = std::max(touches, static_cast<int>(arm.paths.touched(arm.kinematics, arm.q.data(), m).size()));
  }
  EXPECT_EQ(touches, 2);
}

TEST(MusclePaths, OverTwoCylindersThatCrossHaveArmsThatNeverStickOut) {
  for (const double shank_below : {0.03, 0.015, 0.0}) expect_believable_arms(over_two_cylinders(shank_below), 1000);
}

TEST(MusclePaths, OfTheBuiltInArmHaveMomentArmsThatAreDerivatives) {
  PosedArm arm(load_model("arm").model());
  std::vector<Eigen::VectorXd> poses;
  for (double s = -60.0; s < 130.0; s += 13.7)
    for (double e = 3.0; e < 130.0; e += 17.3) poses.push_back(Eigen::Vector2d(s * kDegree, e * kDegree));
  expect_differences(arm, poses, 3e-7);
}

TEST(MusclePaths, MovingPointsStayWhereTheRangeOfTheirCoordinateEnds) {
  Model model = load_model("arm").model();
  const int m = model.muscle("brachialis");
  model.muscles[m].wraps.clear();
  PathPoint& point = model.muscles[m].points[0];
  const Eigen::Vector3d home = point.location;
  point.kind = PathPointKind::kMoving;
  point.moving_coordinate = {1, -1, -1};
  point.moving_location = {numerics::PiecewisePolynomial::linear(0.02, home.x()),
                           numerics::PiecewisePolynomial::constant(home.y()),
                           numerics::PiecewisePolynomial::constant(home.z())};
  PosedArm moving(model);
  for (const double q : {model.coordinates[1].low - 0.3, 1.0, model.coordinates[1].high + 0.2}) {
    const double clamped = std::clamp(q, model.coordinates[1].low, model.coordinates[1].high);
    Model fixed_model = model;
    fixed_model.muscles[m].points[0].kind = PathPointKind::kFixed;
    fixed_model.muscles[m].points[0].location = home + Eigen::Vector3d(0.02 * clamped, 0.0, 0.0);
    PosedArm fixed(fixed_model);
    moving.pose(Eigen::Vector2d(0.3, q));
    fixed.pose(Eigen::Vector2d(0.3, q));
    EXPECT_NEAR(moving.workspace.length[m], fixed.workspace.length[m], 1e-15) << q;
    // Beyond the range it does not move: the arm is that of a fixed point too.
    EXPECT_EQ(std::abs(moving.moment_arm(m, 1) - fixed.moment_arm(m, 1)) < 1e-15, q != clamped) << q;
  }
  expect_differences(moving, {Eigen::Vector2d(0.1, -0.3), Eigen::Vector2d(0.1, 1.1), Eigen::Vector2d(0.1, 2.5)}, 1e-9);
}

// OpenSim leaves an inactive point out wherever it stands.
TEST(MusclePaths, ThatBeginAndEndWithConditionalPointsBeginAndEndWithTheNextOneThere) {
  Model model = load_model("arm").model();
  const int m = model.muscle("brachialis");
  const int humerus = model.body("humerus"), forearm = model.body("forearm");
  const std::array<Eigen::Vector3d, 4> at{Eigen::Vector3d(0.03, 0.02, 0.01), Eigen::Vector3d(0.02, -0.1, 0.0),
                                          Eigen::Vector3d(0.02, -0.03, 0.0), Eigen::Vector3d(0.01, -0.07, 0.02)};
  for (const bool wrapping : {false, true}) {
    Model made = model;
    Muscle& muscle = made.muscles[m];
    muscle.points.resize(4);
    for (std::size_t i = 0; i < 4; ++i) {
      PathPoint& point = muscle.points[i];
      point = {};
      point.name = fmt::format("p{}", i);
      point.body = i < 2 ? humerus : forearm;
      point.location = at[i];
      if (i == 1 || i == 2) continue;
      point.kind = PathPointKind::kConditional;
      point.coordinate = 1;
      point.low = i == 0 ? 0.5 : -10.0;
      point.high = i == 0 ? 10.0 : 1.5;
    }
    // With an object far away the path is solved as those that wrap are.
    muscle.wraps.resize(wrapping ? 1 : 0);
    if (wrapping) {
      muscle.wraps[0] = {};
      muscle.wraps[0].object = static_cast<int>(made.wrap_objects.size());
      WrapObject far;
      far.name = "far";
      far.shape = WrapShape::kSphere;
      far.body = humerus;
      far.placement.translation = {5.0, 0.0, 0.0};
      far.dimensions = {0.01, 0.0, 0.0};
      made.wrap_objects.push_back(far);
    }
    PosedArm arm(made);
    for (const double elbow : {0.2, 1.0, 2.0}) {
      arm.pose(Eigen::Vector2d(0.3, elbow));
      std::array<Eigen::Vector3d, 4> x;
      for (std::size_t i = 0; i < 4; ++i) {
        const Mechanism::BodyPlace& place = arm.mechanism.body(i < 2 ? humerus : forearm);
        x[i] = arm.kinematics.pose[place.link] * (place.in_link * at[i]);
      }
      double length = (x[2] - x[1]).norm();
      if (elbow > 0.5) length += (x[1] - x[0]).norm();
      if (elbow < 1.5) length += (x[3] - x[2]).norm();
      EXPECT_NEAR(arm.workspace.length[m], length, 1e-15) << elbow << " " << wrapping;
    }
    expect_differences(arm, {Eigen::Vector2d(0.3, 0.2), Eigen::Vector2d(0.3, 1.0), Eigen::Vector2d(0.3, 2.0)}, 1e-9);
  }
}

TEST(MusclePaths, RefuseWhatIsNotAPath) {
  const auto error = [](const auto& spoil) -> std::string {
    Model model = load_model("arm").model();
    spoil(model);
    try {
      const Mechanism mechanism(model);
      const MusclePaths paths(model, mechanism);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error([](Model& m) { m.muscles[1].points.resize(1); }), ::testing::HasSubstr("at least two points"));
  EXPECT_THAT(error([](Model& m) { m.muscles[0].points[1].body = 99; }), ::testing::HasSubstr("fixed to no body"));
  EXPECT_THAT(error([](Model& m) { m.wrap_objects[0].dimensions[0] = -1.0; }),
              ::testing::HasSubstr("must be positive"));
}

}  // namespace
}  // namespace veridyn::muscle
