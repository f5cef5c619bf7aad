// The program on studies of muscles.
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "veridyn/io/tables/csv.hpp"

namespace veridyn {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MuscleProgram : public ProgramTest {
 protected:
  static constexpr const char* kSubject = "[subject]\nmodel = \"arm\"\n";
};

TEST_F(MuscleProgram, SimulatesItsOwnTemplate) {
  ASSERT_EQ(run("init muscle --quiet --out " + folder_.string()).exit_code, 0);
  EXPECT_THAT(read_file(folder_ / "study.toml"), HasSubstr("model = \"arm\""));
  const Outcome done =
      run("simulate " + (folder_ / "study.toml").string() + " --set motion.duration=0.2 --json" + out());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  for (const char* name :
       {"motion.csv", "muscles.csv", "states.sto", "controls.sto", "model.osim", "report.html", "run.json"})
    EXPECT_TRUE(std::filesystem::exists(in_out(name))) << name;
  const auto summary = nlohmann::json::parse(done.text);
  EXPECT_EQ(summary["method"], "forward");
  EXPECT_EQ(summary["completed"], true);
  EXPECT_EQ(summary["rows"], 41);
  EXPECT_EQ(summary["muscles"].size(), 6u);
  // What it wrote it reads: the model, and the states and controls.
  EXPECT_EQ(run("inspect " + in_out("model.osim").string()).exit_code, 0);
  const Recording motion = io::to_recording(io::read_csv_file(in_out("motion.csv")));
  EXPECT_TRUE(motion.has("elbow_flexion"));
}

TEST_F(MuscleProgram, TemplateHoldsEveryKeyInASpellingThatIsUnderstood) {
  ASSERT_EQ(run("init muscle --quiet --out " + folder_.string()).exit_code, 0);
  // All keys of one method after the other, uncommented where they stand.
  std::string text = read_file(folder_ / "study.toml");
  const auto uncomment = [&](const std::string& key) {
    const std::size_t at = text.find("# " + key);
    ASSERT_NE(at, std::string::npos) << key;
    text.erase(at, 2);
  };
  for (const char* key : {"paths =",
                          "locked =",
                          "unlocked =",
                          "without_unsupported",
                          "\"biceps_long.optimal",
                          "\"biceps_long.max",
                          "[[subject.load]]",
                          "body =",
                          "mass =",
                          "location =",
                          "begin =",
                          "rate =",
                          "accuracy =",
                          "reserve_force =",
                          "elbow_flexion = \"30",
                          "elbow_flexion = \"0",
                          "biceps_long = 0",
                          "[[motion.excitation_step]]",
                          "time =",
                          "brachialis =",
                          "window",
                          "kp",
                          "kv",
                          "min_control",
                          "max_control",
                          "exponent",
                          "formulation"})
    uncomment(key);
  const Outcome done =
      run("simulate " + file("all.toml", text) + " --set motion.duration=0.05 --set subject.unlocked=[]" + out());
  EXPECT_EQ(done.exit_code, 0) << done.text;
}

TEST_F(MuscleProgram, WritesBackTheModelWithTheParametersUsed) {
  const std::string study =
      file("s.toml", std::string(kSubject) +
                         "[subject.parameters]\nbrachialis.max_isometric_force = 901.5\n[motion]\nduration = 0.05\n");
  ASSERT_EQ(run("simulate " + study + out()).exit_code, 0);
  EXPECT_THAT(read_file(in_out("model.osim")),
              AllOf(HasSubstr("<max_isometric_force>901.5<"), testing::Not(HasSubstr("<max_isometric_force>950<"))));
}

TEST_F(MuscleProgram, ReplaysAControlFromItsFiles) {
  const std::string control =
      file("control.toml", std::string(kSubject) +
                               "locked = [\"shoulder_flexion\"]\n[motion]\nmethod = \"computed muscle control\"\n"
                               "duration = 0.2\n[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"30 deg\"\n"
                               "to = \"45 deg\"\nduration = 0.2\n");
  ASSERT_EQ(run("simulate " + control + out()).exit_code, 0);
  const std::string replay =
      file("replay.toml", std::string(kSubject) +
                              "locked = [\"shoulder_flexion\"]\n[motion]\nduration = 0.2\n"
                              "start_file = \"out/states.sto\"\nexcitation_file = \"out/controls.sto\"\n"
                              "interpolation = \"hold\"\n");
  ASSERT_EQ(run("simulate " + replay + " --quiet --out " + (folder_ / "replay").string()).exit_code, 0);
  const Recording first = io::to_recording(io::read_csv_file(in_out("motion.csv")));
  const Recording again = io::to_recording(io::read_csv_file(folder_ / "replay" / "motion.csv"));
  const auto& a = first.at("elbow_flexion").value;
  const auto& b = again.at("elbow_flexion").value;
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 40u);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-6) << i;
}

TEST_F(MuscleProgram, SaysWhenASimulationCannotFinishAndKeepsWhatThereIs) {
  // Without limits of its joints the elbow is beyond 10^4 rad after 0.01 s.
  const std::string study =
      file("s.toml", std::string(kSubject) +
                         "locked = [\"shoulder_flexion\"]\n[motion]\nduration = 1\naccuracy = 0.1\n"
                         "[motion.start_speed]\nelbow_flexion = 1e6\n");
  const Outcome failed = run("simulate " + study + out());
  EXPECT_EQ(failed.exit_code, 1) << failed.text;
  EXPECT_THAT(failed.text, HasSubstr("motion.csv"));
  EXPECT_EQ(std::count(failed.text.begin(), failed.text.end(), '\n'), 1) << failed.text;
  EXPECT_THAT(read_file(in_out("report.html")), HasSubstr("Not finished"));
  EXPECT_TRUE(std::filesystem::exists(in_out("motion.csv")));
}

TEST_F(MuscleProgram, RefusesWrongStudies) {
  expect_refusal("simulate " + file("s.toml", "[subject]\nmodel = \"amr\"\n[motion]\n") + out(), "did you mean 'arm'?");
  expect_refusal("simulate " + file("s.toml", "[subject]\nmodel = \"leg.osim\"\n[motion]\n") + out(),
                 "leg.osim: no such file");
  expect_refusal("simulate " + file("s.toml", std::string(kSubject) + "[motion]\nratte = 1\n") + out(),
                 "s.toml:4: motion.ratte: unknown key (did you mean 'rate'?)");
}

TEST_F(MuscleProgram, RecordsTheSeedOfTheStudy) {
  const std::string motion = std::string(kSubject) + "[motion]\nduration = 0.01\n";
  ASSERT_EQ(run("simulate " + file("s.toml", "seed = 42\n" + motion) + out()).exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(read_file(in_out("run.json")))["seed"], 42);
  ASSERT_EQ(run("simulate " + file("s.toml", motion) + " --seed 7" + out()).exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(read_file(in_out("run.json")))["seed"], 7);
}

TEST_F(MuscleProgram, IdentifiesAndValidatesTheTasksOfItsTemplate) {
  ASSERT_EQ(run("init muscle --quiet --out " + folder_.string()).exit_code, 0);
  const std::string study = (folder_ / "study.toml").string();
  const Outcome done = run("identify " + study + " --json" + out());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  for (const char* name : {"estimate.json", "parameters.csv", "tasks.csv", "model.osim", "report.html", "run.json"})
    EXPECT_TRUE(std::filesystem::exists(in_out(name))) << name;
  const auto summary = nlohmann::json::parse(done.text);
  EXPECT_EQ(summary["estimate"]["parameters"][0]["status"], "identified");
  EXPECT_EQ(summary["estimate"]["grades"]["prediction"]["grade"], "yes");
  EXPECT_THAT(read_file(in_out("tasks.csv")), HasSubstr("\"task 12: flexion 90-130 deg, shoulder 45 deg\",unseen"));
  EXPECT_EQ(run("inspect " + in_out("model.osim").string()).exit_code, 0);
  const Outcome again = run("validate " + study + " --set tasks.numbers=[15] --estimate-file " +
                            in_out("estimate.json").string() + " --out " + (folder_ / "other").string());
  ASSERT_EQ(again.exit_code, 0) << again.text;
  EXPECT_THAT(again.text, HasSubstr("task 15"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "other/model.osim"));
}

TEST_F(MuscleProgram, SaysWhichTaskWouldTellMostAndFollowsProfiles) {
  ASSERT_EQ(run("init muscle --quiet --out " + folder_.string()).exit_code, 0);
  const Outcome done = run("identify " + (folder_ / "study.toml").string() +
                           " --set identify.starts=1 --set identify.profiles=true --json" + out());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  const auto summary = nlohmann::json::parse(done.text);
  EXPECT_EQ(summary["profiles"]["strength"]["low_end"], "closed");
  EXPECT_LT(summary["profiles"]["strength"]["low95"], summary["profiles"]["strength"]["high95"]);
  ASSERT_EQ(summary["estimate"]["next_measurements"].size(), 3u);
  EXPECT_EQ(summary["estimate"]["next_measurements"][0]["widest_now"], "strength");
  EXPECT_THAT(read_file(in_out("profiles.csv")), HasSubstr("parameter,unit,value,likelihood_ratio,strength\n"));
  EXPECT_THAT(read_file(in_out("profile_intervals.csv")), HasSubstr(",closed,closed\n"));
  EXPECT_THAT(read_file(in_out("report.html")), AllOf(HasSubstr("Which task next"), HasSubstr("Profile likelihood")));
}

TEST_F(MuscleProgram, SaysWhereAndInWhichStateEverySearchDiverges) {
  static_cast<void>(file("u.csv", "time,brachialis\n0,0.1\n1,0.3\n"));
  static_cast<void>(file("q.csv", "time,elbow_flexion\n0,0.4\n0.1,0.5\n0.2,0.6\n0.3,0.7\n0.4,0.8\n0.5,0.9\n"));
  // No skeleton turns with such a weight at such a distance: its inertia is no number.
  const std::string study = file(
      "s.toml", std::string(kSubject) +
                    "[[task]]\nname = \"trial\"\nexcitation_file = \"u.csv\"\nmeasured = \"q.csv\"\n"
                    "[task.held]\nshoulder_flexion = 0\n[[task.load]]\nbody = \"forearm\"\nmass = 1\n"
                    "location = [0, -1e200, 0]\n[[output]]\nname = \"elbow_flexion\"\nnoise = 1e-3\n"
                    "[[parameter]]\nmuscles = [\"brachialis\"]\nfields = [\"max_isometric_force\"]\nbounds = \"20 %\"\n"
                    "[identify]\nstarts = 1\n");
  const Outcome failed = run("identify " + study + out());
  EXPECT_EQ(failed.exit_code, 1) << failed.text;
  EXPECT_THAT(failed.text, HasSubstr("trial: the simulation diverges at 0 s: "));
  EXPECT_THAT(failed.text, HasSubstr(" is "));
  EXPECT_EQ(std::count(failed.text.begin(), failed.text.end(), '\n'), 1) << failed.text;
}

TEST_F(MuscleProgram, SaysWhatIsMissingForAnEstimate) {
  expect_refusal("identify " + file("s.toml", std::string(kSubject) + "[motion]\n") + out(),
                 "tasks: is missing: muscles are estimated from tasks; `veridyn simulate` runs a [motion]");
  EXPECT_THAT(run("identify --help").text, HasSubstr("a person's tasks"));
  EXPECT_THAT(run("simulate --help").text, AllOf(HasSubstr("Aircraft"), HasSubstr("Muscles")));
}

}  // namespace
}  // namespace veridyn
