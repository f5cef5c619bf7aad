// The program on studies of vehicles.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/io/tables/csv.hpp"

namespace veridyn {
namespace {

using testing::HasSubstr;

class VehicleProgram : public ProgramTest {
 protected:
  [[nodiscard]] static std::string study(const std::string& name) {
    return test::source_folder().string() + "/examples/studies/vehicle/" + name + ".toml";
  }

  /// A drive log of 30 s at 100 Hz, `row(t)` giving steer, speed, yaw_rate, accel_y; and a study of it.
  template <typename Row>
  std::string logged(const std::string& name, const Row& row) const {
    std::string csv = "time[s],steer[rad],speed[m/s],yaw_rate[rad/s],accel_y[m/s^2]\n";
    for (int k = 0; k < 3000; ++k) {
      const double t = 0.01 * k;
      const std::array<double, 4> v = row(t);
      csv += std::to_string(t);
      for (const double x : v) csv += "," + (std::isfinite(x) ? std::to_string(x) : std::string("nan"));
      csv += "\n";
    }
    file(name + ".csv", csv);
    return file(name + ".toml",
                "[subject]\nkind = \"vehicle\"\nmass = 1000\na = 1.2\nb = 1.3\n[data]\nfile = \"" + name + ".csv\"\n");
  }
};

TEST_F(VehicleProgram, DrivesScalesAndIdentifiesItsOwnTemplate) {
  ASSERT_EQ(run("init vehicle --quiet --out " + folder_.string()).exit_code, 0);
  const std::string own = (folder_ / "study.toml").string();
  const Outcome driven = run("simulate " + own + " --json" + out());
  ASSERT_EQ(driven.exit_code, 0) << driven.text;
  for (const char* name : {"motion.csv", "recording.csv", "metrics.csv", "subject.toml", "report.html", "run.json"})
    EXPECT_TRUE(std::filesystem::exists(in_out(name))) << name;
  const auto summary = nlohmann::json::parse(driven.text);
  EXPECT_EQ(summary["completed"], true);
  EXPECT_EQ(summary["manoeuvre"], "step steer");
  const Recording motion = io::to_recording(io::read_csv_file(in_out("motion.csv")));
  EXPECT_TRUE(motion.has("normal_force_fl"));
  EXPECT_EQ(run("inspect " + in_out("recording.csv").string()).exit_code, 0);
  EXPECT_EQ(run("scale " + own + out()).exit_code, 0);
  for (const char* name : {"groups.csv", "scaled.toml", "prototype.csv", "model.csv"})
    EXPECT_TRUE(std::filesystem::exists(in_out(name))) << name;
  EXPECT_EQ(
      run("identify " + own + " --set drive.manoeuvre=sweep --set drive.length=20 --set drive.duration=24" + out())
          .exit_code,
      0);
  EXPECT_TRUE(std::filesystem::exists(in_out("estimate.json")));
  const std::string methods = read_file(in_out("methods.csv"));
  EXPECT_THAT(methods, testing::StartsWith("parameter,method,value,sigma,low95,high95,unit\nC_f,"));
  EXPECT_THAT(methods.substr(0, methods.find("\nC_r")), testing::EndsWith(",N/rad"));
}

TEST_F(VehicleProgram, WantsTheMassOfTheCarWhoseLogItReads) {
  ASSERT_EQ(run("init vehicle --log drive.csv --quiet --out " + folder_.string()).exit_code, 0);
  expect_refusal("identify " + (folder_ / "study.toml").string() + out(),
                 "subject.mass: is still the template's placeholder, as are subject.");
}

TEST_F(VehicleProgram, WritesAVehicleThatItReadsAgain) {
  ASSERT_EQ(run("simulate " + study("step_steer") + out()).exit_code, 0);
  const std::string written = read_file(in_out("subject.toml"));
  const std::string again = file("again.toml", written +
                                                   "\n[drive]\nmanoeuvre = \"step steer\"\nspeed = \"100 km/h\"\n"
                                                   "amplitude = \"2 deg\"\nduration = 6\n");
  const std::string first = read_file(in_out("motion.csv"));
  ASSERT_EQ(run("simulate " + again + out()).exit_code, 0);
  EXPECT_EQ(read_file(in_out("motion.csv")), first);
}

TEST_F(VehicleProgram, ScaleFindsWhatThePublishedModelGetsWrong) {
  const Outcome scaled = run("scale " + study("scale") + " --json" + out());
  ASSERT_EQ(scaled.exit_code, 0) << scaled.text;
  const auto summary = nlohmann::json::parse(scaled.text);
  for (const auto& group : summary["groups"]) {
    const double mismatch = group["mismatch_percent"];
    const std::string name = group["quantity"];
    if (name == "C_f" || name == "C_r") {
      EXPECT_NEAR(mismatch, 4.2, 0.05) << name;
    } else if (name == "I_x") {
      EXPECT_NEAR(mismatch, -0.4, 0.05);
    } else {
      EXPECT_LT(std::abs(mismatch), 0.1) << name;
    }
  }
  EXPECT_NEAR(summary["gravity"]["mismatch_percent"], 400.0, 1e-6);
}

TEST_F(VehicleProgram, SameSeedSameResultWhateverTheThreads) {
  const std::string drive = study("identify_sweep") + " --set drive.length=20 --set drive.duration=25";
  ASSERT_EQ(run("identify " + drive + " --threads 1" + out()).exit_code, 0);
  const std::string one = read_file(in_out("estimate.json")), recorded = read_file(in_out("recording.csv"));
  ASSERT_EQ(run("identify " + drive + " --threads 2" + out()).exit_code, 0);
  EXPECT_EQ(read_file(in_out("estimate.json")), one);
  ASSERT_EQ(run("identify " + drive + " --seed 8" + out()).exit_code, 0);
  EXPECT_NE(read_file(in_out("recording.csv")), recorded);
}

TEST_F(VehicleProgram, TrackingSeesTheGripDrop) {
  const Outcome tracked = run("track " + study("grip_drop") + " --json" + out());
  ASSERT_EQ(tracked.exit_code, 0) << tracked.text;
  const auto changes = nlohmann::json::parse(tracked.text)["changes"];
  ASSERT_FALSE(changes.empty());
  // Rows are about the middle of a filter of half a second: the first that the change reaches is a quarter earlier.
  EXPECT_GT(changes[0]["detected_s"], 59.7);
  EXPECT_LT(changes[0]["detected_s"], 65.0);
}

TEST_F(VehicleProgram, RollOfTheBodyIsNotTakenForTheTyres) {
  const Outcome identified = run("identify " + study("step_steer") +
                                 " --set drive.manoeuvre=\"random steer\" --set drive.amplitude=0.035 --set "
                                 "drive.duration=60 --json" +
                                 out());
  ASSERT_EQ(identified.exit_code, 0) << identified.text;
  EXPECT_EQ(nlohmann::json::parse(identified.text)["verdict"], "identified");
  const auto estimate = nlohmann::json::parse(read_file(in_out("estimate.json")));
  EXPECT_EQ(estimate["structure"], "roll, relaxation and saturation");
  // Of the study, whose tyres saturate; the bicycle alone gives 24 to 28 % less.
  const std::map<std::string, double> truth{{"C_f", 58000.0}, {"C_r", 65000.0}, {"I_z", 2350.0}};
  std::size_t found = 0;
  for (const auto& p : estimate["parameters"]) {
    const auto known = truth.find(p["name"]);
    if (known == truth.end()) continue;
    EXPECT_NEAR(p["value"].get<double>() / known->second, 1.0, 0.15) << known->first;
    ++found;
  }
  EXPECT_EQ(found, truth.size());
}

TEST_F(VehicleProgram, ExportsIdentifiedTyresAsFilesThatItDrivesOn) {
  const std::string friction = study("profile_friction");
  ASSERT_EQ(run("identify " + friction + " --set identify.profiles=false --quiet" + out()).exit_code, 0);
  const std::string estimate = (folder_ / "kept.json").string();
  std::filesystem::copy_file(in_out("estimate.json"), estimate);
  EXPECT_THAT(read_file(in_out("subject.toml")), HasSubstr("tyre = \"magic formula\"\n[subject.tyres]\nC = "));
  const Outcome exported = run("export " + friction + " --estimate-file " + estimate + out());
  ASSERT_EQ(exported.exit_code, 0) << exported.text;
  for (const char* name : {"subject.toml", "model.csv", "tyre_front.tir", "tyre_rear.tir"})
    EXPECT_TRUE(std::filesystem::exists(in_out(name))) << name;
  const std::string tyre = read_file(in_out("tyre_front.tir"));
  EXPECT_THAT(tyre, HasSubstr("$   C_f = "));
  EXPECT_THAT(tyre, HasSubstr("PCY1"));
  for (const char* axle : {"front", "rear"})
    std::filesystem::copy_file(in_out(std::string("tyre_") + axle + ".tir"), folder_ / (std::string(axle) + ".tir"));
  const std::string tyres = " --set 'subject.tyres.front=\"" + (folder_ / "front.tir").string() +
                            "\"' --set 'subject.tyres.rear=\"" + (folder_ / "rear.tir").string() + "\"'";
  const Outcome driven = run("simulate " + friction + tyres + out());
  EXPECT_EQ(driven.exit_code, 0) << driven.text;
}

TEST_F(VehicleProgram, RefusesToExportWhatAVehicleDoesNotHave) {
  const Outcome linear = run("export " + study("rolling_car") + " --format tir" + out());
  EXPECT_EQ(linear.exit_code, 2);
  EXPECT_THAT(linear.text, HasSubstr("has linear tyres, of which there is no .tir"));
  const Outcome jsbsim = run("export " + study("rolling_car") + " --format jsbsim" + out());
  EXPECT_EQ(jsbsim.exit_code, 2);
  EXPECT_THAT(jsbsim.text, HasSubstr("a vehicle has toml, csv and tir"));
  EXPECT_FALSE(std::filesystem::exists(in_out("subject.toml")));
  const std::string other = file("other.json", R"({"subject": "x", "method": "OLS", "parameters": []})");
  EXPECT_EQ(run("export " + study("rolling_car") + " --estimate-file " + other + out()).exit_code, 2);
}

TEST_F(VehicleProgram, SaysWhichStructureItTookAndWhatTheOthersMakeOfTheDrive) {
  const std::string spoken = " --out " + (folder_ / "out").string();
  const Outcome identified = run("identify " + study("rolling_car") + spoken);
  ASSERT_EQ(identified.exit_code, 0) << identified.text;
  EXPECT_THAT(identified.text, HasSubstr("structure: roll and relaxation, which makes the drive likelier"));
  const auto estimate = nlohmann::json::parse(read_file(in_out("estimate.json")));
  EXPECT_EQ(estimate["structure"], "roll and relaxation");
  const auto& tried = estimate["tried_structures"];
  ASSERT_GE(tried.size(), 4U);
  EXPECT_EQ(tried[0]["name"], "bicycle");
  EXPECT_EQ(tried[0]["taken"], false);
  EXPECT_EQ(tried[3]["name"], "roll and relaxation");
  EXPECT_EQ(tried[3]["taken"], true);
  EXPECT_GT(tried[3]["log_likelihood_gain"], tried[3]["needed_gain"]);
  EXPECT_EQ(tried[3]["parameters"][2]["name"], "I_z");
  const double sigma = tried[3]["parameters"][2]["sigma"];
  EXPECT_NEAR(tried[3]["parameters"][2]["value"], 2350.0, 2.0 * sigma);
  EXPECT_LT(sigma, 450.0) << "of this short drive";
  const std::string kept = (folder_ / "kept.json").string();
  std::filesystem::copy_file(in_out("estimate.json"), kept);
  const Outcome validated =
      run("validate " + study("rolling_car") + " --seed 9 --set drive.length=20 --estimate-file " + kept + spoken);
  ASSERT_EQ(validated.exit_code, 0) << validated.text;
  EXPECT_THAT(validated.text, HasSubstr("structure: roll and relaxation, as the estimate has it"));
  const Outcome fixed =
      run("identify " + study("rolling_car") + " --set identify.structure=bicycle --set drive.length=20" + spoken);
  ASSERT_EQ(fixed.exit_code, 0) << fixed.text;
  EXPECT_THAT(fixed.text, HasSubstr("structure: bicycle, as the study says"));
}

// A drive that takes seconds, stopped while the third structure is fitted: the first two are there.
TEST_F(VehicleProgram, AnInterruptedSearchLeavesTheBestSoFarAndSaysSo) {
  const std::string arguments =
      "identify " + study("rolling_car") + " --set drive.length=200 --out " + in_out("").string();
  const Outcome stopped = run_interrupted_after("structure: roll", 1, arguments, folder_);
  EXPECT_EQ(stopped.exit_code, 1) << stopped.text;
  EXPECT_THAT(stopped.text, HasSubstr("\nInterrupted: this is the best estimate found by then. "));
  EXPECT_THAT(stopped.text, HasSubstr("the parameters must not be taken for physical constants"));
  for (const char* name : {"estimate.json", "report.html", "subject.toml", "parameters.csv", "run.json"})
    EXPECT_TRUE(std::filesystem::exists(in_out(name))) << name;
  const auto estimate = nlohmann::json::parse(read_file(in_out("estimate.json")));
  EXPECT_EQ(estimate["interrupted"], true);
  EXPECT_EQ(estimate["grades"]["parameters"]["grade"], "no");
  EXPECT_EQ(estimate["evidence"][0]["check"], "interruption");
  EXPECT_GT(estimate["parameters"][0]["value"], 0.0);
  EXPECT_THAT(read_file(in_out("report.html")), HasSubstr("Interrupted: this is the best estimate found by then. "));
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out"))
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
}

TEST_F(VehicleProgram, ASecondInterruptionEndsAtOnceAndLeavesNoResults) {
  // Ten minutes of drive, of which the prediction alone takes longer than the second Ctrl-C is away.
  const std::string arguments =
      "identify " + study("rolling_car") + " --set drive.length=600 --out " + in_out("").string();
  const Outcome stopped = run_interrupted_after("structure: roll", 2, arguments, folder_);
  EXPECT_EQ(stopped.exit_code, 130) << stopped.text;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out"))
    EXPECT_TRUE(entry.path().filename().string().starts_with(".veridyn-")) << entry.path();
}

TEST_F(VehicleProgram, AnotherDriveValidatesAnEstimate) {
  ASSERT_EQ(run("identify " + study("identify_sweep") + out()).exit_code, 0);
  const std::string estimate = file("estimate.json", read_file(in_out("estimate.json")));
  const Outcome validated =
      run("validate " + study("identify_sweep") + " --seed 99 --json --estimate-file " + estimate + out());
  ASSERT_EQ(validated.exit_code, 0) << validated.text;
  EXPECT_EQ(nlohmann::json::parse(validated.text)["verdict"], "identified");
  // The same values, rejected where they were identified; the inertia was not excited there.
  auto rejected = nlohmann::json::parse(read_file(estimate));
  for (auto& p : rejected["parameters"]) p["status"] = p["name"] == "I_z" ? "not_excited" : "rejected";
  const Outcome refused = run("validate " + study("identify_sweep") + " --seed 99 --json --estimate-file " +
                              file("rejected.json", rejected.dump()) + out());
  const auto summary = nlohmann::json::parse(refused.text);
  EXPECT_EQ(summary["verdict"], "rejected");
  EXPECT_EQ(summary["estimate"]["grades"]["prediction"]["grade"], "no") << summary["estimate"]["grades"];
}

TEST_F(VehicleProgram, RefusesWhatNoVehicleCanBeOrDo) {
  const auto refused = [&](const std::string& set, const std::string& message) {
    expect_refusal("simulate " + study("step_steer") + " --set " + set + out(), message);
  };
  refused("drive.speed=0", "drive.speed: = 0 must be > 0");
  refused("drive.speed=nan", "drive.speed: is nan");
  refused("'drive.speed=\"20 kg\"'", "unit 'kg' is a mass");
  refused("subject.track=0", "track_f is 0 m; must be > 0");
  refused("subject.C_f=-100", "C_f is -100 N/rad; must be > 0");
  refused("'drive.amplitude=\"95 deg\"'", "must be between -90 and 90 deg");
  refused("drive.manoeuvre=stepsteer", "did you mean 'step steer'");
  refused("drive.step=0.05 --set drive.output_step=0.05", "step");
  refused("drive.amplitud=1", "did you mean 'amplitude'");
  refused("subject.tyre=missing.tir", "missing.tir: no such file");
  refused("subject.unsprung_mass=500", "four must be lighter");
  expect_refusal("simulate " + study("rough_road") + " --set road.class=Z" + out(), "is not one of A, B");
  expect_refusal("simulate " + study("rough_road") + " --set drive.model=bicycle" + out(),
                 "needs model = \"four-wheel\"");
  expect_refusal("scale " + study("scale") + " --set scale.length_ratio=-1" + out(), "must be > 0");
  expect_refusal("scale " + study("scale") + " --set 'scale.repeating=[\"m\",\"L\",\"a\"]'" + out(), "not independent");
}

TEST_F(VehicleProgram, RefusesLogsThatHoldNoDrive) {
  const double nan = std::nan("");
  using Row = std::array<double, 4>;
  const auto refused = [&](const std::string& name, const auto& row, const std::string& message) {
    expect_refusal("identify " + logged(name, row) + out(), message);
  };
  refused(
      "standing",
      [](double t) {
        return Row{0.01 * std::sin(t), 0.0, 0.0, 0.0};
      },
      "the vehicle never drives");
  refused(
      "nothing",
      [&](double) {
        return Row{0.0, 20.0, nan, 0.0};
      },
      "yaw_rate holds no numeric values");
  refused(
      "degrees",
      [](double t) {
        return Row{2.0 * std::sin(t), 20.0, 0.1 * std::sin(t), 2.0 * std::sin(t)};
      },
      "is it the hand wheel's angle, or in degrees?");
  expect_refusal("identify " + file("bare.toml", "[subject]\nkind = \"vehicle\"\n") + out(), "data: is missing");
  file("empty.csv", "time[s],steer[rad],speed[m/s],yaw_rate[rad/s],accel_y[m/s^2]\n");
  expect_refusal(
      "identify " +
          file("empty.toml", "[subject]\nkind = \"vehicle\"\nmass = 1\na = 1\nb = 1\n[data]\nfile = \"empty.csv\"\n") +
          out(),
      "not one row of data");
}

TEST_F(VehicleProgram, NamesAYawRateOfTheWrongSign) {
  const std::string mirrored = logged("mirrored", [](double t) {
    const double turn = std::sin(t) + 0.6 * std::sin(2.3 * t) + 0.3 * std::sin(0.37 * t);
    return std::array<double, 4>{0.02 * turn, 20.0, -0.1 * turn, 2.0 * turn};
  });
  const Outcome identified = run("identify " + mirrored + " --out " + in_out("").string());
  EXPECT_THAT(identified.text, HasSubstr("The recording contradicts itself"));
  EXPECT_THAT(identified.text, HasSubstr("the sign of yaw_rate is reversed"));
  EXPECT_THAT(run("inspect " + mirrored).text, HasSubstr("yaw_rate has the wrong sign"));
}

TEST_F(VehicleProgram, StraightDrivingIsNoErrorAndIdentifiesNothing) {
  const std::string straight = logged("straight", [](double) { return std::array<double, 4>{0.0, 20.0, 0.0, 0.0}; });
  const Outcome identified = run("identify " + straight + " --json" + out());
  ASSERT_EQ(identified.exit_code, 0) << identified.text;
  EXPECT_NE(nlohmann::json::parse(identified.text)["verdict"], "identified");
}

TEST_F(VehicleProgram, InspectSaysWhichUnitIsWrongAndItsLineMendsIt) {
  // Speed in km/h under the name of m/s.
  const std::string study = logged("kmh", [](double t) {
    const double speed = 15.0 + 3.0 * std::sin(0.8 * t), rate = 0.2 * std::sin(0.5 * t);
    return std::array<double, 4>{2.7 * rate / speed, 3.6 * speed, rate, speed * rate};
  });
  const Outcome wrong = run("inspect " + (folder_ / "kmh.csv").string());
  ASSERT_EQ(wrong.exit_code, 0) << wrong.text;
  EXPECT_THAT(wrong.text, HasSubstr("speed is in km/h, not m/s"));
  const std::string line = "speed = { channel = \"speed\", scale = 0.277778 }";
  EXPECT_THAT(wrong.text, HasSubstr("correct it in [data.map]: " + line));
  EXPECT_THAT(run("inspect " + study).text, HasSubstr("speed is in km/h"));
  const Outcome corrected =
      run("inspect " + file("corrected.toml", "[data]\nfile = \"kmh.csv\"\n[data.map]\n" + line + "\n"));
  ASSERT_EQ(corrected.exit_code, 0) << corrected.text;
  EXPECT_THAT(corrected.text, HasSubstr("nothing contradicts"));
  EXPECT_EQ(nlohmann::json::parse(run("inspect " + study + " --json").text)["signs_and_units"]["faults"].size(), 1U);
  expect_refusal("inspect " + file("misspelt.toml", "[data]\nfile = \"kmh.csv\"\nfrm = 2\n"),
                 "misspelt.toml:3: data.frm: unknown key");
  expect_refusal("inspect " + file("none.toml", "title = \"nothing\"\n"), "data: is missing");
}

// An angle that reads twice is the wheelbase of a longer car where the study does not say it.
TEST_F(VehicleProgram, InspectOfAStudyKnowsTheWheelbase) {
  const std::string study = logged("twice", [](double t) {
    const double speed = 15.0 + 4.0 * std::sin(0.8 * t), rate = 0.1 * std::sin(0.5 * t) + 0.05 * std::sin(1.3 * t);
    return std::array<double, 4>{2.0 * 2.5 * rate / speed, speed, rate, speed * rate};
  });
  const std::string text = run("inspect " + study).text;
  EXPECT_THAT(text, ::testing::ContainsRegex("wrong: steer reads (1.9|2|2.0|2.1)[0-9]* times the truth"));
  EXPECT_THAT(text, HasSubstr("correct it in [data.map]: steer = { channel = \"steer\", scale = "));
  EXPECT_THAT(run("inspect " + (folder_ / "twice.csv").string()).text, HasSubstr("nothing contradicts"));
}

}  // namespace
}  // namespace veridyn
