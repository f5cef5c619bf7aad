#include "veridyn/core/study_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

enum class Filter { kNone, kButterworth };

struct Lag {
  double time_s = 0.02;
  std::string kind = "servo";
};

struct Options {
  double rate_Hz = 50.0;
  std::optional<double> throw_rad = {};
  double stop_rad = 25.0 * kDegree;
  std::uint64_t draws = 100;
  bool on = true, noise = true, bias = true;
  Filter filter = Filter::kNone;
  std::array<double, 3> place{};
  std::vector<double> times;
  std::vector<std::string> names{"alpha"};
  std::vector<Filter> filters{Filter::kButterworth};
  std::filesystem::path file;
  std::vector<std::filesystem::path> parts;
  Lag lag;
};

const KeyTable<Lag>& lag_keys() {
  static const auto table = KeyTable<Lag>("lag")
                                .number("time", &Lag::time_s, "s", kNotNegative, "of the first order")
                                .text("kind", &Lag::kind, "what lags")
                                .check([](const StudyTable& t, Lag& lag) {
                                  if (lag.kind == "none" && lag.time_s > 0.0) t.fail("kind", "has no time");
                                });
  return table;
}

const KeyTable<Options>& keys() {
  using O = Options;
  static const auto table =
      KeyTable<O>("thing", "What a thing is.")
          .number("rate", &O::rate_Hz, "Hz", from_to(10.0, 200.0), "of the grid")
          .number("throw", &O::throw_rad, "rad", kPositive, "of the surface")
          .otherwise("not known")
          .number("stop", &O::stop_rad, "rad", between(0.0, 1.0), "where it ends")
          .count("draws", &O::draws, 10, 1000, "of the Monte Carlo")
          .flag("on", &O::on, "whether it runs")
          .choice("filter", &O::filter, {{"none", Filter::kNone}, {"Butterworth", Filter::kButterworth}}, "of noise")
          .numbers("place", &O::place, "m", kAnyNumber, "forward, right, down")
          .numbers("times", &O::times, "s", kNotNegative, "of what happens")
          .texts("names", &O::names, "of channels")
          .choices("filters", &O::filters, {{"none", Filter::kNone}, {"Butterworth", Filter::kButterworth}}, "in turn")
          .flags("without", {{"noise", &O::noise}, {"bias", &O::bias}}, false, "left out")
          .file("file", &O::file, "to read")
          .was("path")
          .files("parts", &O::parts, "to read after it")
          .table("lag", &O::lag, lag_keys());
  return table;
}

Options read(const std::string& toml) {
  return keys().read(Study::parse("[thing]\n" + toml, "study.toml", "folder").root().table("thing"));
}

std::string refusal(const std::string& toml) {
  return why([&] { static_cast<void>(read(toml)); });
}

TEST(StudyKeys, FillWhatTheStudyGivesAndLeaveTheRest) {
  const Options o = read(
      "throw = \"30 deg\"\ndraws = 20\non = false\nfilter = \"Butterworth\"\nplace = [\"10 cm\", 0, -1]\ntimes = 4\n"
      "names = [\"beta\", \"p\"]\nfilters = [\"Butterworth\", \"none\"]\nparts = [\"a.csv\", \"b.csv\"]\nwithout = "
      "[\"bias\"]\npath = \"log.csv\"\nlag = { time = \"50 ms\" }\n");
  EXPECT_EQ(o.rate_Hz, 50.0);
  ASSERT_TRUE(o.throw_rad);
  EXPECT_NEAR(*o.throw_rad, kPi / 6.0, 1e-15);
  EXPECT_EQ(o.draws, 20U);
  EXPECT_FALSE(o.on);
  EXPECT_EQ(o.filter, Filter::kButterworth);
  EXPECT_THAT(o.place, ElementsAre(0.1, 0.0, -1.0));
  EXPECT_THAT(o.times, ElementsAre(4.0));
  EXPECT_THAT(o.names, ElementsAre("beta", "p"));
  EXPECT_THAT(o.filters, ElementsAre(Filter::kButterworth, Filter::kNone));
  EXPECT_TRUE(o.noise);
  EXPECT_FALSE(o.bias);
  EXPECT_EQ(o.file, "folder/log.csv");
  EXPECT_THAT(o.parts, ElementsAre("folder/a.csv", "folder/b.csv"));
  EXPECT_EQ(o.lag.time_s, 0.05);
  EXPECT_EQ(o.lag.kind, "servo");
}

TEST(StudyKeys, RefuseWhatIsOutOfRangeByItsPlace) {
  EXPECT_THAT(refusal("rate = 300\n"), HasSubstr("study.toml:2: thing.rate: = 300 Hz must be from 10 to 200 Hz"));
  EXPECT_THAT(refusal("throw = 0\n"), HasSubstr("thing.throw: = 0 must be > 0"));
  EXPECT_THAT(refusal("stop = 1\n"), HasSubstr("thing.stop: = 1 rad must be between 0 and 1 rad"));
  EXPECT_THAT(refusal("draws = 5\n"), HasSubstr("thing.draws: = 5 must be from 10 to 1000"));
  EXPECT_THAT(refusal("filter = \"Bessel\"\n"), HasSubstr("'Bessel' is not one of none, Butterworth"));
  EXPECT_THAT(refusal("filters = [\"none\", \"Bessel\"]\n"),
              HasSubstr("'Bessel' is unknown (known: none, Butterworth)"));
  EXPECT_THAT(refusal("without = [\"nois\"]\n"), HasSubstr("'nois' is unknown (did you mean 'noise'?)"));
  EXPECT_THAT(refusal("place = [1, 2]\n"), HasSubstr("thing.place: has 2 numbers, needs 3"));
  EXPECT_THAT(refusal("times = [1, -2]\n"), HasSubstr("thing.times: = -2 must be >= 0"));
  EXPECT_THAT(refusal("lag = { time = -1 }\n"), HasSubstr("thing.lag.time: = -1 must be >= 0"));
  EXPECT_THAT(refusal("lag = { kind = \"none\" }\n"), HasSubstr("thing.lag.kind: has no time"));
}

TEST(StudyKeys, NameAllThatIsMissingAtOnce) {
  const auto table = KeyTable<Lag>("lag")
                         .number("time", &Lag::time_s, "s", kNotNegative, "of the first order")
                         .required()
                         .text("kind", &Lag::kind, "what lags")
                         .required();
  const auto missing = [&](const std::string& toml) {
    return why([&] { static_cast<void>(table.read(Study::parse(toml, "study.toml").root().table("lag"))); });
  };
  EXPECT_THAT(missing("[lag]\n"), HasSubstr("study.toml:1: lag: time, kind are missing"));
  EXPECT_THAT(missing("[lag]\ntime = 1\n"), HasSubstr("lag.kind: is missing"));
}

TEST(StudyKeys, OfTablesWithinHaveTheDefaultsOfWhatTheyAreIn) {
  struct Slower {
    Lag lag{.time_s = 0.5};
    double pose = 1.0;
  };
  const auto table = KeyTable<Slower>("thing")
                         .elsewhere({"pose", "rad", "", "", "of the joint"})
                         .required()
                         .table("lag", &Slower::lag, lag_keys())
                         .repeated();
  const std::vector<StudyKeys> all = table.described();
  EXPECT_EQ(all[1].keys[0].otherwise, "\"0.5 s\"");
  EXPECT_THAT(in_markdown(all[0]), HasSubstr("| `[[thing]]` | unit"));
  EXPECT_THAT(in_markdown(all[1]), HasSubstr("| `[thing.lag]` | unit"));
  const auto of = [&](const std::string& toml) {
    return table.read(Study::parse(toml, "study.toml").root().table("thing"));
  };
  EXPECT_EQ(of("[thing]\npose = 2\n").pose, 1.0);  // read elsewhere
  EXPECT_THAT(why([&] { static_cast<void>(of("[thing]\n")); }), HasSubstr("thing.pose: is missing"));
}

struct Servos {
  Lag first{.time_s = 0.5, .kind = "old"};
  std::optional<Lag> last;
  std::vector<Lag> others;
};

TEST(StudyKeys, ReadTablesWithinOverWhatIsThereOrAsAWhole) {
  const auto table = KeyTable<Servos>("servos")
                         .table("first", &Servos::first, lag_keys())
                         .whole_table("last", &Servos::last, lag_keys())
                         .tables("other", lag_keys(), [](const StudyTable& one, Servos& servos) {
                           servos.others.push_back(lag_keys().read(one));
                         });
  const auto read = [&](const std::string& toml) {
    return table.read(Study::parse("[servos]\n" + toml, "study.toml").root().table("servos"));
  };
  EXPECT_FALSE(read("").last);
  Servos servos{.first = {}, .last = Lag{.time_s = 0.5, .kind = "old"}, .others = {}};
  const Study study = Study::parse(
      "[servos]\nfirst = { time = 1 }\nlast = { time = 2 }\n[[servos.other]]\ntime = 3\n[[servos.other]]\nkind = "
      "\"none\"\ntime = 0\n",
      "study.toml");
  table.read(study.root().table("servos"), servos);
  EXPECT_EQ(servos.first.time_s, 1.0);
  EXPECT_EQ(servos.first.kind, "servo");
  EXPECT_EQ(servos.last->kind, "servo") << "as a whole, with its default";
  ASSERT_EQ(servos.others.size(), 2U);
  EXPECT_EQ(servos.others[0].time_s, 3.0);
  EXPECT_EQ(servos.others[1].kind, "none");
  EXPECT_EQ(read("first = { time = 1 }\n").first.kind, "old") << "over what was there";
  const std::vector<StudyKeys> all = table.described();
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(heading_of(all[1]), "[servos.first]");
  EXPECT_EQ(heading_of(all[3]), "[[servos.other]]");
}

TEST(StudyKeys, OfAPartBringItsTablesAndRules) {
  struct Plant {
    Options options;
  };
  const auto table = KeyTable<Plant>("thing").with(&Plant::options, keys());
  const auto read = [&](const std::string& toml) {
    return table.read(Study::parse("[thing]\n" + toml, "study.toml").root().table("thing"));
  };
  EXPECT_EQ(read("draws = 20\nlag = { time = 1 }\n").options.lag.time_s, 1.0);
  EXPECT_THAT(why([&] { static_cast<void>(read("lag = { kind = \"none\" }\n")); }),
              HasSubstr("thing.lag.kind: has no time"));
  ASSERT_EQ(table.described().size(), 2U);
  EXPECT_EQ(table.described()[1].table, "thing.lag");
}

TEST(StudyKeys, KnowTheirNamesForUnknownOnes) {
  const Study study = Study::parse("[thing]\nrat = 3\n", "study.toml");
  static_cast<void>(keys().read(study.root().table("thing")));
  EXPECT_THAT(why([&] { study.root().finish(); }), HasSubstr("thing.rat: unknown key (did you mean 'rate'?)"));
}

TEST(StudyKeys, DescribeThemselvesWithDefaultsThatTheStudyWouldTake) {
  const std::vector<StudyKeys> all = keys().described();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].table, "thing");
  EXPECT_EQ(all[1].table, "thing.lag");
  const auto shown = [&](const std::string& name) {
    for (const StudyKey& key : all[0].keys)
      if (key.name == name) return key.otherwise;
    return std::string("no such key");
  };
  EXPECT_EQ(shown("rate"), "\"50 Hz\"");
  EXPECT_EQ(shown("throw"), "not known");
  EXPECT_EQ(shown("stop"), "\"25 deg\"");
  EXPECT_EQ(shown("filter"), "\"none\"");
  EXPECT_EQ(shown("place"), "[0, 0, 0]");
  EXPECT_EQ(shown("filters"), "[\"Butterworth\"]");
  EXPECT_EQ(shown("without"), "[]");
  EXPECT_EQ(shown("names"), "[\"alpha\"]");
  // Written out and read again they are the defaults.
  std::string toml;
  for (const StudyKey& key : all[0].keys)
    if (!key.in_words && !key.otherwise.empty()) toml += key.name + " = " + key.otherwise + "\n";
  const Options again = read(toml);
  EXPECT_EQ(again.rate_Hz, 50.0);
  EXPECT_NEAR(again.stop_rad, 25.0 * kDegree, 1e-15);
  EXPECT_EQ(again.draws, 100U);
  EXPECT_THAT(in_markdown(all[0]), HasSubstr("| `rate` | Hz | `\"50 Hz\"` | from 10 to 200 Hz | of the grid |\n"
                                             "| `throw` | rad | not known | > 0 | of the surface |\n"));
  EXPECT_THAT(commented_line(all[0].keys[0]), HasSubstr("# rate = \"50 Hz\""));
}

TEST(StudyKeys, StandCommentedInAStudyToStartFrom) {
  const std::string study = with_keys("[thing]\n@keys thing rate filter throw\nrate = 3\n", keys().described());
  EXPECT_EQ(study,
            "[thing]\n"
            "# rate = \"50 Hz\"                   # of the grid\n"
            "# filter = \"none\"                  # of noise: \"none\", \"Butterworth\"\n"
            "# throw = ...                      # of the surface; by default not known\n"
            "rate = 3\n");
  EXPECT_THROW(static_cast<void>(with_keys("@keys thing rat\n", keys().described())), std::logic_error);
}

}  // namespace
}  // namespace veridyn
