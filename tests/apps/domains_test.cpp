// The table domain x command: each command on a study of each domain.
#include <array>

#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"

namespace veridyn {
namespace {

using testing::HasSubstr;

struct Cell {
  const char* command;
  const char* domain;
  const char* refusal;  ///< what the message holds after the command's name; none: the command works
};

class Table : public ProgramTest, public testing::WithParamInterface<Cell> {
 protected:
  [[nodiscard]] std::string study(const std::string& domain) const {
    if (domain == "aircraft")
      return file("aircraft.toml",
                  "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 40\nairspeed = 20\nplan = \"none\"\n"
                  "turbulence = \"none\"\n");
    if (domain == "vehicle")
      return file("vehicle.toml",
                  "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"bicycle\"\n"
                  "manoeuvre = \"random steer\"\namplitude = \"2 deg\"\nlength = 20\n[scale]\nlength_ratio = 0.2\n");
    if (domain == "muscle")
      return file("muscle.toml",
                  "[subject]\nmodel = \"arm\"\n[motion]\nduration = 0.02\n[tasks]\nnumbers = [8]\n[person]\n"
                  "[[parameter]]\nname = \"strength\"\nmuscles = [\"all\"]\nfields = [\"max_isometric_force\"]\n"
                  "factor = true\n[identify]\nstarts = 1\n");
    if (domain == "cueing")
      return file("cueing.toml",
                  "[cue]\nalgorithms = [\"classical\", \"optimal\"]\n[subject]\nkind = \"vehicle\"\n"
                  "builtin = \"reference\"\n[drive]\nmodel = \"bicycle\"\nmanoeuvre = \"step steer\"\n"
                  "amplitude = \"2 deg\"\nduration = 8\n");
    return test::source_folder().string() + "/examples/studies/" + domain + "/study.toml";
  }
  /// An estimate of what a validation needs.
  [[nodiscard]] std::string estimate(const std::string& domain) const {
    const auto parameter = [](const std::string& name, const std::string& value) {
      return "{\"name\": \"" + name + "\", \"value\": " + value +
             ", \"sigma\": 0.1, \"low95\": 1, \"high95\": 9, \"unit\": \"1\", \"status\": \"identified\"}";
    };
    const bool vehicle = domain == "vehicle";
    const std::string parameters =
        vehicle ? parameter("C_f", "1e5") + ", " + parameter("C_r", "1e5") + ", " + parameter("I_z", "2500")
        : domain == "muscle" ? parameter("strength", "1.02")
                             : parameter("CL_alpha", "4.5");
    return file("estimate.json", "{\"subject\": \"x\", \"method\": \"OLS\", \"parameters\": [" + parameters +
                                     "], \"covariance\": " + (vehicle ? "[[1,0,0],[0,1,0],[0,0,1]]" : "[[1]]") +
                                     ", \"verdict\": \"\", \"warnings\": []}");
  }
};

TEST_P(Table, CommandWorksOrSaysForWhichDomainsItIs) {
  const auto [command, domain, refusal] = GetParam();
  std::string arguments = std::string(command) + " " + study(domain) + out();
  if (std::string(command) == "validate") arguments += " --estimate-file " + estimate(domain);
  const Outcome outcome = run(arguments);
  if (refusal != nullptr) {
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr(std::string(".toml: ") + command + refusal));
    EXPECT_THAT(outcome.text, HasSubstr("`veridyn "));  // what is possible instead
    EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << outcome.text;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  } else {
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
    EXPECT_TRUE(std::filesystem::exists(in_out("run.json")));
  }
}

constexpr const char* kWorks = nullptr;

INSTANTIATE_TEST_SUITE_P(
    Of, Table,
    testing::Values(
        Cell{"simulate", "aircraft", kWorks}, Cell{"simulate", "vehicle", kWorks}, Cell{"simulate", "muscle", kWorks},
        Cell{"simulate", "swing_test",
             " is for aircraft, vehicles and musculoskeletal models; this study is of a swing test; "},
        Cell{"simulate", "calibration",
             " is for aircraft, vehicles and musculoskeletal models; this study is of an air-data calibration; "},
        Cell{"reconstruct", "aircraft", kWorks},
        Cell{"reconstruct", "vehicle", " is for aircraft; this study is of a vehicle; "},
        Cell{"reconstruct", "muscle", " is for aircraft; this study is of a musculoskeletal model; "},
        Cell{"reconstruct", "swing_test", " is for aircraft; this study is of a swing test; "},
        Cell{"reconstruct", "calibration", " is for aircraft; this study is of an air-data calibration; "},
        Cell{"identify", "aircraft", kWorks}, Cell{"identify", "vehicle", kWorks}, Cell{"identify", "muscle", kWorks},
        Cell{"identify", "swing_test", kWorks}, Cell{"identify", "calibration", kWorks},
        Cell{"validate", "aircraft", kWorks}, Cell{"validate", "vehicle", kWorks}, Cell{"validate", "muscle", kWorks},
        Cell{"validate", "swing_test",
             " is for aircraft, vehicles and musculoskeletal models; this study is of a swing test; "},
        Cell{"validate", "calibration",
             " is for aircraft, vehicles and musculoskeletal models; this study is of an air-data calibration; "},
        Cell{"track", "aircraft", kWorks}, Cell{"track", "vehicle", kWorks},
        Cell{"track", "muscle", " is for aircraft and vehicles; this study is of a musculoskeletal model; "},
        Cell{"track", "swing_test", " is for aircraft and vehicles; this study is of a swing test; "},
        Cell{"track", "calibration", " is for aircraft and vehicles; this study is of an air-data calibration; "},
        Cell{"export", "aircraft", kWorks}, Cell{"export", "vehicle", kWorks},
        Cell{"export", "muscle", " is for aircraft and vehicles; this study is of a musculoskeletal model; "},
        Cell{"export", "swing_test", " is for aircraft and vehicles; this study is of a swing test; "},
        Cell{"export", "calibration", " is for aircraft and vehicles; this study is of an air-data calibration; "},
        Cell{"scale", "aircraft", " is for vehicles; this study is of an aircraft; "}, Cell{"scale", "vehicle", kWorks},
        Cell{"scale", "muscle", " is for vehicles; this study is of a musculoskeletal model; "},
        Cell{"scale", "swing_test", " is for vehicles; this study is of a swing test; "},
        Cell{"scale", "calibration", " is for vehicles; this study is of an air-data calibration; "},
        Cell{"cue", "aircraft", " is for motion platforms; this study is of an aircraft; "},
        Cell{"cue", "vehicle", " is for motion platforms; this study is of a vehicle; "},
        Cell{"cue", "muscle", " is for motion platforms; this study is of a musculoskeletal model; "},
        Cell{"cue", "cueing", kWorks},
        Cell{"identify", "cueing",
             " is for aircraft, vehicles, musculoskeletal models, swing tests and air-data calibrations; this study is "
             "of "
             "a motion platform; "},
        Cell{"simulate", "cueing",
             " is for aircraft, vehicles and musculoskeletal models; this study is of a motion platform; "}),
    [](const auto& cell) { return std::string(cell.param.command) + "_" + cell.param.domain; });

using Domains = ProgramTest;

TEST_F(Domains, AreNamedWhereTheSubjectDoesNotSayWhichItIs) {
  const auto refused = [&](const std::string& text, const std::string& message) {
    expect_refusal("identify " + file("s.toml", text) + out(), message);
  };
  // Keys and channels that only vehicles have; all that is missing at once.
  refused("[subject]\nmass = 1500\n[drive]\n", "subject: a, b, I_z, C_f, C_r, unsprung_mass, ");
  refused("[subject]\nmass = 1500\n[data]\nfile = \"d.csv\"\n[data.map]\nsteer = \"angle\"\n",
          "subject: a, b are missing");
  refused("[subject]\nC_f = 5e4\na = 1.2\n[data]\nfile = \"d.csv\"\n", "subject: mass, b are missing");
  refused("[subject]\nkind = \"vehicel\"\n", "subject.kind: there is no kind 'vehicel' (did you mean 'vehicle'?)");
  refused("[subject]\nmass = 1\n[motion]\n",
          "subject.model: is missing: a study with [motion] is of a musculoskeletal");
  refused("[subject]\nbuiltin = \"saloon\"\n", "data: is missing: the study names no recording, and no [drive]");
  // A table of another domain is still an unknown key.
  refused(
      "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmanoeuvre = \"step steer\"\n"
      "amplitude = 0.02\nduration = 3\n[motion]\n",
      "motion: unknown key");
}

}  // namespace
}  // namespace veridyn
