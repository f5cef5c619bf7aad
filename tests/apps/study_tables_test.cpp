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
