// Misspelt keys in tables that the command itself does not use.
#include "tests/apps/program.hpp"

namespace veridyn {
namespace {

using StudyTables = ProgramTest;

TEST_F(StudyTables, OfAFlightAreCheckedByCommandsThatDoNotUseThem) {
  const std::string flight =
      "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 5\nairspeed = 20\nplan = \"none\"\n";
  const std::pair<const char*, const char*> wrong[] = {
      {"delays", "automatc"}, {"reconstruct", "turbulense"}, {"signals", "pass_bnd"}, {"segments", "holdot"},
      {"identify", "metod"},  {"validate", "perod"},         {"track", "memry"},      {"uncertainty", "drws"}};
  for (const std::string command : {"simulate ", "export "}) {
    for (const auto& [table, key] : wrong) {
      const std::string text = flight + "[" + table + "]\n" + key + " = 1\n";
      expect_refusal(command + file("s.toml", text) + out(),
                     std::string("s.toml:8: ") + table + "." + key + ": unknown key (did you mean '");
    }
    EXPECT_EQ(run(command + file("s.toml", flight + "[reconstruct]\nturbulence = \"none\"\n") + out()).exit_code, 0);
  }
}

TEST_F(StudyTables, OfARecordingAreCheckedByCommandsThatDoNotOpenIt) {
  const std::string flight =
      "[subject]\nbuiltin = \"unatrap\"\n[flight]\nduration = 5\nairspeed = 20\nplan = \"none\"\n[data]\n";
  const std::string drive =
      "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"bicycle\"\n"
      "manoeuvre = \"step steer\"\namplitude = 0.02\nduration = 2\n[scale]\nlength_ratio = 0.2\n[data]\n";
  const std::pair<std::string, std::string> commands[] = {
      {"simulate ", flight}, {"export ", flight}, {"simulate ", drive}, {"scale ", drive}};
  for (const auto& pair : commands) {
    const std::string &command = pair.first, &study = pair.second;
    const auto refused = [&](const std::string& data, const std::string& message) {
      expect_refusal(command + file("s.toml", study + data) + out(), message);
    };
    refused("fil = \"later.csv\"\n", "data.fil: unknown key (did you mean 'file'?)");
    refused("file = \"later.csv\"\nform = 3\n", "data.form: unknown key (did you mean 'from'?)");
    refused("file = \"later.csv\"\n[data.map]\nrol = \"r\"\n", "data.map.rol: is not a standard channel");
    // The recording itself need not be there.
    EXPECT_EQ(run(command + file("s.toml", study + "file = \"later.csv\"\nfrom = 3\n") + out()).exit_code, 0);
    std::filesystem::remove_all(folder_ / "out");
  }
}

TEST_F(StudyTables, OfASimulatedDriveAreCheckedWhereThereIsARecording) {
  std::string log = "time[s],steer[rad],speed[m/s],yaw_rate[rad/s],accel_y[m/s^2]\n";
  for (int k = 0; k < 1000; ++k) log += std::to_string(0.01 * k) + ",0,20,0,0\n";
  file("log.csv", log);
  const std::string study =
      "[subject]\nkind = \"vehicle\"\nmass = 1000\na = 1.2\nb = 1.3\nC_f = 5e4\nC_r = 5e4\nI_z = 1500\n"
      "[data]\nfile = \"log.csv\"\n";
  const std::string drive =
      "[drive]\nmodel = \"bicycle\"\nmanoeuvre = \"step steer\"\namplitude = 0.02\nspeed = 20\nduration = 2\n";
  const auto refused = [&](const std::string& text, const std::string& message) {
    expect_refusal("identify " + file("s.toml", study + text) + out(), message);
  };
  refused(drive + "stp = 0.01\n", "drive.stp: unknown key (did you mean 'step'?)");
  refused(drive + "[sensors]\nst = \"reference\"\n", "sensors.st: unknown key");
  refused(drive + "[scale]\nlength_ratio = 0.2\nmas = 8\n", "scale.mas: unknown key (did you mean 'mass'?)");
  refused("frme = \"flu\"\n", "data.frme: unknown key (did you mean 'frame'?)");
  const auto works = [&](const std::string& text) {
    const Outcome identified = run("identify " + file("s.toml", study + text) + out());
    EXPECT_EQ(identified.exit_code, 0) << identified.text;
  };
  works(drive + "[sensors]\nset = \"reference\"\n[scale]\nlength_ratio = 0.2\n");
  // Identifying a vehicle takes fewer parameters than driving it on four wheels.
  works("[drive]\nmanoeuvre = \"step steer\"\namplitude = 0.02\nspeed = 20\n[scale]\nlength_ratio = 0.2\n");
}

TEST_F(StudyTables, SayTheNewNameOfAKey) {
  const Outcome exported =
      run("export " + file("s.toml", "[subject]\nbuiltin = \"unatrap\"\n[track]\nestimate = \"e.json\"\n") +
          " --format csv --out " + (folder_ / "out").string());
  EXPECT_EQ(exported.exit_code, 0);
  EXPECT_THAT(exported.text, testing::HasSubstr("note: "));
  EXPECT_THAT(exported.text, testing::HasSubstr("track.estimate: this key is now called 'estimate_file'\n"));
}

TEST_F(StudyTables, OfADriveAreCheckedByCommandsThatDoNotUseThem) {
  const std::string drive =
      "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"bicycle\"\n"
      "manoeuvre = \"step steer\"\namplitude = 0.02\nduration = 2\n";
  const std::pair<const char*, const char*> wrong[] = {
      {"segments", "holdot"}, {"identify", "metod"}, {"validate", "segmnts"}, {"track", "memry"}};
  for (const auto& [table, key] : wrong) {
    const std::string text = drive + "[" + table + "]\n" + key + " = 1\n";
    expect_refusal("simulate " + file("s.toml", text) + out(),
                   std::string("s.toml:10: ") + table + "." + key + ": unknown key");
    expect_refusal("scale " + file("s.toml", text + "[scale]\nlength_ratio = 0.2\n") + out(),
                   std::string(table) + "." + key + ": unknown key");
  }
  expect_refusal("simulate " + file("s.toml", drive + "[scale]\nlength_ratio = 0.2\nmas = 8\n") + out(),
                 "scale.mas: unknown key (did you mean 'mass'?)");
}

}  // namespace
}  // namespace veridyn
