#include "tests/apps/program.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "tests/support/folders.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/io/tables/csv.hpp"

namespace veridyn {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Program : public ProgramTest {
 protected:
  static constexpr const char* kFlight =
      "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 90\nairspeed = 20\nturbulence = \"low_light\"\n"
      "[reconstruct]\nsensors = \"reference\"\nturbulence = \"low_light\"\n"
      "[[flight.manoeuvre]]\nkind = \"multisine\"\nstart = 5\nduration = 35\nsurfaces = [\"elevator\"]\n"
      "[[flight.manoeuvre]]\nkind = \"multisine\"\nstart = 45\nduration = 40\nsurfaces = [\"aileron\", \"rudder\"]\n";
};

// Whenever it is stopped, an identification has left all of its results or none.
TEST_F(Program, AnInterruptedIdentificationOfAnAircraftLeavesNothingHalfDone) {
  const std::string flight = file("flight.toml", std::string(kFlight) +
                                                     "[identify]\nbootstrap = 100\noutput_error = true\n"
                                                     "[validate]\nopen_loop = \"10 s\"\n");
  const std::string to = " --out " + (folder_ / "out").string();
  std::size_t stopped_early = 0;
  for (const char* stage :
       {"simulating the flight", "aligning sensor delays", "checking the recording", "identifying coefficients",
        "output error", "bootstrap", "flying open loop", "validating on the hold-out", "writing the results"}) {
    SCOPED_TRACE(stage);
    fs::remove_all(folder_ / "out");
    const Outcome stopped = run_interrupted_after(stage, 1, "identify " + flight + to, folder_);
    if (stopped.exit_code == 1) {
      ++stopped_early;
      EXPECT_THAT(stopped.text, testing::EndsWith("veridyn: interrupted, nothing was written\n"));
      EXPECT_FALSE(fs::exists(folder_ / "out"));
      continue;
    }
    EXPECT_EQ(stopped.exit_code, 0) << "the signal came too late: " << stopped.text;
    for (const char* name : {"report.html", "estimate.json", "subject.toml", "run.json"})
      EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
    for (const auto& entry : fs::directory_iterator(folder_ / "out"))
      EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
  }
  EXPECT_GE(stopped_early, 3U);
}

TEST_F(Program, ShowsItsCommandsAndNoOthers) {
  const Outcome help = run("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* command : {"demo",     "init",    "inspect", "simulate",  "reconstruct", "identify", "sensitivity",
                              "validate", "export",  "track",   "reproduce", "cue",         "rig",      "camera",
                              "serve",    "regress", "compare", "checks",    "keys",        "priors"})
    EXPECT_THAT(help.text, HasSubstr("\n  " + std::string(command) + " "));
  EXPECT_EQ(std::ranges::count(help.text.substr(help.text.find("Subcommands:")), '\n'), 21 + 2)
      << "with their heading and an empty line";
}

TEST_F(Program, HelpsEveryCommandWithAnExample) {
  for (const char* command : {"demo",
                              "inspect",
                              "simulate",
                              "reconstruct",
                              "identify",
                              "sensitivity",
                              "validate",
                              "export",
                              "track",
                              "cue",
                              "serve",
                              "regress",
                              "compare",
                              "rig vehicle",
                              "rig platform",
                              "rig test",
                              "camera calibrate",
                              "reproduce aircraft",
                              "init aircraft",
                              "init muscle",
                              "init cueing"}) {
    const Outcome help = run(std::string(command) + " --help");
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_THAT(help.text, HasSubstr("Example:\n  veridyn ")) << command;
    for (const char* option : {"--out", "--set", "--seed", "--threads", "--quiet", "--json"})
      EXPECT_THAT(help.text, HasSubstr(option)) << command;
  }
}

TEST_F(Program, WritesAStudyThatItUnderstandsAndKeepsAnExistingOne) {
  const std::string in = " --quiet --out " + folder_.string();
  EXPECT_EQ(run("init aircraft --log missing.bin" + in).exit_code, 0);
  const std::string study = (folder_ / "study.toml").string();
  // A mass that nobody weighed would make every coefficient wrong.
  expect_refusal("identify " + study + out(), "subject.mass: is still the template's placeholder");
  std::string filled = study;
  for (const char* set : {"mass=2", "wing_area=0.31", "span=1.27", "chord=0.25", "actuators.elevator.upper=0.35",
                          "actuators.aileron.upper=0.35", "actuators.rudder.upper=0.35"})
    filled += std::string(" --set subject.") + set;
  expect_refusal("identify " + filled + out(), "missing.bin: no such file");
  const Outcome again = run("init aircraft" + in);
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.text, HasSubstr("is there already"));
}

TEST_F(Program, GoesFromASimulatedFlightToAValidatedModel) {
  const std::string study = file("study.toml", kFlight);
  const Outcome done = run("identify " + study + " --out " + (folder_ / "out").string());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  for (const char* name : {"estimate.json", "parameters.csv", "flight.csv", "coefficients.csv", "validation.csv",
                           "subject.toml", "report.html", "run.json"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
  }
  // The model says for which purposes it may be used.
  EXPECT_THAT(read_file(folder_ / "out" / "subject.toml"), ::testing::StartsWith("# The recording agrees with itself"));
  EXPECT_THAT(done.text, HasSubstr("The recording agrees with itself"));
  const estimation::Estimate estimate = io::read_estimate(folder_ / "out" / "estimate.json");
  const estimation::Parameter* Cm_alpha = estimate.find("Cm_alpha");
  ASSERT_NE(Cm_alpha, nullptr);
  EXPECT_EQ(Cm_alpha->status, estimation::ParameterStatus::kIdentified);
  // The truth of the built-in subject; three standard deviations, of which the scale of the vane is most.
  EXPECT_NEAR(Cm_alpha->value, -0.7, 3.0 * Cm_alpha->sigma);
  EXPECT_LT(Cm_alpha->sigma, 0.15);  // the lag of the elevator is unknown too

  // The same estimate on a flight with another seed.
  const Outcome validated =
      run("validate " + study + " --seed 9 --estimate-file " + (folder_ / "out" / "estimate.json").string() +
          " --json --quiet --out " + (folder_ / "other").string());
  EXPECT_EQ(validated.exit_code, 0) << validated.text;
  EXPECT_THAT(validated.text, HasSubstr("\"name\": \"Cm\",\n      \"verdict\": \"identified\""));
}

TEST_F(Program, ExportsAndComparesWhatOutputErrorGives) {
  const std::string study = (test::source_folder() / "examples/studies/output_error_flight.toml").string();
  const std::string by_output_error = (folder_ / "output_error").string(),
                    by_regression = (folder_ / "regression").string();
  Outcome run_of = run("identify " + study + " --out " + by_output_error);
  EXPECT_EQ(run_of.exit_code, 0) << run_of.text;
  EXPECT_THAT(run_of.text, HasSubstr("CL is identified by output error"));
  const auto json = nlohmann::json::parse(read_file(fs::path(by_output_error) / "estimate.json"));
  EXPECT_EQ(json.at("method"), "output error");
  const std::string subject = read_file(fs::path(by_output_error) / "subject.toml");
  for (const auto& p : json.at("parameters")) {
    if (p.at("name") == "CL_alpha") {
      EXPECT_THAT(subject, HasSubstr(fmt::format("\"alpha\" = {}", p.at("value").get<double>())));
    }
  }
  EXPECT_TRUE(fs::exists(fs::path(by_output_error) / "jsbsim.xml"));
  run_of = run("identify " + study + " --set identify.method=auto --out " + by_regression);
  EXPECT_EQ(run_of.exit_code, 0) << run_of.text;
  run_of = run("compare " + by_output_error + " " + by_regression + out());
  EXPECT_EQ(run_of.exit_code, 0) << run_of.text;
  const auto compared = nlohmann::json::parse(read_file(folder_ / "out" / "comparison.json"));
  EXPECT_EQ(compared.at("pairs").at(0).at("parameters"), 32);
  EXPECT_GT(compared.at("pairs").at(0).at("p").get<double>(), 0.05);
}

TEST_F(Program, ExportsABuiltInSubjectForOtherPrograms) {
  const std::string study = file("study.toml", "[subject]\nbuiltin = \"aerosonde\"\n");
  ASSERT_EQ(run("export " + study + out()).exit_code, 0);
  EXPECT_THAT(read_file(folder_ / "out" / "jsbsim.xml"), HasSubstr("aero/coefficient/CL_alpha"));
  EXPECT_THAT(read_file(folder_ / "out" / "model.json"), HasSubstr("\"name\": \"Cm_alpha\""));
  EXPECT_THAT(read_file(folder_ / "out" / "model.csv"), HasSubstr("CL,\"alpha\",CL_alpha,1/rad,"));
  // The exported subject is one that the program reads.
  EXPECT_EQ(run("export " + (folder_ / "out" / "subject.toml").string() + " --format csv" + out()).exit_code, 0);
  // One without a value is left to an estimate.
  ASSERT_EQ(run("export " + file("unknown.toml", "[subject]\nbuiltin = \"aerosonde\"\nmodel = { CL = [\"1\"] }\n") +
                " --format jsbsim" + out())
                .exit_code,
            0);
  EXPECT_THAT(read_file(folder_ / "out" / "jsbsim.xml"), HasSubstr("estimate: DATCOM"));
}

TEST_F(Program, FollowsALogThatIsStillBeingWritten) {
  const std::string flight = file("flight.toml",
                                  "seed = 1\n[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 80\nairspeed = 20\n"
                                  "[[flight.manoeuvre]]\nkind = \"multisine\"\nstart = 0\nduration = 80\n"
                                  "surfaces = [\"elevator\"]\n");
  ASSERT_EQ(run("simulate " + flight + " --quiet --out " + (folder_ / "sim").string()).exit_code, 0);
  const std::string log = read_file(folder_ / "sim" / "recording.csv");
  const std::string study =
      file("study.toml",
           "[subject]\nbuiltin = \"unatrap\"\n[data]\nfile = \"live.csv\"\n[reconstruct]\nsensors = \"reference\"\n"
           "turbulence = \"none\"\n[delays]\nautomatic = false\n[track]\ncoefficients = [\"CL\", \"Cm\"]\n");
  // Pieces that end in the middle of a line, the first of them before there is a whole header.
  std::thread writer([&] {
    std::size_t at = 0;
    for (const double share : {0.00005, 0.1, 0.35, 0.5, 0.9, 1.0}) {
      const auto end = static_cast<std::size_t>(share * static_cast<double>(log.size()));
      std::ofstream(folder_ / "live.csv", std::ios::app | std::ios::binary) << log.substr(at, end - at);
      at = end;
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
    }
  });
  const Outcome live = run("track " + study + " --live --interval 0.2 --idle 3 --json" + out());
  writer.join();
  ASSERT_EQ(live.exit_code, 0) << live.text;
  const auto streamed = io::read_estimate(folder_ / "out" / "estimate.json");
  ASSERT_EQ(run("track " + study + " --quiet --out " + (folder_ / "replay").string()).exit_code, 0);
  const auto replayed = io::read_estimate(folder_ / "replay" / "estimate.json");
  ASSERT_NE(streamed.find("CL_alpha"), nullptr);
  for (const char* name : {"CL_alpha", "Cm_alpha", "Cm_de"})
    EXPECT_NEAR(streamed.find(name)->value, replayed.find(name)->value, replayed.find(name)->sigma) << name;
  for (const char* name : {"track.csv", "changes.csv", "report.html", "run.json"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
}

TEST_F(Program, TracksWithAGuardedFilterThatLearnsTheModel) {
  const std::string study = (test::source_folder() / "examples/studies/iced_aircraft.toml").string();
  const Outcome tracked = run("track " + study + " --json" + out());
  ASSERT_EQ(tracked.exit_code, 0) << tracked.text;
  const auto filter = nlohmann::json::parse(tracked.text)["filter"];
  EXPECT_GT(filter["model_based_share"], 0.7);
  EXPECT_GE(filter["reverts"], 1) << "it had to notice the ice";
  EXPECT_LT(filter["rms_error"]["alpha"]["guarded"], filter["rms_error"]["alpha"]["model_free"]);
  EXPECT_THAT(read_file(in_out("models.csv")), HasSubstr("CL changed at"));
  EXPECT_THAT(read_file(in_out("filter.csv")), HasSubstr("model_based"));
  EXPECT_THAT(read_file(in_out("report.html")), HasSubstr("Models that the filter was given"));
  fs::remove_all(folder_ / "out");
  expect_refusal("track " + study + " --set track.air_data=sensors" + out(), "contradicts air_data = \"sensors\"");
  expect_refusal("track " + study + " --set reconstruct.filter=model-based" + out(), "contradicts tracking");
  expect_refusal("track " + study + " --set track.coefficients=Cm" + out(), "coefficients lists none of them");
}

TEST_F(Program, ReproducesAPublishedResult) {
  const Outcome row = run("reproduce aircraft --only 02_Cl" + out());
  EXPECT_EQ(row.exit_code, 0) << row.text;
  EXPECT_TRUE(fs::exists(folder_ / "out" / "report.html"));
  EXPECT_EQ(run("reproduce aircraft --only nothing" + out()).exit_code, 2);
}

TEST_F(Program, GivesTheSameBytesForTheSameSeed) {
  const std::string study = file("study.toml", kFlight);
  ASSERT_EQ(run("identify " + study + " --quiet --seed 3 --out " + (folder_ / "a").string()).exit_code, 0);
  ASSERT_EQ(run("identify " + study + " --quiet --seed 3 --threads 1 --out " + (folder_ / "b").string()).exit_code, 0);
  ASSERT_EQ(run("identify " + study + " --quiet --seed 4 --out " + (folder_ / "c").string()).exit_code, 0);
  EXPECT_EQ(read_file(folder_ / "a" / "estimate.json"), read_file(folder_ / "b" / "estimate.json"));
  EXPECT_NE(read_file(folder_ / "a" / "estimate.json"), read_file(folder_ / "c" / "estimate.json"));
}

TEST_F(Program, IdentifiesARecordingWrittenByItself) {
  const std::string study = file("study.toml", kFlight);
  ASSERT_EQ(run("simulate " + study + " --quiet --out " + folder_.string()).exit_code, 0);
  const std::string from_file = file("again.toml",
                                     "[subject]\nbuiltin = \"unatrap\"\n[data]\nfile = \"recording.csv\"\n"
                                     "[reconstruct]\nsensors = \"reference\"\nturbulence = \"low_light\"\n");
  const Outcome inspected = run("inspect " + (folder_ / "recording.csv").string());
  EXPECT_EQ(inspected.exit_code, 0);
  EXPECT_THAT(inspected.text, HasSubstr("gyro_x"));
  // A table of ours is what its values are printed as.
  const Outcome values = run("inspect " + (folder_ / "recording.csv").string() + " --values");
  EXPECT_EQ(values.exit_code, 0);
  EXPECT_EQ(values.text, read_file(folder_ / "recording.csv"));
  const Outcome identified = run("identify " + from_file + " --out " + (folder_ / "out").string());
  ASSERT_EQ(identified.exit_code, 0) << identified.text;
  EXPECT_THAT(identified.text, HasSubstr("Cm is identified"));
  const Outcome alone = run("identify " + from_file + " --threads 1 --out " + (folder_ / "on_one_thread").string());
  ASSERT_EQ(alone.exit_code, 0) << alone.text;
  // run.json says from what, hashed beside the analysis or after it.
  const std::string sum =
      run_in_shell("sha1sum " + (folder_ / "recording.csv").string(), "--version").text.substr(0, 40);
  int hashed = 0;
  for (const char* name : {"out", "on_one_thread"}) {
    const auto record = nlohmann::json::parse(read_file(folder_ / name / "run.json"));
    ASSERT_EQ(record["inputs"].size(), 2U);
    for (const auto& input : record["inputs"]) {
      if (input["file"].get<std::string>().ends_with("recording.csv")) {
        EXPECT_EQ(input["sha1"], sum) << name;
        ++hashed;
      }
    }
  }
  EXPECT_EQ(hashed, 2);
  // Neither that nor anything else depends on the number of threads.
  for (const char* name : {"estimate.json", "flight.csv", "coefficients.csv", "parameters.csv", "subject.toml"})
    EXPECT_EQ(read_file(folder_ / "out" / name), read_file(folder_ / "on_one_thread" / name)) << name;
}

TEST_F(Program, RefusesWhatIsNoStudyOrNoRecording) {
  expect_refusal("identify " + (folder_ / "missing.toml").string() + out(), "missing.toml: no such file");
  expect_refusal("identify " + folder_.string() + out(), "is a directory");
  expect_refusal("identify " + file("broken.toml", "a = = 1\n") + out(), "broken.toml:1:");
  expect_refusal("identify " + file("empty.toml", "") + out(), "subject: is missing");
  expect_refusal("inspect " + file("empty.bin", ""), "empty.bin: ");
  expect_refusal("inspect " + (folder_ / "missing.bin").string(), "missing.bin: no such file");
  expect_refusal("inspect " + folder_.string(), "is a directory");
  expect_refusal("inspect " + file("text.bin", "this is no log at all\n"), "text.bin:");
}

TEST_F(Program, NamesFileLineAndKeyOfAWrongStudy) {
  const auto study = [&](const std::string& text) { return "identify " + file("s.toml", text) + out(); };
  expect_refusal(study("[subject]\nbuiltin = \"unatrap\"\nmas = 2\n[flight]\nduration = 30\n"),
                 "s.toml:3: subject.mas: unknown key (did you mean 'mass'?)");
  expect_refusal(study("[subject]\nbuiltin = \"unatrap\"\nmass = 0\n[flight]\nduration = 30\n"),
                 "s.toml:3: subject.mass: = 0 must be > 0");
  expect_refusal(study("[subject]\nbuiltin = \"unatrap\"\nmass = \"2 m\"\n[flight]\nduration = 30\n"),
                 "s.toml:3: subject.mass: unit 'm' is a length [m], expected a mass [kg]");
  expect_refusal(study("[subject]\nbuiltin = \"unatrop\"\n[flight]\nduration = 30\n"), "did you mean 'unatrap'?");
  expect_refusal(study("[subject]\nbuiltin = \"unatrap\"\n"), "data: is missing");
  expect_refusal(
      study("[subject]\nbuiltin = \"unatrap\"\n[subject.model]\nCL = [\"1\", \"alhpa\"]\n[flight]\nduration = 30\n"),
      "did you mean 'alpha'?");
  expect_refusal(
      study("[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 30\n[segments]\nlongitudinal = [5, 5]\n"),
      "segment 5 s to 5 s has no length");
  expect_refusal(study("[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 30\n[identify]\nmethod = \"magic\"\n"),
                 "is not one of auto, OLS, TLS, GTLS, PCA-GTLS");
}

TEST_F(Program, NamesWhatIsWrongWithARecording) {
  const auto study = [&](const std::string& csv) {
    file("r.csv", csv);
    return "identify " + file("s.toml", "[subject]\nbuiltin = \"unatrap\"\n[data]\nfile = \"r.csv\"\n") + out();
  };
  expect_refusal(study("time[s],gyro_x[rad/s]\n0,1\n1,2\n0.5,3\n"), "r.csv:4");
  expect_refusal(study("time[s],gyro_x[furlong]\n0,1\n1,2\n"), "r.csv");
  expect_refusal(study("time[s],gyro_x[rad/s]\n0,1\n1,abc\n2,1\n"), "r.csv:3");
  expect_refusal(study("time[s],gyro_x[rad/s]\n0,1\n1,2\n"), "has no gyro_y, gyro_z");
  expect_refusal(study("time[s],gyro_x[rad/s]\n0,\n1,\n"), "r.csv");
  expect_refusal(
      "identify " +
          file("m.toml", "[subject]\nbuiltin = \"unatrap\"\n[data]\nfile = \"r.csv\"\n[data.map]\nalpha = \"vane\"\n") +
          out(),
      "m.toml:6: data.map.alpha: ");
}

TEST_F(Program, NamesTheUnitOfTimeWhereMillisecondsAreCalledSeconds) {
  std::string csv =
      "time[s],accel_x[m/s^2],accel_y[m/s^2],accel_z[m/s^2],gyro_x[rad/s],gyro_y[rad/s],gyro_z[rad/s],roll[rad],"
      "pitch[rad],yaw[rad],vel_north[m/s],vel_east[m/s],vel_down[m/s]\n";
  for (int k = 0; k < 30; ++k) csv += std::to_string(10 * k) + ",0,0,0,0,0,0,0,0,0,0,0,0\n";
  file("r.csv", csv);
  expect_refusal(
      "identify " + file("s.toml", "[subject]\nbuiltin = \"unatrap\"\n[data]\nfile = \"r.csv\"\n") + out(),
      "r.csv: its gyro has a sample every 10 s, too few to follow a flight: check the unit of time (data.time.unit)");
}

TEST_F(Program, RefusesAFlightThatNeverLeavesTheGround) {
  ASSERT_EQ(run("simulate " +
                file("f.toml",
                     "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 20\nairspeed = 20\nplan = \"none\"\n") +
                " --quiet --out " + folder_.string())
                .exit_code,
            0);
  expect_refusal(
      "identify " +
          file("g.toml",
               "[subject]\nbuiltin = \"unatrap\"\n[data]\nfile = \"recording.csv\"\n[segments]\nmin_airspeed = 60\n") +
          out(),
      "the aircraft never flies");
}

TEST_F(Program, FindsACalmFlightNotExcited) {
  const std::string study = file("calm.toml",
                                 "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 60\nairspeed = 20\nplan = "
                                 "\"none\"\nturbulence = \"none\"\n");
  const Outcome calm = run("identify " + study + " --out " + (folder_ / "out").string());
  EXPECT_EQ(calm.exit_code, 0) << calm.text;
  const estimation::Estimate estimate = io::read_estimate(folder_ / "out" / "estimate.json");
  EXPECT_THAT(estimate.verdict, HasSubstr("not excited: CL, CD, CY, Cl, Cm, Cn"));
}

// An accelerometer without gravity: by dead reckoning the aircraft would fall at 880 m/s.
TEST_F(Program, IdentifiesNothingWhereTheSensorsContradictEachOther) {
  const std::string flight = file("flight.toml", kFlight);
  ASSERT_EQ(run("simulate " + flight + " --quiet --out " + (folder_ / "sim").string()).exit_code, 0);
  const std::string study =
      file("study.toml",
           "[subject]\nbuiltin = \"unatrap\"\n[data]\nfile = \"sim/recording.csv\"\n"
           "[data.map]\naccel_z = { channel = \"accel_z\", zero = -9.80665, unit = \"m/s^2\" }\n");
  const Outcome identified = run("identify " + study + " --out " + (folder_ / "out").string());
  EXPECT_EQ(identified.exit_code, 0) << identified.text;
  EXPECT_THAT(identified.text, HasSubstr("The recording contradicts itself"));
  EXPECT_THAT(identified.text, HasSubstr("vel_down contradicts accelerometer and attitude"));
  EXPECT_THAT(identified.text, HasSubstr("CL is not identified"));
  const estimation::Estimate estimate = io::read_estimate(folder_ / "out" / "estimate.json");
  EXPECT_TRUE(estimate.parameters.empty());
  EXPECT_EQ(estimate.judgement.data.grade, estimation::Grade::kNo);
  EXPECT_TRUE(fs::exists(folder_ / "out" / "report.html"));
  const Outcome reconstructed = run("reconstruct " + study + " --out " + (folder_ / "motion").string());
  EXPECT_EQ(reconstructed.exit_code, 1) << reconstructed.text;
  EXPECT_THAT(reconstructed.text, HasSubstr("vel_down contradicts accelerometer and attitude"));
  EXPECT_THAT(read_file(folder_ / "motion" / "report.html"), HasSubstr("Contradiction"));
}

TEST_F(Program, IdentifiesTheInertiaOfASwingTest) {
  const Outcome outcome =
      run("identify " + test::source_folder().string() + "/examples/studies/swing_test/study.toml" + out());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const estimation::Estimate estimate = io::read_estimate(folder_ / "out" / "estimate.json");
  ASSERT_NE(estimate.find("Jy"), nullptr);
  EXPECT_NEAR(estimate.find("Jy")->value, 0.16, 3.0 * estimate.find("Jy")->sigma);
  EXPECT_THAT(read_file(folder_ / "out" / "subject.toml"), HasSubstr("inertia = { Jx = "));
  EXPECT_THAT(read_file(folder_ / "out" / "report.html"), HasSubstr("aircraft_x_1.csv"));
}

TEST_F(Program, CalibratesAirDataAndAppliesItToARecording) {
  const Outcome outcome =
      run("identify " + test::source_folder().string() + "/examples/studies/calibration/study.toml" + out());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text;
  const estimation::Estimate estimate = io::read_estimate(folder_ / "out" / "estimate.json");
  ASSERT_NE(estimate.find("alpha.scale"), nullptr);
  EXPECT_NEAR(estimate.find("alpha.scale")->value, 1.12, 3.0 * estimate.find("alpha.scale")->sigma);
  EXPECT_TRUE(fs::exists(folder_ / "out" / "residuals.csv"));

  const std::string flight = file("flight.toml", kFlight);
  ASSERT_EQ(run("simulate " + flight + " --quiet --out " + (folder_ / "sim").string()).exit_code, 0);
  file("calibration.toml", "[alpha]\nscale = 1.0\nbias = \"2 deg\"\n");
  const std::string study = file("study.toml",
                                 "[subject]\nbuiltin = \"unatrap\"\n[data]\nfile = \"sim/recording.csv\"\n"
                                 "calibration = \"calibration.toml\"\n[reconstruct]\nsensors = \"reference\"\n"
                                 "turbulence = \"low_light\"\n");
  const auto mean_alpha = [&](const std::string& set) {
    const Outcome done = run("reconstruct " + study + set + out());
    EXPECT_EQ(done.exit_code, 0) << done.text;
    const Recording result = io::to_recording(io::read_csv_file(folder_ / "out" / "flight.csv"));
    double sum = 0.0;
    for (const double a : result.at("alpha").value) sum += a / static_cast<double>(result.at("alpha").size());
    return sum;
  };
  const double corrected = mean_alpha("");
  EXPECT_THAT(read_file(folder_ / "out" / "run.json"), HasSubstr("calibration.toml"));
  file("calibration.toml", "[alpha]\nscale = 1.0\nbias = 0\n");
  // The filter trusts the vane's mean.
  EXPECT_NEAR(mean_alpha("") - corrected, 2.0 * M_PI / 180.0, 0.1 * M_PI / 180.0);
  file("calibration.toml", "[alpa]\nscale = 1.0\nbias = 0\n");
  fs::remove_all(folder_ / "out");
  expect_refusal("reconstruct " + study + out(), "did you mean 'alpha'");
}

TEST_F(Program, WritesStudiesOfGroundTestsThatItUnderstands) {
  for (const std::string kind : {"swing-test", "calibration"}) {
    const fs::path folder = folder_ / kind;
    ASSERT_EQ(run("init " + kind + " --quiet --out " + folder.string()).exit_code, 0);
    std::string text = read_file(folder / "study.toml");
    if (kind == "swing-test") {
      expect_refusal("identify " + (folder / "study.toml").string() + out(), "is still the template's placeholder");
      for (std::size_t at = 0; (at = text.find("\"? ", at)) != std::string::npos;) text.replace(at, 2, "\"1");
    }
    // All its keys are known: what is missing are the recordings.
    expect_refusal("identify " + file("filled.toml", text) + out(), ".csv: ");
  }
}

// The README's first command: every part of it, with the options that the parts' own commands have and it has not.
TEST_F(Program, DemoRunsAllOfItsParts) {
  const Outcome done = run("demo --set flight.duration=120" + out());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  for (const char* part : {"aircraft", "vehicle", "vehicle/scale", "muscle", "cueing"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / part / "report.html")) << part;
}

}  // namespace
}  // namespace veridyn
