#include "veridyn/aircraft/model/subject.hpp"

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::HasSubstr;

Subject parsed_subject(std::string_view text) {
  const Study study = Study::parse(text, "s.toml");
  Subject s = read_subject(study.root().table("subject"));
  study.root().finish();
  return s;
}

std::string message(std::string_view text) {
  try {
    parsed_subject(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

constexpr std::string_view kGeometry = "[subject]\nmass = 2\nwing_area = 0.45\nspan = 1.88\nchord = 0.24\n";

TEST(Subject, EveryBuiltInOneReadsBackEqualFromItsFile) {
  for (const std::string& name : builtin_subject_names()) {
    const Subject s = builtin_subject(name);
    EXPECT_TRUE(parsed_subject(write_subject_toml(s)) == s) << write_subject_toml(s);
    EXPECT_FALSE(s.sign_convention.empty());
    EXPECT_TRUE(s.model.unknown_parameters().empty());
  }
}

TEST(Subject, OverridesValuesOfABuiltInOne) {
  const Subject s = parsed_subject(
      "[subject]\nbuiltin = \"unatrap\"\nname = \"mine\"\nmass = \"27.8 lb\"\n[subject.model]\nCm = [\"1\", "
      "\"alpha\"]\n"
      "[subject.actuators.elevator]\nupper = \"15 deg\"\n[subject.propulsion]\nposition = [-1, 0, 0.1]\n");
  EXPECT_EQ(s.name, "mine");
  EXPECT_NEAR(s.mass, 27.8 * 0.45359237, 1e-12);
  EXPECT_DOUBLE_EQ(s.chord, 0.34);
  EXPECT_EQ(s.model.at(Coefficient::kCm).size(), 2u);
  EXPECT_DOUBLE_EQ(*s.model.at(Coefficient::kCL).value_of("alpha"), 3.607);
  EXPECT_DOUBLE_EQ(s.elevator.lower, -15 * M_PI / 180);
  EXPECT_EQ(s.propulsion.kind, PropulsionKind::kPolynomial);
  EXPECT_DOUBLE_EQ(s.propulsion.position[2], 0.1);
}

TEST(Subject, HasReferenceLengthsOfItsOwnForEachAxis) {
  const Subject s = parsed_subject(std::string(kGeometry) + "reference_lengths = { roll = \"94 cm\", yaw = 0.6 }\n");
  EXPECT_DOUBLE_EQ(s.roll_length(), 0.94);
  EXPECT_DOUBLE_EQ(s.pitch_length(), 0.24) << "the chord where it is not given";
  EXPECT_DOUBLE_EQ(s.yaw_length(), 0.6);
  EXPECT_DOUBLE_EQ(s.span, 1.88) << "still the wing's";
  EXPECT_TRUE(parsed_subject(write_subject_toml(s)) == s) << write_subject_toml(s);
  EXPECT_FALSE(parsed_subject(kGeometry) == s);
  EXPECT_THAT(message(std::string(kGeometry) + "reference_lengths = { pitch = -0.1 }\n"), HasSubstr("must be > 0"));
  EXPECT_THAT(message(std::string(kGeometry) + "reference_lengths = { jaw = 0.1 }\n"), HasSubstr("yaw"));
}

TEST(Subject, WithoutInertiaIsASubjectWithoutMoments) {
  const Subject s = parsed_subject(kGeometry);
  EXPECT_FALSE(s.inertia.has_value());
  EXPECT_NEAR(s.aspect_ratio(), 1.88 * 1.88 / 0.45, 1e-14);
}

TEST(Subject, RefusesWrongValuesWithPlaceAndRule) {
  EXPECT_EQ(message("[subject]\nmass = 0\n"), "s.toml:2: subject.mass: = 0 must be > 0");
  EXPECT_THAT(message("[subject]\nmass = 2\n"), HasSubstr("subject: wing_area, span, chord are missing"));
  EXPECT_THAT(message("[subject]\nbuiltin = \"unatrapp\"\n"),
              HasSubstr("s.toml:2: subject.builtin: unknown aircraft 'unatrapp' (did you mean 'unatrap'?)"));
  const std::string base(kGeometry);
  EXPECT_THAT(message(base + "inertia = { Jx = 1, Jy = 1, Jz = 1, Jxz = 1 }\n"), HasSubstr("not positive definite"));
  EXPECT_THAT(message(base + "inertia = { Jx = 1, Jy = 0, Jz = 1 }\n"),
              HasSubstr("subject.inertia.Jy: = 0 must be > 0"));
  EXPECT_THAT(message(base + "imu_position = [1, 2]\n"), HasSubstr("has 2 numbers, needs 3"));
  EXPECT_THAT(message(base + "spann = 3\n"), HasSubstr("span"));
  EXPECT_THAT(message(base + "[subject.actuators.rudder]\nlower = 1\nupper = 0\n"), HasSubstr("is not below upper"));
  EXPECT_THAT(message(base + "[subject.actuators.flap]\nlower = 1\n"), HasSubstr("flap"));
  EXPECT_THAT(message(base + "[subject.propulsion]\nkind = \"momentum\"\n"), HasSubstr("S_prop, k_motor are missing"));
  EXPECT_THAT(message(base + "[subject.propulsion]\nkind = \"polynomial\"\npolynomial = { thrust = 2 }\n"),
              HasSubstr("is not a product of throttle^i and Va^j"));
}

}  // namespace
}  // namespace veridyn::aircraft
