#include "veridyn/muscle/simulation/pose_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> found;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) found.push_back(cell);
  return found;
}

TEST(PoseTable, ReadsAPoseFromATextWithUnits) {
  const Model model = load_model("arm").model();
  const PoseTable poses = read_poses(model, "elbow_flexion=90 deg, shoulder_flexion = 0.3");
  ASSERT_EQ(poses.q.size(), 1u);
  EXPECT_TRUE(poses.time.empty());
  EXPECT_DOUBLE_EQ(poses.q[0](0), 0.3);
  EXPECT_DOUBLE_EQ(poses.q[0](1), kPi / 2.0);
  EXPECT_TRUE(poses.qdot[0].isZero(0.0));
}

TEST(PoseTable, ErrorsNameTheCoordinate) {
  const Model model = load_model("arm").model();
  const auto error = [&](const std::string& text) -> std::string {
    try {
      (void)read_poses(model, text);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error("elbow_flexio=1"), HasSubstr("did you mean 'elbow_flexion'"));
  EXPECT_THAT(error("elbow_flexion=4"), HasSubstr("'elbow_flexion' = 4 rad is outside its range"));
  EXPECT_THAT(error("elbow_flexion=x"), HasSubstr("'x' is not a number for coordinate 'elbow_flexion'"));
  EXPECT_THAT(error("elbow_flexion=1 kg"), HasSubstr("coordinate 'elbow_flexion'"));
  EXPECT_THAT(error("no_such_file"), HasSubstr("neither a file nor NAME=VALUE"));
}

/// The built-in arm, its elbow turning with the shoulder at half its angle.
Model coupled_arm() {
  Model model = load_model("arm").model();
  model.couplers.push_back({"half", 0, 1, numerics::PiecewisePolynomial::linear(0.5, 0.0)});
  return model;
}

TEST(PoseTable, AGivenValueOfACoupledCoordinateIsNeverReplacedInSilence) {
  const Model model = coupled_arm();
  EXPECT_DOUBLE_EQ(read_poses(model, "shoulder_flexion=0.4").q[0](1), 0.2);
  EXPECT_DOUBLE_EQ(read_poses(model, "elbow_flexion=0.2, shoulder_flexion=0.4").q[0](1), 0.2);
  try {
    (void)read_poses(model, "shoulder_flexion=0.4, elbow_flexion=0.3");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("coordinate 'elbow_flexion' = 0.3 rad follows 'shoulder_flexion' through a "
                                        "coupler, which gives 0.2 rad"));
  }
}

TEST(PoseTable, AFilesValuesOfACoupledCoordinateAreComparedWithItsCoupler) {
  const veridyn::test::TemporaryFolder folder;
  const auto file = (folder.path() / "poses.csv").string();
  std::ofstream(file) << "shoulder_flexion,elbow_flexion\n0.4,0.2\n0.4,0.25\n0.2,3\n";
  const PoseTable poses = read_poses(coupled_arm(), file);
  ASSERT_EQ(poses.q.size(), 3u);
  EXPECT_DOUBLE_EQ(poses.q[2](1), 0.1);
  ASSERT_EQ(poses.warnings.size(), 1u);
  EXPECT_THAT(poses.warnings[0], HasSubstr("in 2 of 3 rows the file's value is another, by up to 2.9 rad"));
}

TEST(PoseTable, MomentArmsOfTheCsvAreMinusTheSlopesOfItsLengths) {
  const MusculoskeletalSystem system(load_model("arm").model());
  PoseTable poses;
  const double h = 1e-4;
  for (const double elbow : {1.0 - h, 1.0, 1.0 + h}) {
    poses.q.emplace_back(Eigen::Vector2d(0.2, elbow));
    poses.qdot.emplace_back(Eigen::Vector2d::Zero());
    poses.qddot.emplace_back(Eigen::Vector2d::Zero());
  }
  std::stringstream text(pose_csv(system, poses));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(text, line);) rows.push_back(cells(line));
  ASSERT_EQ(rows.size(), 4u);
  const auto number = [&](std::size_t row, const std::string& name) {
    const auto column = std::find(rows[0].begin(), rows[0].end(), name);
    EXPECT_NE(column, rows[0].end()) << name;
    return column == rows[0].end() ? kNaN : std::stod(rows[row][column - rows[0].begin()]);
  };
  EXPECT_EQ(number(2, "elbow_flexion[rad]"), 1.0);
  const double slope = (number(3, "brachialis.length[m]") - number(1, "brachialis.length[m]")) / (2.0 * h);
  EXPECT_NEAR(number(2, "brachialis.moment_arm.elbow_flexion[m]"), -slope, 1e-8);
  EXPECT_GT(number(2, "elbow_flexion.force[N m]"), 0.0);
}

}  // namespace
}  // namespace veridyn::muscle
