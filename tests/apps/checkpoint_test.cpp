// Long work that is killed, resumed, cut into shards and run under a launcher gives the same files.
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <random>
#include <thread>
#include <utility>

#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"

namespace veridyn {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kKilled = 137;  // by the shell

constexpr const char* kNoMpi = "there is no mpirun here, or the program was built without MPI";

bool has_mpi() { return VERIDYN_HAS_MPI && std::system("command -v mpirun >/dev/null 2>&1") == 0; }
std::string mpirun(const std::string& processes) {
  return "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --oversubscribe -n " + processes;
}
/// How often the text says it.
std::size_t times(const std::string& text, const std::string& words) {
  std::size_t count = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++count;
  return count;
}

class CheckpointProgram : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    // What a launcher that started this test says is not for the programs that it starts.
    for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"}) ::unsetenv(name);
  }

  /// 960 simulations and 152 more of the tasks that are chosen: eight blocks and two.
  [[nodiscard]] std::string sensitivity(const std::string& out = "out", const std::string& more = "--threads 1") const {
    return "sensitivity " + (test::source_folder() / "examples/studies/muscle/arm_sensitivity.toml").string() +
           " --out " + (folder_ / out).string() + " --checkpoint " + checkpoint() + " " + more;
  }
  [[nodiscard]] std::string checkpoint() const { return (folder_ / "blocks").string(); }
  [[nodiscard]] std::size_t blocks() const {
    std::size_t count = 0;
    if (!std::filesystem::exists(checkpoint())) return 0;
    for (const auto& entry : std::filesystem::directory_iterator(checkpoint()))
      count += entry.path().extension() == ".block" ? 1U : 0U;
    return count;
  }
  [[nodiscard]] std::map<std::string, std::string> tables(const std::string& out = "out") const {
    std::map<std::string, std::string> found;
    for (const char* name : {"sensitivity.csv", "tasks.csv", "indices.csv"})
      found[name] = read_file(folder_ / out / name);
    return found;
  }
  /// Of a run without a checkpoint.
  [[nodiscard]] const std::map<std::string, std::string>& undisturbed() const {
    static const std::map<std::string, std::string> all = [this] {
      const Outcome done =
          run("sensitivity " + (test::source_folder() / "examples/studies/muscle/arm_sensitivity.toml").string() +
              " --out " + (folder_ / "undisturbed").string());
      EXPECT_EQ(done.exit_code, 0) << done.text;
      return tables("undisturbed");
    }();
    return all;
  }
  void forget() const { std::filesystem::remove_all(checkpoint()); }
  /// Kills the second process of mpirun once `under_way` holds; false if that does not come.
  [[nodiscard]] bool kill_second(const std::function<bool()>& under_way) const {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!under_way() && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const int process = process_of_rank(1);
    return under_way() && process > 1 && ::kill(process, SIGKILL) == 0;
  }

 private:
  /// Of the program that works with this test's folder; 0: there is none.
  [[nodiscard]] int process_of_rank(int rank) const {
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const std::string name = entry.path().filename().string();
      if (name.find_first_not_of("0123456789") != std::string::npos) continue;
      const auto all_of = [&](const char* file) {
        std::ifstream stream(entry.path() / file, std::ios::binary);
        return std::string{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
      };
      const std::string rank_is = "OMPI_COMM_WORLD_RANK=" + std::to_string(rank);
      if (all_of("cmdline").find(folder_.string()) != std::string::npos &&
          ('\0' + all_of("environ")).find('\0' + rank_is + '\0') != std::string::npos)
        return std::stoi(name);
    }
    return 0;
  }
};

TEST_F(CheckpointProgram, ResumesBitForBitWhenItIsKilled) {
  std::mt19937 random(std::random_device{}());
  std::uniform_real_distribution<double> seconds(0.2, 0.7);
  int killed = 0;
  std::size_t before = 0;
  for (int attempt = 0; attempt < 4; ++attempt) {
    const Outcome outcome = run_under("timeout -s KILL " + std::to_string(seconds(random)), sensitivity());
    ASSERT_TRUE(outcome.exit_code == kKilled || outcome.exit_code == 0) << outcome.exit_code << outcome.text;
    killed += outcome.exit_code == kKilled ? 1 : 0;
    EXPECT_GE(blocks(), before);
    before = blocks();
  }
  EXPECT_GT(killed, 0);
  const Outcome done = run(sensitivity());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  EXPECT_THAT(done.text, HasSubstr(std::to_string(before) + " of 10 blocks were in " + checkpoint()));
  EXPECT_EQ(tables(), undisturbed());
}

TEST_F(CheckpointProgram, ShardsMergeToTheSameBytes) {
  const Outcome first = run(sensitivity("out", "--shard 1/2"));
  ASSERT_EQ(first.exit_code, 0) << first.text;
  EXPECT_THAT(first.text, HasSubstr("shard 1 of 2 is done; 4 of 8 blocks are missing in " + checkpoint()));
  EXPECT_TRUE(results().empty());
  const Outcome early = run(sensitivity("out", "--merge"));
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_THAT(early.text, HasSubstr("blocks: 4 of 8 blocks are missing"));
  // Nothing of the sampling is missing any more: the second shard goes on with the indices.
  const Outcome second = run(sensitivity("out", "--shard 2/2"));
  EXPECT_THAT(second.text, HasSubstr("shard 2 of 2 is done; 1 of 2 blocks are missing"));
  const Outcome last = run(sensitivity("out", "--shard 1/2"));
  ASSERT_EQ(last.exit_code, 0) << last.text;
  EXPECT_EQ(tables(), undisturbed());
  std::filesystem::remove_all(folder_ / "out");
  const Outcome merge = run(sensitivity("out", "--merge"));
  EXPECT_THAT(merge.text, HasSubstr("10 of 10 blocks were in"));
  EXPECT_EQ(tables(), undisturbed());
}

TEST_F(CheckpointProgram, MpirunGivesTheSameBytesWithAndWithoutAFolder) {
  if (!has_mpi()) GTEST_SKIP() << kNoMpi;
  for (const char* size : {"1", "2", "3"}) {
    forget();
    const Outcome done = run_under(mpirun(size), sensitivity(size, ""));
    ASSERT_EQ(done.exit_code, 0) << done.text;
    EXPECT_EQ(tables(size), undisturbed()) << size;
    EXPECT_EQ(times(done.text, "wrote sensitivity.csv"), 1U) << done.text;
    EXPECT_EQ(blocks(), 10U);
  }
  const std::string study = (test::source_folder() / "examples/studies/muscle/arm_sensitivity.toml").string();
  const Outcome done = run_under(mpirun("2"), "sensitivity " + study + " --out " + (folder_ / "none").string());
  ASSERT_EQ(done.exit_code, 0) << done.text;
  EXPECT_EQ(tables("none"), undisturbed());
}

TEST_F(CheckpointProgram, MpirunEndsWithAProcessAndIsResumed) {
  if (!has_mpi()) GTEST_SKIP() << kNoMpi;
  Outcome ended;
  std::jthread running([&] { ended = run_under(mpirun("2"), sensitivity()); });
  ASSERT_TRUE(kill_second([&] { return blocks() > 0; }));
  running.join();
  EXPECT_NE(ended.exit_code, 0) << ended.text;
  EXPECT_EQ(times(ended.text, "veridyn: "), 1U) << ended.text;
  EXPECT_THAT(ended.text, HasSubstr("veridyn: mpirun ends the run of 2 processes: "));
  EXPECT_THAT(ended.text, HasSubstr("process rank 1"));
  EXPECT_FALSE(std::filesystem::exists(in_out("sensitivity.csv")));
  const std::size_t kept = blocks();
  const Outcome done = run_under(mpirun("3"), sensitivity("out", ""));
  ASSERT_EQ(done.exit_code, 0) << done.text;
  EXPECT_THAT(done.text, HasSubstr(std::to_string(kept) + " of 10 blocks were in " + checkpoint()));
  EXPECT_EQ(tables(), undisturbed());
}

TEST_F(CheckpointProgram, UnderMpirunTheFirstProcessSaysOnceWhatIsWrongInAny) {
  if (!has_mpi()) GTEST_SKIP() << kNoMpi;
  const auto refusal = [&](const std::string& under, const std::string& arguments) {
    const Outcome outcome = run_under(under, arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
    EXPECT_EQ(times(outcome.text, "veridyn: "), 1U) << outcome.text;
    return outcome.text;
  };
  EXPECT_THAT(refusal(mpirun("2"), "sensitivity none.toml" + out()), HasSubstr("veridyn: none.toml"));
  EXPECT_THAT(refusal(mpirun("2"), "demo" + out()), HasSubstr("veridyn: demo: runs in one process, 2 were started"));
  EXPECT_THAT(refusal(mpirun("2"), sensitivity("out", "--shard 1/2")),
              HasSubstr("--shard: is for single processes; 2 under mpirun"));
  // A study that is another one for the second process.
  const std::string more = " --set tasks.numbers=[8] --set sensitivity.choose=1 --set sensitivity.samples=$samples";
  const std::string other =
      mpirun("2") + " sh -c 'samples=$((1 + OMPI_COMM_WORLD_RANK)); exec \"$0\" \"$@\" " + more + "'";
  EXPECT_THAT(refusal(other, sensitivity()), HasSubstr("veridyn: process 2 of 2: has another study, other files"));
  // One that the second cannot read.
  const std::string without =
      mpirun("2") + " sh -c 'test $OMPI_COMM_WORLD_RANK = 0 || set -- \"$1\" none.toml; exec \"$0\" \"$@\"'";
  EXPECT_THAT(refusal(without, sensitivity()), HasSubstr("veridyn: process 2 of 2: none.toml"));
  const Outcome version = run_under(mpirun("2"), "--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(times(version.text, "\n"), 1U) << version.text;
}

TEST_F(CheckpointProgram, TakesTheProcessorsThatItMayUse) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "one processor";
  cpu_set_t allowed;
  ASSERT_EQ(::sched_getaffinity(0, sizeof allowed, &allowed), 0);
  int first = 0;
  while (!CPU_ISSET(first, &allowed)) ++first;
  const std::string bound = "taskset -c " + std::to_string(first);
  const std::string study = (test::source_folder() / "examples/studies/muscle/arm_sensitivity.toml").string();
  const std::string small = "sensitivity " + study + " --set tasks.numbers=[8] --set sensitivity.samples=1 " +
                            "--set sensitivity.choose=1 --set sensitivity.method=none" + out();
  const auto threads = [&](const std::string& under, const std::string& more) {
    const Outcome done = run_under(under, small + more);
    EXPECT_EQ(done.exit_code, 0) << done.text;
    const std::string record = read_file(in_out("run.json"));
    return record.substr(record.find("\"threads\": "), 12);
  };
  EXPECT_EQ(threads(bound, ""), "\"threads\": 1");
  EXPECT_EQ(threads(bound, " --threads 2"), "\"threads\": 2");
}

TEST_F(CheckpointProgram, RefusesWhatItCannotShareOrContinue) {
  const std::string study = (test::source_folder() / "examples/studies/muscle/arm_sensitivity.toml").string();
  const auto refused = [&](const std::string& more, const std::string& message) {
    expect_refusal("sensitivity " + study + " " + more + out(), message);
  };
  refused("--shard 1/2", "--shard: needs --checkpoint");
  refused("--merge", "--merge: needs --checkpoint");
  const std::string kept = " --checkpoint " + checkpoint();
  refused("--merge --shard 1/2" + kept, "choose one of them");
  for (const char* wrong : {"0/2", "3/2", "1", "1/0", "a/b", "1/2/3", "-1/2"})
    refused(std::string("--shard ") + wrong + kept, "must be I/N with I from 1 to N");
  if (!VERIDYN_HAS_MPI) {
    const Outcome many = run_under("OMPI_COMM_WORLD_RANK=0 OMPI_COMM_WORLD_SIZE=2", "sensitivity " + study + out());
    EXPECT_EQ(many.exit_code, 2);
    EXPECT_THAT(many.text, HasSubstr("several processes were started, but this program has no MPI"));
    const Outcome second = run_under("OMPI_COMM_WORLD_RANK=1 OMPI_COMM_WORLD_SIZE=2", "sensitivity " + study + out());
    EXPECT_EQ(second.text, "");
  }
  const Outcome rank = run_under("PMI_RANK=2 PMI_SIZE=2", "sensitivity " + study + out());
  EXPECT_EQ(rank.exit_code, 2);
  EXPECT_THAT(rank.text, HasSubstr("PMI_RANK: is 2; must be below PMI_SIZE = 2"));
  // A batch script has these without srun, and is alone.
  const Outcome script =
      run_under("SLURM_PROCID=0 SLURM_NTASKS=4", "sensitivity " + study +
                                                     " --set tasks.numbers=[8] --set sensitivity.samples=1 "
                                                     "--set sensitivity.choose=1 --set sensitivity.method=none" +
                                                     kept + out());
  EXPECT_EQ(script.exit_code, 0) << script.text;
  std::filesystem::remove_all(folder_ / "out");
  refused("--set sensitivity.samples=8" + kept, "is of another study or version: ");
  EXPECT_TRUE(results().empty());
}

TEST_F(CheckpointProgram, RefusesAFolderOfAnotherVersionAndSaysBoth) {
  const std::string small =
      sensitivity("out",
                  "--quiet --threads 1 --set tasks.numbers=[8] --set sensitivity.samples=1 --set sensitivity.choose=1 "
                  "--set sensitivity.method=none");
  ASSERT_EQ(run(small).exit_code, 0);
  const std::string manifest = checkpoint() + "/checkpoint.txt";
  std::string text = read_file(manifest);
  const std::size_t place = text.find("veridyn ", text.find("program"));
  ASSERT_NE(place, std::string::npos) << text;
  text.replace(place, text.find_first_of("\n", place) - place, "veridyn 0.0.1");
  write_file(manifest, text);
  const Outcome refused = run(small);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.text, HasSubstr("is of another study or version: "));
  EXPECT_THAT(refused.text, HasSubstr("veridyn 0.0.1"));
  EXPECT_EQ(std::count(refused.text.begin(), refused.text.end(), '\n'), 1) << refused.text;
}

/// `veridyn identify` of a person: one search after the other.
class IdentifyCheckpoint : public CheckpointProgram {
 protected:
  [[nodiscard]] std::string identify(const std::string& more, const std::string& out = "out") const {
    return "identify " + (test::source_folder() / "examples/studies/muscle/profile_arm.toml").string() +
           " --set identify.advice=false --threads 1 " + more + " --out " + (folder_ / out).string();
  }
  [[nodiscard]] std::string kept() const { return " --checkpoint " + checkpoint() + " "; }

  /// Killed at four random moments of its first seconds, and resumed: the files of a run that nothing disturbed.
  void expect_resumes(const std::string& more, double seconds, const std::vector<std::string>& files) {
    ASSERT_EQ(run(identify(more, "whole")).exit_code, 0);
    std::mt19937 random(std::random_device{}());
    std::uniform_real_distribution<double> when(0.1 * seconds, seconds);
    int killed = 0;
    for (int attempt = 0; attempt < 4; ++attempt) {
      const Outcome outcome =
          run_under("timeout -s KILL " + std::to_string(when(random)), identify(more + kept(), "killed"));
      ASSERT_TRUE(outcome.exit_code == kKilled || outcome.exit_code == 0) << outcome.exit_code << outcome.text;
      killed += outcome.exit_code == kKilled ? 1 : 0;
    }
    EXPECT_GT(killed, 0);
    const Outcome done = run(identify(more + kept()));
    ASSERT_EQ(done.exit_code, 0) << done.text;
    for (const std::string& name : files)
      EXPECT_EQ(read_file(in_out(name)), read_file(folder_ / "whole" / name)) << name;
  }
};

TEST_F(IdentifyCheckpoint, ResumesSearchProfilesAndPosteriorBitForBit) {
  expect_resumes(
      "--set 'identify.profiles=[\"triceps_long.optimal_fiber_length\"]' "
      "--set 'identify.posterior={walkers=10,steps=30,effective=10}'",
      1.0, {"estimate.json", "parameters.csv", "tasks.csv", "profiles.csv", "posterior.csv", "model.osim"});
  EXPECT_THAT(run(identify(kept())).text, HasSubstr("is of another study or version: "));
}

TEST_F(IdentifyCheckpoint, ResumesThePublishedSearchBitForBit) {
  expect_resumes("--set 'identify.profiles=[]' --set identify.route=published --set identify.evaluations=400", 0.4,
                 {"estimate.json", "parameters.csv", "tasks.csv", "model.osim"});
}

TEST_F(IdentifyCheckpoint, APublishedSearchThatDoesNotHoldItsToleranceIsSaidSo) {
  const Outcome done =
      run(identify("--set 'identify.profiles=[]' --set identify.route=published "
                   "--set identify.evaluations=30 --set identify.tolerance=1e-5"));
  ASSERT_EQ(done.exit_code, 0) << done.text;
  EXPECT_THAT(done.text, HasSubstr("warning: the published search ended with an NRMSE of "));
  EXPECT_THAT(done.text, HasSubstr("more than the tolerance of 1e-05"));
}

TEST_F(IdentifyCheckpoint, SaysWhatItTookFromTheFolderAndWhatWasAskedOfTheModel) {
  const std::string more = "--set 'identify.profiles=[]'" + kept();
  EXPECT_THAT(run(identify(more)).text, Not(HasSubstr("of the search were in")));
  EXPECT_THAT(run(identify(more)).text, HasSubstr(" simulations of the search were in " + checkpoint()));
  const std::string log = read_file(in_out("evaluations.csv"));
  EXPECT_THAT(log, ::testing::StartsWith("evaluation,kind,seconds,end,\"NRMSE task 8: "));
  EXPECT_THAT(log, HasSubstr("\n1,values,"));
  EXPECT_THAT(log, HasSubstr(",derivatives,"));
  EXPECT_THAT(log, Not(HasSubstr("failed")));
}

TEST_F(IdentifyCheckpoint, MpirunGivesTheSameBytes) {
  if (!has_mpi()) GTEST_SKIP() << kNoMpi;
  const std::string gradient =
      "--set 'identify.profiles=[\"triceps_long.optimal_fiber_length\"]' "
      "--set 'identify.posterior={walkers=10,steps=20,effective=10}'";
  const std::string published =
      "--set 'identify.profiles=[]' --set identify.route=published --set identify.evaluations=200";
  for (const std::string& more : {gradient, published}) {
    ASSERT_EQ(run(identify(more, "alone")).exit_code, 0);
    // One process without a folder.
    for (const char* size : {"1", "2", "3"}) {
      const Outcome done = run_under(mpirun(size), identify(more + (*size == '1' ? "" : kept())));
      ASSERT_EQ(done.exit_code, 0) << done.text;
      for (const char* name : {"estimate.json", "parameters.csv", "tasks.csv", "model.osim"})
        EXPECT_EQ(read_file(in_out(name)), read_file(folder_ / "alone" / name)) << name << ", " << size;
      EXPECT_EQ(times(done.text, "report: "), 1U) << done.text;
      forget();
    }
  }
}

TEST_F(IdentifyCheckpoint, MpirunEndsWithAProcessAndIsResumed) {
  if (!has_mpi()) GTEST_SKIP() << kNoMpi;
  const std::string more =
      "--set 'identify.profiles=[]' --set 'identify.posterior={walkers=10,steps=60,effective=100000}'";
  ASSERT_EQ(run(identify(more, "alone")).exit_code, 0);
  Outcome ended;
  std::jthread running([&] { ended = run_under(mpirun("2"), identify(more + kept())); });
  ASSERT_TRUE(kill_second([&] {
    std::error_code none;
    return std::filesystem::file_size(checkpoint() + "/evaluations.log", none) > 10000 && !none;
  }));
  running.join();
  EXPECT_NE(ended.exit_code, 0) << ended.text;
  EXPECT_EQ(times(ended.text, "veridyn: "), 1U) << ended.text;
  EXPECT_FALSE(std::filesystem::exists(in_out("estimate.json")));
  const Outcome done = run_under(mpirun("3"), identify(more + kept()));
  ASSERT_EQ(done.exit_code, 0) << done.text;
  EXPECT_THAT(done.text, HasSubstr(" simulations of the search were in " + checkpoint()));
  for (const char* name : {"estimate.json", "posterior.csv"})
    EXPECT_EQ(read_file(in_out(name)), read_file(folder_ / "alone" / name)) << name;
}

TEST_F(IdentifyCheckpoint, RefusesOtherStudies) {
  const std::string flight = (test::source_folder() / "examples/studies/simulated_flight.toml").string();
  expect_refusal("identify " + flight + kept() + out(), "--checkpoint: is for a person's tasks");
  expect_refusal(identify("--shard 1/2"), "there is no option --shard");
  if (has_mpi()) {
    const Outcome drive = run_under(mpirun("2"), "identify " + flight + out());
    EXPECT_EQ(drive.exit_code, 2);
    EXPECT_THAT(drive.text, HasSubstr("identify: runs in one process for this study, 2 were started"));
    EXPECT_EQ(times(drive.text, "veridyn: "), 1U) << drive.text;
  }
  EXPECT_TRUE(results().empty());
}

}  // namespace
}  // namespace veridyn
