// Paths that a file gives as functions of coordinates.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/joint_reactions.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

namespace veridyn::muscle {
namespace {

using numerics::MultivariatePolynomial;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Two bodies of 1 kg, one on a slider along x and one on a pin, with these constraints and forces; no gravity.
std::string function_model(const std::string& forces, const std::string& constraints = "") {
  return fmt::format(R"(<OpenSimDocument Version="40500"><Model name="m"><gravity>0 0 0</gravity><BodySet><objects>
<Body name="cart"><mass>1</mass><inertia>1 1 1 0 0 0</inertia></Body>
<Body name="bar"><mass>1</mass><mass_center>0 -0.2 0</mass_center><inertia>1 1 1 0 0 0</inertia></Body>
</objects></BodySet><JointSet><objects>
<SliderJoint name="rail"><socket_parent_frame>/ground</socket_parent_frame><socket_child_frame>/bodyset/cart
</socket_child_frame><coordinates><Coordinate name="along"><range>-1 1</range></Coordinate></coordinates></SliderJoint>
<PinJoint name="pin"><socket_parent_frame>/ground</socket_parent_frame><socket_child_frame>/bodyset/bar
</socket_child_frame><coordinates><Coordinate name="angle"><range>-2 2</range></Coordinate></coordinates></PinJoint>
</objects></JointSet><ConstraintSet><objects>{}</objects></ConstraintSet>
<ForceSet><objects>{}</objects></ForceSet></Model></OpenSimDocument>)",
                     constraints, forces);
}

std::string polynomial_xml(const std::string& coefficients, int dimension, int order,
                           const std::string& name = "length_function") {
  return fmt::format(
      "<MultivariatePolynomialFunction name=\"{}\"><coefficients>{}</coefficients><dimension>{}</dimension>"
      "<order>{}</order></MultivariatePolynomialFunction>",
      name, coefficients, dimension, order);
}

std::string function_path(const std::string& content,
                          const std::string& coordinates = "/jointset/pin/angle /jointset/rail/along",
                          const char* property = "coordinate_paths") {
  return fmt::format("<FunctionBasedPath name=\"path\"><{0}>{1}</{0}>{2}</FunctionBasedPath>", property, coordinates,
                     content);
}

std::string calf_along(const std::string& path_text) {
  return "<Millard2012EquilibriumMuscle name=\"calf\">" + path_text + "</Millard2012EquilibriumMuscle>";
}

Model read_functions(const std::string& forces, const std::string& constraints = "") {
  return OsimFile::parse(function_model(forces, constraints), "m.osim").model();
}

/// L = 0.3 + 0.1 along - 0.05 angle, of (angle, along).
const std::string kLine = polynomial_xml("0.3 0.1 -0.05", 2, 1);

TEST(OsimPathFunction, IsReadInAllItsForms) {
  const std::string in_property =
      "<length_function>" + polynomial_xml("0.3 0.1 -0.05", 2, 1, "") + "</length_function>";
  for (const std::string& text :
       {function_path(kLine), "<path>" + function_path(kLine) + "</path>", function_path(in_property),
        function_path(
            "<LinearFunction name=\"length_function\"><coefficients>-0.05 0.1 0.3</coefficients></LinearFunction>"),
        function_path(kLine, "/jointset/pin/angle /jointset/rail/along", "coordinates"),
        function_path(kLine + "<moment_arm_functions/>")}) {
    SCOPED_TRACE(text);
    const Model model = read_functions(calf_along(text));
    const PathFunction& function = model.muscles.at(0).function.value();
    EXPECT_THAT(function.coordinates, ElementsAre(1, 0));
    const double at[2] = {0.4, 0.2};
    EXPECT_NEAR(std::get<MultivariatePolynomial>(function.length).value(at), 0.3 + 0.02 - 0.02, 1e-15);
    EXPECT_TRUE(model.muscles[0].points.empty());
    EXPECT_THAT(model.warnings, IsEmpty());
    EXPECT_THAT(model.unsupported, IsEmpty());
  }
  const Model one = read_functions(
      calf_along(function_path("<SimmSpline name=\"length_function\"><x>-2 0 1 2</x><y>0.2 0.3 0.3 0.2</y>"
                               "</SimmSpline>",
                               "/jointset/pin/angle")));
  EXPECT_NEAR(std::get<numerics::PiecewisePolynomial>(one.muscles[0].function->length).evaluate(1.0).value, 0.3, 1e-14);
}

TEST(OsimPathFunction, MistakesAreNamed) {
  const auto refused = [](const std::string& path_text) {
    return why([&] { static_cast<void>(read_functions(calf_along(path_text))); });
  };
  EXPECT_THAT(refused(function_path(polynomial_xml("1 2 3 4", 2, 1))),
              AllOf(HasSubstr("m.osim:"), HasSubstr("'length_function': coefficients: 4 numbers; dimension 2 and order "
                                                    "1 have 3 terms")));
  EXPECT_THAT(refused(function_path(polynomial_xml("1 2 3 4", 3, 1))),
              HasSubstr("dimension: 3 where the function has 2 arguments"));
  EXPECT_THAT(refused(function_path(kLine, "/jointset/pin/angel /jointset/rail/along")),
              AllOf(HasSubstr("'calf': coordinate_paths: there is no coordinate"), HasSubstr("angle")));
  EXPECT_THAT(refused(function_path(kLine, "angle angle")), HasSubstr("coordinate_paths: 'angle' stands there twice"));
  EXPECT_THAT(refused(function_path(kLine, "")), HasSubstr("at least one coordinate"));
  EXPECT_THAT(refused(function_path("")), HasSubstr("'calf': length_function: missing"));
  EXPECT_THAT(refused(function_path(kLine + "<moment_arm_functions>" + polynomial_xml("1 0 0", 2, 1, "") +
                                    "</moment_arm_functions>")),
              HasSubstr("moment_arm_functions: 1 functions of 2 coordinates"));
  EXPECT_THAT(refused("<MagicPath name=\"path\"/>"), HasSubstr("MagicPath: paths of this kind are not understood"));
}

TEST(OsimPathFunction, MomentArmsAndSpeedsThatContradictTheLengthAreWarnedOf) {
  const auto warnings = [](const std::string& more) {
    return read_functions(calf_along(function_path(kLine + more))).warnings;
  };
  const auto arms = [](const std::string& angle, const std::string& along) {
    return "<moment_arm_functions>" + polynomial_xml(angle, 2, 1, "") + polynomial_xml(along, 2, 1, "") +
           "</moment_arm_functions>";
  };
  EXPECT_THAT(warnings(arms("0.05 0 0", "-0.1 0 0")), IsEmpty());
  EXPECT_THAT(warnings(arms("0.0505 0 0", "-0.1 0 0")), IsEmpty()) << "within a millimetre";
  // Off by 0.01 angle, which is at most 0.02.
  EXPECT_THAT(warnings(arms("0.05 0 0.01", "-0.1 0 0")),
              ElementsAre(AllOf(
                  HasSubstr("'calf': moment_arm_functions are not -dL/dq of the length: about 'angle' they "
                            "differ by 0.0"),
                  HasSubstr(" m/rad at angle = "), HasSubstr("the length's slope is used"), Not(HasSubstr("+dL/dq")))));
  EXPECT_THAT(warnings(arms("-0.05 0 0", "0.1 0 0")),
              ElementsAre(AllOf(HasSubstr("about 'along' they differ by 0.2 m/m"), HasSubstr("as they are +dL/dq"))));
  // Of (angle, along, their speeds): L' = -0.05 angle' + 0.1 along'.
  EXPECT_THAT(warnings(polynomial_xml("0 0.1 -0.05 0 0", 4, 1, "lengthening_speed_function")), IsEmpty());
  EXPECT_THAT(warnings(polynomial_xml("0 -0.1 0.05 0 0", 4, 1, "lengthening_speed_function")),
              ElementsAre(HasSubstr("lengthening_speed_function is not the rate of the length")));
}

TEST(OsimPathFunction, IsWrittenBackAsItWas) {
  const std::string text = function_model(calf_along(function_path(kLine)));
  const OsimFile file = OsimFile::parse(text, "m.osim");
  EXPECT_EQ(file.text_with(file.model()), text);
  Model changed = file.model();
  changed.muscles[0].parameters.musculotendon.max_isometric_force = 777.0;
  const Model again = OsimFile::parse(file.text_with(changed), "m.osim").model();
  EXPECT_EQ(again.muscles[0].parameters.musculotendon.max_isometric_force, 777.0);
  EXPECT_TRUE(again.muscles[0].function);
}

MuscleTrajectory free_motion(const MusculoskeletalSystem& system, const Eigen::VectorXd& q, double excitation,
                             double end) {
  StartState start = default_start(system.model());
  start.q = q;
  Progress progress;
  return simulate_forward(system, start, {ControlSignals(std::vector<double>(system.muscles().size(), excitation)), {}},
                          {.end = end, .rate_Hz = 50.0, .accuracy = 1e-8}, progress);
}

// m x'' = -k (0.5 + x - L0) while the spring is stretched, with k = 25, L0 = 0.1: x = -0.4 + 0.6 cos 5 t.
TEST(OsimPathFunction, OfAPathSpringSwingsInClosedForm) {
  const MusculoskeletalSystem system(
      read_functions("<PathSpring name=\"s\"><resting_length>0.1</resting_length><stiffness>25</stiffness>" +
                     function_path(polynomial_xml("0.5 1", 1, 1), "along") + "</PathSpring>"));
  const MuscleTrajectory t = free_motion(system, Eigen::Vector2d(0.2, 0.0), 0.0, 0.3);
  ASSERT_TRUE(t.usable());
  for (std::size_t i = 0; i < t.time.size(); ++i)
    EXPECT_NEAR(t.q(static_cast<Eigen::Index>(i), 0), -0.4 + 0.6 * std::cos(5.0 * t.time[i]), 1e-7);
}

// A ligament along a coordinate that another one leads, angle = 2 along, is one along that other one.
TEST(OsimPathFunction, MayDependOnACoupledCoordinate) {
  const auto ligament = [](const std::string& function) {
    return read_functions(
        "<Blankevoort1991Ligament name=\"l\"><slack_length>0.2</slack_length><linear_stiffness>30"
        "</linear_stiffness>" +
            function + "</Blankevoort1991Ligament>",
        "<CoordinateCouplerConstraint name=\"c\"><coupled_coordinates_function><LinearFunction><coefficients>2 0"
        "</coefficients></LinearFunction></coupled_coordinates_function><independent_coordinate_names>along"
        "</independent_coordinate_names><dependent_coordinate_name>angle</dependent_coordinate_name>"
        "</CoordinateCouplerConstraint>");
  };
  const MusculoskeletalSystem coupled(ligament(function_path(polynomial_xml("0.25 0.03 0.01", 1, 2), "angle")));
  const MusculoskeletalSystem leading(ligament(function_path(polynomial_xml("0.25 0.06 0.04", 1, 2), "along")));
  const Eigen::Vector2d q(0.1, 0.2);
  const MuscleTrajectory one = free_motion(coupled, q, 0.0, 0.5), other = free_motion(leading, q, 0.0, 0.5);
  ASSERT_TRUE(one.usable() && other.usable());
  EXPECT_GT((one.q.row(0) - one.q.bottomRows(1)).norm(), 0.01);
  EXPECT_LT((one.q - other.q).cwiseAbs().maxCoeff(), 1e-10);
}

// It pulls at no place: the joint carries what it would without a muscle.
TEST(OsimPathFunction, GivesJointReactionsTheMomentOfAReserve) {
  const MusculoskeletalSystem system(read_functions(calf_along(function_path(kLine))));
  EXPECT_THAT(paths_without_place(system), ElementsAre("calf"));
  const std::vector<double> time{0.0};
  const estimation::RowMatrix q{{0.1, 0.3}}, zero = estimation::RowMatrix::Zero(1, 2), qddot{{1.0, 2.0}};
  const estimation::RowMatrix none, force{{500.0}};
  const auto reactions = [&](const estimation::RowMatrix& tendon_force) {
    return joint_reactions(
        system, {.time = time, .q = q, .qdot = zero, .qddot = qddot, .tendon_force = tendon_force, .reserve = none},
        ReactionFrame::kGround);
  };
  const JointReactions with = reactions(force), without = reactions(none);
  EXPECT_EQ((with.force - without.force).norm(), 0.0);
  EXPECT_EQ((with.moment - without.moment).norm(), 0.0);
  EXPECT_NEAR(with.force(0, 0), 1.0, 1e-12) << "of 1 kg that gains 1 m/s^2";
  // Of the forces alone: 500 N along dL/dq = (0.1, -0.05) on 1 kg, and on 1 kg m^2 and 1 kg at 0.2 m.
  const JointReactions driven = joint_reactions(
      system, {.time = time, .q = q, .qdot = zero, .qddot = none, .tendon_force = force, .reserve = none},
      ReactionFrame::kGround);
  EXPECT_NEAR(driven.force(0, 0), -50.0, 1e-9);
  EXPECT_NEAR(driven.moment(0, 5), 25.0, 1e-9);
}

/// The polynomial of a muscle's coordinates that comes nearest to its exact path, lengths and slopes alike, where the
/// motion below goes: shoulder -0.5 to 0.5 rad, elbow 0.2 to 1 rad.
std::string fitted_function(const Model& model, const MusclePaths& paths, const Mechanism& mechanism, int m,
                            int order) {
  constexpr int kGrid = 36;
  std::vector<int> of;
  for (std::size_t k = paths.first_pair(m); k < paths.end_pair(m); ++k) of.push_back(paths.pairs()[k].coordinate);
  const int n = static_cast<int>(of.size());
  const std::vector<MultivariatePolynomial::Powers> powers = MultivariatePolynomial::powers(n, order);
  const int poses = n == 1 ? kGrid : kGrid * kGrid;
  Eigen::MatrixXd rows((n + 1) * poses, static_cast<Eigen::Index>(powers.size()));
  Eigen::VectorXd values((n + 1) * poses);
  Kinematics<double> kinematics(mechanism);
  PathWorkspace<double> w(paths);
  for (int i = 0; i < poses; ++i) {
    Eigen::VectorXd q = model.default_pose();
    for (int a = 0; a < n; ++a) {
      const double low = of[a] == 0 ? -0.5 : 0.2, high = of[a] == 0 ? 0.5 : 1.0;
      const double u = std::cos(kPi * ((a == 0 ? i % kGrid : i / kGrid) + 0.5) / kGrid);
      q(of[a]) = 0.5 * (low + high) + 0.5 * (high - low) * u;
    }
    update_positions(mechanism, q.data(), kinematics);
    paths.evaluate(kinematics, q.data(), w);
    for (int d = 0; d <= n; ++d) {
      const Eigen::Index row = (n + 1) * i + d;
      values(row) = d == 0 ? w.length[m] : w.gradient[paths.first_pair(m) + static_cast<std::size_t>(d) - 1];
      for (std::size_t t = 0; t < powers.size(); ++t) {
        double product = 1.0;
        for (int a = 0; a < n; ++a) {
          const int power = powers[t][a];
          product *=
              a == d - 1 ? (power == 0 ? 0.0 : power * std::pow(q(of[a]), power - 1)) : std::pow(q(of[a]), power);
        }
        rows(row, static_cast<Eigen::Index>(t)) = product;
      }
    }
  }
  const Eigen::VectorXd c = numerics::HouseholderQr(rows).solve(values);
  std::string coefficients, names;
  for (const double x : c) coefficients += fmt::format("{} ", x);
  for (const int index : of) names += model.coordinates[index].name + " ";
  return function_path(polynomial_xml(coefficients, n, order), names);
}

// The built-in arm with all its paths as functions, which were fitted as OpenSim's PolynomialPathFitter does.
TEST(OsimPathFunction, OfTheWholeArmMovesAsItsFittedPaths) {
  const OsimFile file = load_model("arm");
  const Model& model = file.model();
  const Mechanism mechanism(model);
  const MusclePaths paths(model, mechanism);
  std::string text = file.text();
  std::size_t at = 0;
  for (int m = 0; m < paths.muscles(); ++m) {
    const std::size_t begin = text.find("<GeometryPath", at);
    const std::string_view close = "</GeometryPath>";
    const std::string function = fitted_function(model, paths, mechanism, m, 9);
    text.replace(begin, text.find(close, begin) + close.size() - begin, function);
    at = begin + function.size();
  }
  const Model by_functions = OsimFile::parse(text, "functions.osim").model();
  ASSERT_EQ(by_functions.muscles.size(), 6U);
  for (const Muscle& each : by_functions.muscles) EXPECT_TRUE(each.function) << each.name();
  const Eigen::Vector2d q(0.1, 0.5);
  const auto moved = [&](const Model& m, PathSource source) {
    const MusculoskeletalSystem system(m, {.paths = source});
    const MuscleTrajectory t = free_motion(system, q, 0.1, 0.5);
    EXPECT_TRUE(t.usable()) << t.message();
    return t.q;
  };
  const estimation::RowMatrix exact = moved(model, PathSource::kExact), fitted = moved(model, PathSource::kFitted);
  const estimation::RowMatrix given = moved(by_functions, PathSource::kExact);
  EXPECT_GT((exact.row(0) - exact.bottomRows(1)).norm(), 0.3);
  const auto off = [](const estimation::RowMatrix& a, const estimation::RowMatrix& b) {
    return (a - b).cwiseAbs().maxCoeff();
  };
  RecordProperty("fitted_off", std::to_string(off(fitted, exact)));
  RecordProperty("given_off", std::to_string(off(given, exact)));
  // 0.0004 and 0.0021 rad: either fit is off next to the kinks where wraps begin, one polynomial more than chains.
  EXPECT_LT(off(fitted, exact), 1e-3);
  EXPECT_LT(off(given, exact), 3e-3);
  EXPECT_EQ(off(given, moved(by_functions, PathSource::kFitted)), 0.0) << "whatever the source, it is the function";
  EXPECT_EQ(off(given, moved(by_functions, PathSource::kAsOpenSim)), 0.0);
}

}  // namespace
}  // namespace veridyn::muscle
