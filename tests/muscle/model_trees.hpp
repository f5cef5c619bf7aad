#pragma once

#include <string>
#include <vector>

#include "veridyn/muscle/model.hpp"
#include "veridyn/numerics/random.hpp"

/// Models that the tests of multibody dynamics share, built by hand.
namespace veridyn::muscle::test {

/// The skeleton of OpenSim's arm26 (Holzbaur et al. 2005): a welded base, shoulder and elbow.
[[nodiscard]] Model arm26_skeleton();

enum class TreeJoint { kPin, kSlider, kUniversal, kPlanar, kSpline, kFree, kGimbal };
constexpr int kTreeJoints = 7;

/// A joint of this kind between two bodies with new coordinates, in frames and about axes drawn at random where its kind
/// leaves them open.
void add_joint(Model& model, TreeJoint kind, int parent, int child, numerics::Random& random);
/// A body of random mass, mass centre and (physical) inertia; returns its index.
int add_body(Model& model, numerics::Random& random);
[[nodiscard]] Placement random_placement(numerics::Random& random);

/// `bodies` bodies, each hung by a random kind of joint on a random earlier one.
[[nodiscard]] Model random_tree(int bodies, numerics::Random& random);
/// Links in a row on pins about z, gravity along -y: a plane pendulum of n rods.
[[nodiscard]] Model pendulum(int rods);

/// Rows of a comma-separated table under `VERIDYN_SHARED_DIR`; text by column name. Empty when it is not there.
struct TextTable {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;
  [[nodiscard]] const std::string& text(std::size_t row, const std::string& name) const;
  [[nodiscard]] double number(std::size_t row, const std::string& name) const;
};
[[nodiscard]] TextTable read_reference(const std::string& path);

}  // namespace veridyn::muscle::test
