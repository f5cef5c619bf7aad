#include "veridyn/muscle/osim/external_loads_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// As OpenSim 4 writes it.
const std::string kLoadsFile = R"(<?xml version="1.0" encoding="UTF-8" ?>
<OpenSimDocument Version="40000">
<ExternalLoads name="grf"><objects>
<ExternalForce name="right">
<applied_to_body>calcn_r</applied_to_body>
<force_expressed_in_body>ground</force_expressed_in_body>
<point_expressed_in_body>talus_r</point_expressed_in_body>
<force_identifier>ground_force_v</force_identifier>
<point_identifier>ground_force_p</point_identifier>
<torque_identifier>ground_torque_</torque_identifier>
</ExternalForce>
<ExternalForce name="left"><appliesForce>false</appliesForce><applied_to_body>calcn_l</applied_to_body></ExternalForce>
<ExternalForce name="old"><isDisabled>true</isDisabled><applied_to_body>calcn_l</applied_to_body></ExternalForce>
</objects><groups/><datafile>subject01_grf.mot</datafile>
<external_loads_model_kinematics_file>Unassigned</external_loads_model_kinematics_file>
</ExternalLoads></OpenSimDocument>)";

ExternalLoadsFile parsed(const std::string& text) { return parse_external_loads(text, "grf.xml", "folder"); }

std::string file_error(const std::string& text) {
  try {
    static_cast<void>(parsed(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string loads_with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ExternalLoadsFile, ReadsTheForcesThatAct) {
  const ExternalLoadsFile file = parsed(kLoadsFile);
  ASSERT_EQ(file.sources.size(), 1u);
  const ExternalLoadSource& s = file.sources[0];
  EXPECT_EQ(s.name, "right");
  EXPECT_EQ(s.place, "grf.xml:4: ExternalForce 'right'");
  EXPECT_EQ(s.body, "calcn_r");
  EXPECT_EQ(s.force_frame, "ground");
  EXPECT_EQ(s.point_frame, "talus_r");
  EXPECT_EQ(s.force, "ground_force_v");
  EXPECT_EQ(s.point, "ground_force_p");
  EXPECT_EQ(s.moment, "ground_torque_");
  EXPECT_EQ(file.data, std::filesystem::path("folder/subject01_grf.mot"));
  EXPECT_TRUE(file.warnings.empty());
}

TEST(ExternalLoadsFile, WarnsOfWhatItDoesNotUse) {
  EXPECT_THAT(parsed(loads_with(kLoadsFile, "kinematics_file>Unassigned", "kinematics_file>ik.mot")).warnings,
              ElementsAre(HasSubstr("external_loads_model_kinematics_file 'ik.mot' is not used")));
  EXPECT_THAT(parsed(loads_with(kLoadsFile, "</torque_identifier>",
                                "</torque_identifier><data_source_name>x</data_source_name>"))
                  .warnings,
              ElementsAre(HasSubstr("data_source_name 'x' is not used")));
  EXPECT_THAT(
      parsed(loads_with(kLoadsFile, "<ExternalForce name=\"left\">", "<PrescribedForce name=\"p\"/><ExternalForce>"))
          .warnings,
      ElementsAre(HasSubstr("PrescribedForce 'p': not used")));
  EXPECT_THAT(
      parsed(loads_with(kLoadsFile, "<ExternalForce name=\"right\">", "<ExternalForce><isDisabled>true</isDisabled>"))
          .warnings,
      ElementsAre(HasSubstr("holds no force that acts")));
}

TEST(ExternalLoadsFile, RefusesWhatIsNoForce) {
  EXPECT_THAT(file_error(loads_with(kLoadsFile, "calcn_r", "")),
              HasSubstr("grf.xml:4: ExternalForce 'right': applied_to_body"));
  std::string none = loads_with(kLoadsFile, "ground_force_v", "Unassigned");
  none = loads_with(none, "ground_torque_", "");
  EXPECT_THAT(file_error(none), HasSubstr("neither force_identifier nor torque_identifier names columns"));
  EXPECT_THAT(file_error("<OpenSimDocument Version=\"40000\"><Model/></OpenSimDocument>"),
              HasSubstr("holds no ExternalLoads"));
  EXPECT_THAT(file_error("<ExternalLoads/>"), HasSubstr("not an OpenSim ExternalLoads"));
  EXPECT_THAT(file_error("grf"), HasSubstr("not well-formed XML"));
}

TEST(ExternalLoadsFile, IsReadBackAsWritten) {
  const std::vector<ExternalLoadSource> sources{
      {.name = "a&b", .body = "foot_r", .force = "a&b_v", .point = "a&b_p"},
      {.name = "c", .body = "foot_l", .force_frame = "foot_l", .point_frame = "foot_l", .moment = "m"}};
  const ExternalLoadsFile file = parsed(to_external_loads_text(sources, "forces.sto"));
  ASSERT_EQ(file.sources.size(), 2u);
  EXPECT_EQ(file.sources[0].name, "a&b");
  EXPECT_EQ(file.sources[0].force, "a&b_v");
  EXPECT_EQ(file.sources[0].moment, "");
  EXPECT_EQ(file.sources[1].force_frame, "foot_l");
  EXPECT_EQ(file.sources[1].moment, "m");
  EXPECT_EQ(file.data, std::filesystem::path("folder/forces.sto"));
}

}  // namespace
}  // namespace veridyn::muscle
