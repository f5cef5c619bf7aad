#include "veridyn/core/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Study study(std::string_view text, std::vector<std::string> overrides = {}) {
  return Study::parse(text, "study.toml", "/data", overrides);
}

TEST(Study, ReadsNumbersInSiOrWithAnyUnitOfTheDimension) {
  const StudyTable subject =
      study("[subject]\nmass = 2\nspan = \"10 ft\"\nalpha0 = \"27 deg\"\n").root().table("subject");
  EXPECT_DOUBLE_EQ(subject.number("mass", "kg"), 2.0);
  EXPECT_DOUBLE_EQ(subject.number("span", "m"), 3.048);
  EXPECT_DOUBLE_EQ(subject.number("alpha0", "rad"), 27.0 * std::numbers::pi / 180.0);
  EXPECT_DOUBLE_EQ(subject.number_or("chord", "m", 0.3), 0.3);
}

TEST(Study, NamesFileLineAndKeyOfAWrongValue) {
  const StudyTable root =
      study("a = 1\n\n[subject]\nmass = 0\nspan = \"2 kg\"\nname = 5\nchord = \"wide\"\nbad = nan\n").root();
  const StudyTable subject = root.table("subject");
  EXPECT_EQ(why([&] { static_cast<void>(subject.positive("mass", "kg")); }),
            "study.toml:4: subject.mass: = 0 must be > 0");
  EXPECT_EQ(why([&] { static_cast<void>(subject.number("span", "m")); }),
            "study.toml:5: subject.span: unit 'kg' is a mass [kg], expected a length [m]");
  EXPECT_EQ(why([&] { static_cast<void>(subject.text("name")); }),
            "study.toml:6: subject.name: is a whole number, expected a text in quotes");
  EXPECT_EQ(why([&] { static_cast<void>(subject.number("chord", "m")); }),
            "study.toml:7: subject.chord: 'wide' is not a number with a unit, such as \"1.5 m\"");
  EXPECT_EQ(why([&] { static_cast<void>(subject.number("bad", "m")); }),
            "study.toml:8: subject.bad: is nan, expected a finite number [m]");
  EXPECT_EQ(why([&] { static_cast<void>(subject.number("area", "m^2")); }), "study.toml:3: subject.area: is missing");
}

TEST(Study, RefusesThePlaceholderOfATemplate) {
  const StudyTable root = study("mass = \"? kg\"\n").root();
  EXPECT_EQ(why([&] { static_cast<void>(root.positive("mass", "kg")); }),
            "study.toml:1: mass: is still the template's placeholder: put in your own number [kg]");
}

TEST(Study, ListsAllPlaceholdersThatAreLeft) {
  const StudyTable root =
      study(
          "title = \"what?\"\n[subject]\nspan = \"? m\"\nmass = \"? kg\"\n"
          "inertia = { Jx = 1, Jy = \"? kg m^2\" }\n[data.map]\np = { channel = \"P\", unit = \"?\" }\n")
          .root();
  EXPECT_EQ(why([&] { static_cast<void>(root.table("subject").number("mass", "kg")); }),
            "study.toml:4: subject.mass: is still the template's placeholder, as are subject.span (line 3), "
            "subject.inertia.Jy (line 5), data.map.p.unit (line 7): put in your own values");
  EXPECT_EQ(why([&] { static_cast<void>(root.table("data").table("map").table("p").text("unit")); }).substr(0, 67),
            "study.toml:7: data.map.p.unit: is still the template's placeholder,");
  EXPECT_EQ(why([] { static_cast<void>(study("a = \"?\"\n").root().text("a")); }),
            "study.toml:1: a: is still the template's placeholder: put in your own value");
}

TEST(Study, RefusesUnknownKeysAndSuggestsTheNearest) {
  const Study misspelt = study("[subject]\nmass = 2\nspann = 3\n");
  const StudyTable subject = misspelt.root().table("subject");
  static_cast<void>(subject.number("mass", "kg"));
  static_cast<void>(subject.number_or("span", "m", 1.0));
  EXPECT_EQ(why([&] { misspelt.root().finish(); }), "study.toml:3: subject.spann: unknown key (did you mean 'span'?)");
}

TEST(Study, RefusesATableThatWasNotOpened) {
  const Study unread = study("[data]\nfil = \"log.bin\"\n[[change]]\ntime = 3\n");
  EXPECT_TRUE(unread.root().has("data"));
  EXPECT_TRUE(unread.root().has("change"));
  EXPECT_EQ(why([&] { unread.root().finish(); }), "study.toml:3: change: is a table that nothing reads here");
  for (const StudyTable& change : unread.root().tables("change")) static_cast<void>(change.number("time", "s"));
  EXPECT_EQ(why([&] { unread.root().finish(); }), "study.toml:1: data: is a table that nothing reads here");
  static_cast<void>(unread.root().table("data").text_or("file", ""));
  EXPECT_EQ(why([&] { unread.root().finish(); }), "study.toml:2: data.fil: unknown key (did you mean 'file'?)");
}

TEST(Study, TakesAnEmptyTableAndOneThatIsAccepted) {
  const Study empty = study("[data]\n[drive]\nstep = 1\nspeed = 3\n");
  EXPECT_TRUE(empty.root().has("data"));
  EXPECT_TRUE(empty.root().table("drive").has("step"));  // what was begun need not be finished
  empty.root().accept("drive");
  EXPECT_NO_THROW(empty.root().finish());
}

TEST(Study, TakesTheOldNameOfAKeyWithANote) {
  const Study old = study("[track]\nestimate = \"e.json\"\n");
  const StudyTable track = old.root().table("track");
  for (int reading = 0; reading < 2; ++reading)
    EXPECT_EQ(track.text(track.renamed("estimate_file", "estimate")), "e.json");
  EXPECT_NO_THROW(old.root().finish());
  EXPECT_THAT(old.notes(), ElementsAre("study.toml:2: track.estimate: this key is now called 'estimate_file'"));

  const Study both = study("[track]\nestimate = \"e.json\"\nestimate_file = \"f.json\"\n");
  EXPECT_EQ(both.root().table("track").text(both.root().table("track").renamed("estimate_file", "estimate")), "f.json");
  EXPECT_EQ(why([&] { both.root().finish(); }), "study.toml:2: track.estimate: unknown key (known: estimate_file)");
  EXPECT_THAT(both.notes(), testing::IsEmpty());
}

TEST(Study, AcceptsKeysReadThroughAnyOpeningOfATable) {
  const Study twice = study("[subject]\nmass = 2\nspan = 3\n");
  static_cast<void>(twice.root().table("subject").number("mass", "kg"));
  static_cast<void>(twice.root().table("subject").number("span", "m"));
  EXPECT_NO_THROW(twice.root().finish());
}

TEST(Study, ReadsArraysAndArraysOfTables) {
  const Study plan =
      study("rates = [\"1 deg/s\", 2]\none = 3\n[[manoeuvre]]\nkind = \"doublet\"\n[[manoeuvre]]\nkind = \"3211\"\n");
  EXPECT_THAT(plan.root().numbers("rates", "rad/s"), ElementsAre(testing::DoubleEq(std::numbers::pi / 180.0), 2.0));
  EXPECT_THAT(plan.root().numbers("one", "m"), ElementsAre(3.0));
  const std::vector<StudyTable> manoeuvres = plan.root().tables("manoeuvre");
  ASSERT_EQ(manoeuvres.size(), 2u);
  EXPECT_EQ(manoeuvres[1].text("kind"), "3211");
  EXPECT_THAT(manoeuvres[1].place("kind"), HasSubstr("study.toml:6: manoeuvre[1].kind"));
}

TEST(Study, OverridesKeysFromTheCommandLine) {
  const Study changed = study("[data]\nrate = 50\n", {"data.rate=25", "data.file=log.bin", "new.table.key=[1, 2]"});
  EXPECT_DOUBLE_EQ(changed.root().table("data").number("rate", "Hz"), 25.0);
  EXPECT_EQ(changed.root().table("data").text("file"), "log.bin");
  EXPECT_THAT(changed.root().table("new").table("table").numbers("key", "1"), ElementsAre(1.0, 2.0));
  EXPECT_EQ(why([] { static_cast<void>(study("", {"rate"})); }), "--set rate: expected key=value");
  for (const char* key : {"a.", ".", "a..b", ".a"}) {
    EXPECT_EQ(why([&] { static_cast<void>(study("", {std::string(key) + "=1"})); }),
              std::string("--set ") + key + "=1: '" + key + "' is not a key, such as data.from");
  }
  EXPECT_EQ(why([] { static_cast<void>(study("a = 1", {"a.b=1"})); }), "--set a.b=1: 'a' is not a table");
}

TEST(Study, TakesRelativeFilesFromItsFolder) {
  const Study files = study("log = \"flight.bin\"\nother = \"/abs/flight.bin\"\n");
  EXPECT_EQ(files.root().file("log"), "/data/flight.bin");
  EXPECT_EQ(files.root().file("other"), "/abs/flight.bin");
}

TEST(Study, TakesTheSubjectOfAFileWhereItHasNoKeysOfItsOwn) {
  const test::TemporaryFolder temporary;
  const std::filesystem::path& folder = temporary.path();
  std::filesystem::create_directories(folder / "out");
  write_file(folder / "out" / "subject.toml",
             "# graded\n[subject]\nmass = -5\nspan = 2\nname = \"a.tir\"\n[subject.tyres]\nfront = \"front.tir\"\n"
             "both = [\"a.tir\", \"/abs/b.tir\"]\n"
             "[subject.inertia]\nJx = 1\nJy = 2\n[subject.model.CL]\nalpha = 4\nq_n = 5\n[other]\nx = 1\n");
  const auto in_folder = [&](const std::string& text, std::vector<std::string> overrides = {}) {
    return Study::parse(text, "study.toml", folder, overrides);
  };
  const Study named = in_folder("[subject]\nfile = \"out/subject.toml\"\nspan = 3\n");
  const StudyTable subject = named.root().table("subject");
  EXPECT_EQ(subject.number("span", "m"), 3.0);
  EXPECT_EQ(subject.table("tyres").file("front"), folder / "out" / "front.tir");
  EXPECT_THAT(subject.table("tyres").files("both"), ElementsAre(folder / "out" / "a.tir", "/abs/b.tir"));
  const Study own =
      in_folder("[subject]\nfile = \"out/subject.toml\"\ntyres.front = \"f.tir\"\n", {"subject.tyres.rear=r.tir"});
  EXPECT_EQ(own.root().table("subject").table("tyres").file("front"), folder / "f.tir");
  EXPECT_EQ(own.root().table("subject").table("tyres").file("rear"), folder / "r.tir");
  const std::string wrong = why([&] { static_cast<void>(subject.positive("mass", "kg")); });
  EXPECT_THAT(wrong, testing::StartsWith((folder / "out" / "subject.toml").string() + ":3: subject.mass"));
  // Tables within are filled too, but for a coefficient, which is one or the other.
  const Study filled = in_folder("[subject]\nfile = \"out/subject.toml\"\ninertia.Jx = 9\nmodel.CL.alpha = 3\n");
  const StudyTable inertia = filled.root().table("subject").table("inertia");
  EXPECT_EQ(inertia.number("Jx", "kg m^2"), 9.0);
  EXPECT_EQ(inertia.number("Jy", "kg m^2"), 2.0);
  EXPECT_FALSE(filled.root().table("subject").table("model").table("CL").has("q_n"));
  EXPECT_EQ(filled.root().table("subject").text("name"), "a.tir");
  EXPECT_THAT(filled.notes(), ElementsAre(HasSubstr("what this table does not give is taken from ")));
  // What is written down of the run needs the file no more.
  const Study kept = Study::parse(named.to_toml(), "kept.toml", "/elsewhere");
  EXPECT_EQ(kept.root().table("subject").number("mass", "kg"), -5.0);
  EXPECT_EQ(kept.root().table("subject").table("tyres").file("front"), folder / "out" / "front.tir");
  const Study set = in_folder("[scale.model]\nspan = 1\n", {"scale.model.file=out/subject.toml"});
  EXPECT_EQ(set.root().table("scale").table("model").number("mass", "kg"), -5.0);
  EXPECT_THAT(why([&] { static_cast<void>(in_folder("[subject]\nfile = \"absent.toml\"\n")); }),
              HasSubstr("absent.toml: no such file"));
  write_file(folder / "none.toml", "a = 1\n");
  EXPECT_THAT(
      why([&] { static_cast<void>(in_folder("\n[subject]\nfile = \"none.toml\"\n")); }),
      testing::AllOf(testing::StartsWith("study.toml:3: subject.file"), HasSubstr("none.toml has no [subject]")));
  write_file(folder / "chain.toml", "[subject]\nfile = \"none.toml\"\n");
  EXPECT_THAT(why([&] { static_cast<void>(in_folder("[subject]\nfile = \"chain.toml\"\n")); }),
              HasSubstr("takes its subject from another file; name that one"));
  EXPECT_THAT(why([&] { static_cast<void>(in_folder("[subject]\na = 1\n", {"subject.file="})); }),
              testing::StartsWith("--set subject.file: is empty"));
}

TEST(Study, SaysWhereTheTomlIsBroken) {
  EXPECT_THAT(why([] { static_cast<void>(study("a = 1\nb = = 2\n")); }), HasSubstr("study.toml:2:5: not TOML: "));
  EXPECT_THAT(why([] { static_cast<void>(Study::load("missing.toml")); }), HasSubstr("missing.toml: no such file"));
}

TEST(Study, ParsesWhatItPrints) {
  const Study once = study("[data]\nrate = 50\nfiles = [\"a\", \"b\"]\n", {"data.rate=25"});
  const Study again = study(once.to_toml());
  EXPECT_DOUBLE_EQ(again.root().table("data").number("rate", "Hz"), 25.0);
  EXPECT_EQ(again.to_toml(), once.to_toml());
}

}  // namespace
}  // namespace veridyn
