// What `identify` wrote is simulated and scaled by naming its file, unless it was rejected.
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"

namespace veridyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class SubjectFileProgram : public ProgramTest {
 protected:
  [[nodiscard]] std::string loud() const { return " --out " + (folder_ / "out").string(); }
  /// A study that drives the car which `identify` wrote to `out`.
  [[nodiscard]] std::string driven(const std::string& file, const std::string& more = "") const {
    const std::filesystem::path study = folder_ / "driven.toml";
    write_file(study, "[subject]\nfile = \"" + file + "\"\n" + more +
                          "[drive]\nmodel = \"linear bicycle\"\nmanoeuvre = \"step steer\"\nspeed = 15\n");
    return study.string();
  }
};

TEST_F(SubjectFileProgram, AnIdentifiedCarIsSimulatedAndScaled) {
  const std::string sweep = (test::source_folder() / "examples/studies/vehicle/identify_sweep.toml").string();
  ASSERT_EQ(run("identify " + sweep + out()).exit_code, 0);
  const std::string file = (folder_ / "out" / "subject.toml").string();
  const std::string written = read_file(file);
  EXPECT_THAT(written, HasSubstr("[subject.grades]"));
  const Outcome simulated = run("simulate " + driven(file) + " --out " + (folder_ / "simulated").string());
  EXPECT_EQ(simulated.exit_code, 0) << simulated.text;
  EXPECT_THAT(simulated.text, Not(HasSubstr("no physical constants")));
  // run.json says by which file, as it was.
  const auto record = nlohmann::json::parse(read_file(folder_ / "simulated" / "run.json"));
  ASSERT_EQ(record["inputs"].size(), 2U) << record.dump();
  EXPECT_EQ(record["inputs"][0]["file"], file);
  const Outcome sum = run_in_shell("sha1sum " + file, "--version");
  EXPECT_EQ(record["inputs"][0]["sha1"], sum.text.substr(0, 40));
  const std::string stiffness = written.substr(written.find("C_f = "), 20);
  EXPECT_THAT(read_file(folder_ / "simulated" / "subject.toml"), HasSubstr(stiffness));
  const std::string scale = (test::source_folder() / "examples/studies/vehicle/scale.toml").string();
  const Outcome scaled =
      run("scale " + scale + " --set subject.file=" + file + " --out " + (folder_ / "scaled").string());
  EXPECT_EQ(scaled.exit_code, 0) << scaled.text;
}

TEST_F(SubjectFileProgram, RejectedParametersAreNotDriven) {
  const std::filesystem::path file = folder_ / "subject.toml";
  const std::string car = "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[subject.grades]\n";
  write_file(file, car + "parameters = \"no\"\nprediction = \"no\"\n");
  expect_refusal("simulate " + driven(file.string()) + out(),
                 "subject.toml:4: subject.grades: the identification that wrote this subject rejected its parameters");
  const Outcome asked_for = run("simulate " + driven(file.string(), "accept_rejected = true\n") + loud());
  EXPECT_EQ(asked_for.exit_code, 0) << asked_for.text;
  // What it writes carries the grades on.
  EXPECT_THAT(read_file(folder_ / "out" / "subject.toml"),
              HasSubstr("[subject.grades]\ndata = \"not judged\"\nparameters = \"no\""));
  EXPECT_THAT(asked_for.text, HasSubstr("warning: the identification that wrote this subject rejected its parameters"));
  write_file(file, car + "parameters = \"no\"\nprediction = \"with care\"\n");
  EXPECT_THAT(run("simulate " + driven(file.string()) + loud()).text, HasSubstr("are no physical constants"));
}

}  // namespace
}  // namespace veridyn
