#include "veridyn/muscle/osim/osim_reader.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/support/folders.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::filesystem::path kModels = veridyn::test::shared_folder() / "data/opensim";

#define SKIP_WITHOUT_MODELS() \
  if (!std::filesystem::exists(kModels)) GTEST_SKIP() << "the OpenSim models of ../shared/data are not here"

std::string arm_text() { return std::string(builtin_models()[0].text); }

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

std::string reading_error(std::string text) {
  try {
    static_cast<void>(OsimFile::parse(std::move(text), "arm.osim"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(OsimReader, ReadsTheBuiltInArmWithItsDefaultsBlock) {
  const Model model = load_model("arm").model();
  ASSERT_EQ(model.bodies.size(), 3u);
  EXPECT_EQ(model.bodies[0].name, "ground");
  EXPECT_DOUBLE_EQ(model.bodies[2].mass, 1.5);
  ASSERT_EQ(model.coordinates.size(), 2u);
  EXPECT_EQ(model.coordinates[1].name, "elbow_flexion");
  EXPECT_EQ(model.coordinates[1].motion, CoordinateMotion::kRotational);
  ASSERT_EQ(model.muscles.size(), 6u);
  const Muscle& triceps = model.muscles[0];
  EXPECT_EQ(triceps.name(), "triceps_long");
  // Said by the defaults block, not by the muscle.
  EXPECT_DOUBLE_EQ(std::get<ThelenCurves>(triceps.parameters.curves).Flen, 1.6);
  EXPECT_DOUBLE_EQ(triceps.parameters.musculotendon.activation_time_constant, 0.010);
  ASSERT_EQ(triceps.wraps.size(), 2u);
  EXPECT_EQ(model.wrap_objects[triceps.wraps[1].object].shape, WrapShape::kCylinder);
  EXPECT_EQ(triceps.wraps[1].first_point, 2);
  EXPECT_EQ(triceps.wraps[1].last_point, 3);
  EXPECT_TRUE(model.unsupported.empty());
  EXPECT_TRUE(model.warnings.empty());
}

TEST(OsimReader, ReadsEveryModelOfOpenSimThatIsHere) {
  SKIP_WITHOUT_MODELS();
  struct Expected {
    const char* file;
    std::size_t bodies, coordinates, muscles, wraps, couplers, unsupported;
  };
  // Counted in the files.
  const std::array<Expected, 12> expected{{{"Tug_of_War.osim", 2, 1, 2, 0, 0, 0},
                                           {"Tug_of_War_Millard.osim", 2, 1, 2, 0, 0, 0},
                                           {"arm26.osim", 4, 2, 6, 4, 0, 0},
                                           {"arm26_load1kg.osim", 5, 2, 6, 4, 0, 0},
                                           {"arm26_millard.osim", 4, 2, 6, 4, 0, 0},
                                           {"arm26_millard_load1kg.osim", 5, 2, 6, 4, 0, 0},
                                           {"bouncing_block.osim", 4, 8, 0, 0, 0, 0},
                                           {"gait10dof18musc.osim", 13, 10, 18, 0, 0, 0},
                                           {"gait2354_simbody.osim", 13, 23, 54, 0, 0, 0},
                                           {"gait2392_millard2012muscle.osim", 13, 23, 92, 0, 0, 0},
                                           {"gait2392_thelen2003muscle.osim", 13, 23, 92, 0, 0, 0},
                                           {"leg6dof9musc.osim", 8, 7, 9, 0, 1, 0}}};
  for (const Expected& e : expected) {
    SCOPED_TRACE(e.file);
    const Model model = read_osim(kModels / e.file);
    EXPECT_EQ(model.bodies.size(), e.bodies);
    EXPECT_EQ(model.coordinates.size(), e.coordinates);
    EXPECT_EQ(model.muscles.size(), e.muscles);
    EXPECT_EQ(model.wrap_objects.size(), e.wraps);
    EXPECT_EQ(model.couplers.size(), e.couplers);
    EXPECT_EQ(model.unsupported.size(), e.unsupported);
  }
}

TEST(OsimReader, TakesArm26sOwnNumbersNotTheClassDefaults) {
  SKIP_WITHOUT_MODELS();
  const Model model = read_osim(kModels / "arm26.osim");
  EXPECT_DOUBLE_EQ(model.gravity.y(), -9.8066);
  const MuscleParameters& p = model.muscles[model.muscle("TRIlong")].parameters;
  EXPECT_DOUBLE_EQ(p.musculotendon.max_isometric_force, 798.52);
  EXPECT_DOUBLE_EQ(p.musculotendon.pennation_angle_at_optimal, 0.20943951);
  EXPECT_DOUBLE_EQ(std::get<ThelenCurves>(p.curves).tendon_strain, 0.033);
  EXPECT_DOUBLE_EQ(p.musculotendon.deactivation_time_constant, 0.040);
  EXPECT_NEAR(model.coordinates[1].high, 130.0 * std::numbers::pi / 180.0, 1e-5);
  const Model millard = read_osim(kModels / "arm26_millard.osim");
  EXPECT_DOUBLE_EQ(millard.muscles[0].parameters.fiber_damping, 0.1);
  EXPECT_DOUBLE_EQ(millard.muscles[0].parameters.musculotendon.activation_time_constant, 0.010);
}

TEST(OsimReader, ReadsContactSpringsAndConstraints) {
  SKIP_WITHOUT_MODELS();
  const Model model = read_osim(kModels / "bouncing_block.osim");
  EXPECT_EQ(model.body_forces.contacts.size(), 1u);
  EXPECT_EQ(model.body_forces.springs.size(), 1u);
  EXPECT_EQ(model.body_forces.bushings.size(), 1u);
  ASSERT_EQ(model.loops.size(), 2u);
  for (const LoopConstraint& c : model.loops) {
    EXPECT_EQ(c.kind, LoopKind::kPointOnLine);
    EXPECT_TRUE(c.frame_1.rotation.col(0).isApprox(Eigen::Vector3d::UnitY()));
  }
}

TEST(OsimReader, ReadsTheFormatBeforeFourWhereBodiesHoldTheirJoints) {
  constexpr const char* kOld = R"(<?xml version="1.0"?>
<OpenSimDocument Version="20302"><Model name="old">
  <gravity> 0 -9.81 0 </gravity>
  <BodySet><objects>
    <Body name="ground"><mass>0</mass></Body>
    <Body name="thigh"><mass>8</mass><mass_center>0 -0.2 0</mass_center>
      <inertia_xx>0.1</inertia_xx><inertia_yy>0.03</inertia_yy><inertia_zz>0.1</inertia_zz>
      <inertia_xy>0.001</inertia_xy><inertia_xz>0</inertia_xz><inertia_yz>0</inertia_yz>
      <Joint><CustomJoint name="hip"><parent_body>ground</parent_body>
        <location_in_parent>0 1 0</location_in_parent><orientation_in_parent>0 0 0</orientation_in_parent>
        <location>0 0.01 0</location><orientation>0 0 0</orientation>
        <CoordinateSet><objects><Coordinate name="flexion"><default_value>0.1</default_value><range>-1 2</range>
          <locked>false</locked></Coordinate></objects></CoordinateSet>
        <reverse>false</reverse>
        <SpatialTransform>
          <TransformAxis name="rotation1"><coordinates>flexion</coordinates><axis>0 0 2</axis>
            <function><LinearFunction><coefficients>1 0</coefficients></LinearFunction></function></TransformAxis>
          <TransformAxis name="translation2"><coordinates>flexion</coordinates><axis>0 1 0</axis>
            <function><MultiplierFunction><function><natCubicSpline><x>-1 0 1 2</x><y>0 1 0 1</y></natCubicSpline>
              </function><scale>0.01</scale></MultiplierFunction></function></TransformAxis>
        </SpatialTransform>
      </CustomJoint></Joint>
      <WrapObjectSet><objects><WrapSphere name="ball"><radius>0.03</radius><translation>0 0 0</translation></WrapSphere>
      </objects></WrapObjectSet>
    </Body>
  </objects></BodySet>
  <ForceSet><objects><Thelen2003Muscle_Deprecated name="rf"><GeometryPath><PathPointSet><objects>
      <PathPoint name="a"><location>0 1.1 0</location><body>ground</body></PathPoint>
      <ConditionalPathPoint name="c"><location>0.03 0 0</location><body>thigh</body>
        <range>0.5 1.5</range><coordinate>flexion</coordinate></ConditionalPathPoint>
      <PathPoint name="b"><location>0.02 -0.3 0</location><body>thigh</body></PathPoint></objects></PathPointSet>
    <PathWrapSet><objects><PathWrap name="w"><wrap_object>ball</wrap_object><range>-1 -1</range></PathWrap></objects>
    </PathWrapSet></GeometryPath>
    <max_isometric_force>500</max_isometric_force></Thelen2003Muscle_Deprecated></objects></ForceSet>
</Model></OpenSimDocument>)";
  const Model model = OsimFile::parse(kOld, "old.osim").model();
  ASSERT_EQ(model.joints.size(), 1u);
  const Joint& hip = model.joints[0];
  EXPECT_EQ(hip.child, 1);
  EXPECT_EQ(hip.parent_frame.translation, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(hip.child_frame.translation, Eigen::Vector3d(0, 0.01, 0));
  EXPECT_EQ(hip.rotation[0].axis, Eigen::Vector3d::UnitZ());
  EXPECT_DOUBLE_EQ(hip.translation[1].function.evaluate(0.0).value, 0.01);
  EXPECT_DOUBLE_EQ(model.bodies[1].inertia(0, 1), 0.001);
  ASSERT_EQ(model.muscles.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<DeprecatedThelenCurves>(model.muscles[0].parameters.curves));
  EXPECT_EQ(model.muscles[0].points[1].kind, PathPointKind::kConditional);
  EXPECT_EQ(model.muscles[0].wraps[0].last_point, -1);
}

TEST(OsimReader, InertiaThatNoMassHasIsRepairedAndTheWarningSaysByHowMuch) {
  const Model model =
      OsimFile::parse(replaced(arm_text(), ">0.0136 0.0026 0.0136 0 0 0<", ">0.0136 0.0026 0.0136 0.0 0.0 0.01<"),
                      "arm.osim")
          .model();
  // [0.0026 0.01; 0.01 0.0136] has eigenvalues 0.0081 +- sqrt(0.0055^2 + 0.01^2): one of -0.003313.
  const double least = 0.0081 - std::hypot(0.0055, 0.01), greatest = 0.0081 + std::hypot(0.0055, 0.01);
  ASSERT_EQ(model.warnings.size(), 1u);
  EXPECT_THAT(model.warnings[0], AllOf(HasSubstr("Body 'humerus'"), HasSubstr("-0.003313 kg m^2")));
  const Eigen::Matrix3d& inertia = model.bodies[1].inertia;
  EXPECT_NEAR(inertia(0, 0), 0.0136, 1e-15);
  EXPECT_NEAR(inertia(1, 1) + inertia(2, 2), greatest, 1e-15);
  EXPECT_NEAR(inertia(1, 1) * inertia(2, 2), inertia(1, 2) * inertia(1, 2), 1e-16);
  EXPECT_LT(least, 0.0);
}

TEST(OsimReader, UnitsThatAreOnlyLabelsAreReadAsOpenSimReadsThem) {
  const std::string arm = arm_text();
  for (const char* unit : {"Unassigned", "inches", ""}) {
    const Model model =
        OsimFile::parse(replaced(arm, "<length_units>meters<", fmt::format("<length_units>{}<", unit)), "arm.osim")
            .model();
    ASSERT_EQ(model.warnings.size(), 1u) << unit;
    EXPECT_THAT(model.warnings[0],
                AllOf(HasSubstr(fmt::format("length_units is '{}'", unit)), HasSubstr("taken as meters")));
    EXPECT_DOUBLE_EQ(model.wrap_objects[0].dimensions.x(), 0.022);
  }
  EXPECT_TRUE(
      OsimFile::parse(replaced(arm, "<length_units>meters<", "<length_units>m<"), "arm.osim").model().warnings.empty());
}

TEST(OsimReader, FormatsBeforeTwoAreNamedAsSuch) {
  EXPECT_THAT(reading_error("<Model/>"), HasSubstr("format 1.9 or older"));
  EXPECT_THAT(reading_error(R"(<OpenSimDocument Version="10900"><Model/></OpenSimDocument>)"),
              AllOf(HasSubstr("format 1.9, older than what is read"), HasSubstr("save it")));
}

TEST(OsimReader, EmptySocketsAreTakenFromWhatElseTheFileSays) {
  const std::string arm = arm_text();
  const Model whole = OsimFile::parse(arm, "arm.osim").model();
  // A joint's frames in their order, an offset frame's parent by its name.
  const std::string elbow = replaced(arm, "<socket_child_frame>/bodyset/forearm<", "<socket_child_frame><");
  EXPECT_THAT(reading_error(elbow), AllOf(HasSubstr("PinJoint 'elbow'"), HasSubstr("socket_child_frame: is empty")));
  constexpr const char* kOld = R"(<?xml version="1.0"?>
<OpenSimDocument Version="30501"><Model name="old">
  <BodySet><objects><Body name="thigh"><mass>8</mass><inertia>1 1 1 0 0 0</inertia></Body></objects></BodySet>
  <JointSet><objects><PinJoint name="hip">
    <connectors><Connector_PhysicalFrame_ name="parent_frame"><connectee_name></connectee_name>
    </Connector_PhysicalFrame_><Connector_PhysicalFrame_ name="child_frame"><connectee_name></connectee_name>
    </Connector_PhysicalFrame_></connectors>
    <frames><PhysicalOffsetFrame name="ground_offset"><translation>0 1 0</translation></PhysicalOffsetFrame>
      <PhysicalOffsetFrame name="thigh_offset"><translation>0 0.2 0</translation></PhysicalOffsetFrame></frames>
    </PinJoint></objects></JointSet>
  <MarkerSet><objects><Marker name="free"><location>1 2 3</location></Marker></objects></MarkerSet>
</Model></OpenSimDocument>)";
  const Model model = OsimFile::parse(kOld, "old.osim").model();
  ASSERT_EQ(model.joints.size(), 1u);
  EXPECT_EQ(model.joints[0].parent, 0);
  EXPECT_EQ(model.joints[0].child, 1);
  EXPECT_EQ(model.joints[0].parent_frame.translation, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(model.joints[0].child_frame.translation, Eigen::Vector3d(0, 0.2, 0));
  ASSERT_EQ(model.warnings.size(), 3u);
  EXPECT_THAT(model.warnings[0], HasSubstr("socket_parent_frame is empty; 'ground_offset' is taken"));
  EXPECT_THAT(model.warnings[2], AllOf(HasSubstr("Marker 'free'"), HasSubstr("the ground is taken")));
}

TEST(OsimReader, WhatScriptsAddAmongTheComponentsCountsAsInItsSet) {
  const auto model_of = [](const std::string& set, const std::string& components) {
    return OsimFile::parse(fmt::format(R"(<OpenSimDocument Version="40500"><Model name="m">{}
<components>{}</components></Model></OpenSimDocument>)",
                                       set, components),
                           "m.osim");
  };
  const std::string body = R"(<Body name="bar"><mass>1</mass><inertia>1 1 1 0 0 0</inertia></Body>)";
  const std::string joint =
      R"(<PinJoint name="pin"><socket_parent_frame>/ground</socket_parent_frame><socket_child_frame>/bar
</socket_child_frame><coordinates><Coordinate name="angle"/></coordinates></PinJoint>)";
  const std::string spring =
      "<SpringGeneralizedForce name=\"s\"><coordinate>angle</coordinate><stiffness>5</stiffness>"
      "</SpringGeneralizedForce>";
  const std::string weld =
      R"(<WeldConstraint name="held"><socket_frame1>/ground</socket_frame1><socket_frame2>/bar</socket_frame2>
</WeldConstraint>)";
  const std::string marker =
      R"(<Marker name="tip"><socket_parent_frame>/bar</socket_parent_frame><location>0 1 0</location></Marker>)";
  const Model model = model_of("", body + joint + spring + weld + marker).model();
  EXPECT_EQ(model.bodies.size(), 2U);
  EXPECT_EQ(model.joints.size(), 1U);
  EXPECT_EQ(model.coordinate_springs.size(), 1U);
  EXPECT_EQ(model.loops.size(), 1U);
  ASSERT_EQ(model.markers.size(), 1U);
  EXPECT_EQ(model.markers[0].body, 1);
  EXPECT_TRUE(model.unsupported.empty());
  // What is unknown may change the motion; what only reports does not.
  const Model with_others = model_of("<BodySet><objects>" + body + "</objects></BodySet><JointSet><objects>" + joint +
                                         "</objects></JointSet>",
                                     "<ExoskeletonSpringDamper name=\"exo\"/><TableReporter name=\"table\"/>")
                                .model();
  ASSERT_EQ(with_others.unsupported.size(), 2U);
  EXPECT_EQ(with_others.unsupported[0].name, "exo");
  EXPECT_TRUE(with_others.unsupported[0].changes_motion);
  EXPECT_FALSE(with_others.unsupported[1].changes_motion);
}

TEST(OsimReader, ModelsOfEndlessBodiesAreRefusedBeforeTheyAreRead) {
  std::string bodies;
  for (int i = 0; i < 10000; ++i) bodies += fmt::format("<Body name=\"b{}\"/>", i);
  EXPECT_EQ(reading_error("<OpenSimDocument Version=\"40000\"><Model name=\"m\"><BodySet><objects>" + bodies +
                          "</objects></BodySet></Model></OpenSimDocument>"),
            "arm.osim: has 10000 bodies; at most 2000 are read");
}

TEST(OsimReader, BadModelsGetOneLineThatNamesFileLineAndElement) {
  const std::string arm = arm_text();
  EXPECT_THAT(reading_error(arm.substr(0, arm.size() / 2)),
              AllOf(HasSubstr("arm.osim:"), HasSubstr("not well-formed XML")));
  EXPECT_THAT(reading_error("hello"), HasSubstr("arm.osim"));
  EXPECT_THAT(reading_error("<a/>"), HasSubstr("no OpenSimDocument"));
  EXPECT_THAT(
      reading_error(replaced(arm, "<socket_child_frame>/bodyset/forearm<", "<socket_child_frame>/bodyset/forarm<")),
      AllOf(HasSubstr("PinJoint 'elbow'"), HasSubstr("no body or frame '/bodyset/forarm'"), HasSubstr("forearm")));
  EXPECT_THAT(reading_error(replaced(arm, "<tendon_slack_length>0.136<", "<tendon_slack_length>-0.136<")),
              AllOf(HasSubstr("Thelen2003Muscle 'triceps_long'"),
                    HasSubstr("tendon_slack_length: -0.136 must not be negative")));
  EXPECT_THAT(reading_error(replaced(arm, "<mass>1.9<", "<mass>nan<")),
              AllOf(HasSubstr("Body 'humerus'"), HasSubstr("mass: 'nan' is not a finite number")));
  EXPECT_THAT(reading_error(replaced(arm, "<mass>1.9<", "<mass>-1.9<")), HasSubstr("mass: -1.9 must not be negative"));
  EXPECT_THAT(reading_error(replaced(arm, "<mass>1.9<", "<mass>heavy<")), HasSubstr("'heavy' is not a number"));
  EXPECT_THAT(reading_error(replaced(arm, "<wrap_object>elbow<", "<wrap_object>elbo<")),
              AllOf(HasSubstr("PathWrap"), HasSubstr("no wrap object 'elbo'"), HasSubstr("did you mean 'elbow'")));
  EXPECT_THAT(reading_error(replaced(arm, "<radius>0.022<", "<radius>0<")),
              AllOf(HasSubstr("WrapSphere 'humeral_head'"), HasSubstr("radius")));
  EXPECT_THAT(reading_error(replaced(arm, "<coordinates>shoulder_flexion<", "<coordinates>elbow_flexion<")),
              HasSubstr("elbow_flexion"));
  EXPECT_THAT(reading_error(replaced(arm, "<range>0 2.268928<", "<range>3 2.268928<")),
              AllOf(HasSubstr("Coordinate 'elbow_flexion'"), HasSubstr("range: begins at 3 above its end")));
  EXPECT_THAT(reading_error(replaced(arm, "<range>3 4<", "<range>3 9<")),
              HasSubstr("9 is beyond the 4 points of the path"));
  EXPECT_THAT(reading_error(replaced(arm, "name=\"forearm\"", "name=\"humerus\"")),
              HasSubstr("a second body of this name"));
  std::string screw = replaced(arm, "<PinJoint ", "<ScrewJoint ");
  screw = replaced(screw, "</PinJoint>", "</ScrewJoint>");
  EXPECT_THAT(reading_error(screw), AllOf(HasSubstr("ScrewJoint 'elbow'"), HasSubstr("not understood")));
}

TEST(OsimReader, TenThousandDamagedFilesAreReadOrRefusedInOneLine) {
  const std::string arm = arm_text();
  numerics::RandomStream random(20261121, "damaged models");
  std::size_t refused = 0;
  for (int i = 0; i < 10000; ++i) {
    std::string text = arm;
    const auto pick = [&](std::size_t n) {
      return static_cast<std::size_t>(random.uniform() * static_cast<double>(n));
    };
    const std::size_t edits = 1 + pick(4);
    for (std::size_t e = 0; e < edits && text.size() > 64; ++e) {
      const std::size_t at = pick(text.size() - 33);
      switch (pick(5)) {
        case 0:
          text[at] = static_cast<char>(pick(256));
          break;
        case 1:
          text.erase(at, 1 + pick(32));
          break;
        case 2:
          text.insert(at, text.substr(pick(text.size() - 33), 1 + pick(32)));
          break;
        case 3: {
          const std::size_t digit = text.find_first_of("0123456789", at);
          if (digit != std::string::npos)
            text.replace(digit, 1, std::array<const char*, 5>{"-", "1e9", "nan", "", "1e-300"}[pick(5)]);
          break;
        }
        default:
          if (pick(20) == 0) text.resize(at);
      }
    }
    try {
      const OsimFile file = OsimFile::parse(text, "damaged.osim");
      EXPECT_EQ(file.text_with(file.model()), text);
      EXPECT_TRUE(file.model().default_pose().allFinite());
    } catch (const InputError& error) {
      ++refused;
      EXPECT_THAT(error.what(), AllOf(HasSubstr("damaged.osim"), Not(HasSubstr("\n"))));
    }
  }
  EXPECT_GT(refused, 1000u);
  EXPECT_LT(refused, 9990u);
}

}  // namespace
}  // namespace veridyn::muscle
