// veridyn serve, and the progress that it shows of other commands.
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/apps/page_reader.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"

namespace veridyn {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class ServeProgramTest : public ProgramTest {
 protected:
  [[nodiscard]] int port() const { return 27000 + static_cast<int>(::getpid()) % 3000; }
  [[nodiscard]] std::string page() const { return " --page 127.0.0.1:" + std::to_string(port()); }
  /// All that the page gets now. On a busy machine an answer may be late, and is asked for again.
  [[nodiscard]] nlohmann::json status() const {
    nlohmann::json answer;
    for (int k = 0; k < 20 && !answer.is_object(); ++k) {
      if (k > 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));
      const PageReader reader(port(), "GET /status HTTP/1.1\r\nConnection: close\r\n");
      std::string all;
      for (std::string text = reader.read(); !text.empty(); text = reader.read()) all += text;
      const std::size_t body = all.find("\r\n\r\n");
      if (body != std::string::npos) answer = nlohmann::json::parse(all.substr(body), nullptr, false);
    }
    return answer;
  }
  /// Waits until the work in the folder is in this state. @return what the page says of it
  [[nodiscard]] nlohmann::json work_until(const std::string& state) const {
    nlohmann::json work;
    for (int k = 0; k < 600; ++k) {
      if (const nlohmann::json all = status(); all.is_object() && !all["work"].empty()) work = all["work"][0];
      if (work.is_object() && work["state"] == state) return work;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return work;
  }
};

TEST_F(ServeProgramTest, RefusesWhatItCannotShow) {
  expect_refusal("serve " + (folder_ / "missing").string() + page(), "missing: no such file or folder");
  expect_refusal("serve " + file("text.vlr", std::string(200, 'x')) + page(),
                 "text.vlr: is no recording of a live run");
  const std::string here = "serve " + folder_.string();
  expect_refusal(here + " --page nowhere", "--page");
  expect_refusal(here + page() + " --rate 100", "--rate: is 100 Hz; takes 1 to 60");
  const std::string token = file("token", "0123456789abcdef\n");
  fs::permissions(token, fs::perms::owner_read | fs::perms::others_read);
  expect_refusal(here + page() + " --token-file " + token, "can be read by others");
  expect_refusal("serve", "FOLDER_OR_RECORDING is required");
}

TEST_F(ServeProgramTest, BeyondLoopbackWithoutATokenOnlyShows) {
  Process serve({"serve", folder_.string(), "--page", "0.0.0.0:" + std::to_string(port()), "--json"},
                folder_ / "serve.txt");
  ASSERT_TRUE(serve.says("it only shows", 20.0)) << serve.said();
  EXPECT_EQ(status()["controls"], "none");
  const std::string body = "{\"request\": \"emergency\"}";
  for (const auto& [header, answer] : {std::pair("", " 401 "), std::pair("Authorization: Bearer \r\n", " 401 "),
                                       std::pair("Authorization: Bearer 0123456789abcdef\r\n", " 403 ")}) {
    const PageReader control(port(), "POST /control HTTP/1.1\r\nConnection: close\r\nContent-Length: " +
                                         std::to_string(body.size()) + "\r\n" + header);
    control.send(body);
    EXPECT_THAT(control.read().substr(0, 20), HasSubstr(answer));
  }
  // The page tells it with its next status.
  for (int k = 0; k < 40 && status()["refused"] != 3; ++k) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(status()["refused"], 3);
  serve.signal(SIGINT);
  EXPECT_EQ(serve.wait(), 0) << serve.said();
  EXPECT_THAT(serve.said(), HasSubstr("\"controls_refused\": 3"));
}

TEST_F(ServeProgramTest, ShowsHowFarAnIdentificationIsAndWhatBecameOfIt) {
  const std::string study = (test::source_folder() / "examples/studies/muscle/posterior_arm.toml").string();
  Process serve({"serve", folder_.string(), "--page", "127.0.0.1:" + std::to_string(port())}, folder_ / "serve.txt");
  ASSERT_TRUE(serve.says("token:", 20.0)) << serve.said();
  const std::vector<std::string> words = {"identify", study, "--quiet", "--out", (folder_ / "out").string()};
  {
    Process killed(words, folder_ / "killed.txt");
    const nlohmann::json work = work_until("goes on");
    ASSERT_EQ(work["state"], "goes on") << serve.said();
    EXPECT_EQ(work["command"], "identify");
    EXPECT_THAT(work["study"].get<std::string>(), HasSubstr("posterior_arm.toml"));
    EXPECT_EQ(work["folder"], (folder_ / "out").string());
    EXPECT_GT(work["stages"], 0);
    killed.signal(SIGKILL);
    EXPECT_EQ(killed.wait(), -1);
  }
  EXPECT_EQ(work_until("was killed")["state"], "was killed");
  fs::remove_all(folder_ / "out");
  Process stopped(words, folder_ / "stopped.txt");
  ASSERT_EQ(work_until("goes on")["state"], "goes on");
  stopped.signal(SIGINT);
  EXPECT_EQ(stopped.wait(), 1) << stopped.said();
  EXPECT_FALSE(fs::exists(folder_ / "out"));  // nothing is left of it, nor of its progress
  Process identify(words, folder_ / "identify.txt");
  ASSERT_EQ(work_until("goes on")["state"], "goes on");
  int stages = 0;
  double most = 0.0;
  for (nlohmann::json all = status(); all["work"][0]["state"] == "goes on"; all = status()) {
    stages = std::max(stages, all["work"][0]["stages"].get<int>());
    most = std::max(most, all["work"][0]["fraction"].get<double>());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(identify.wait(), 0) << identify.said();
  EXPECT_GT(stages, 3);
  EXPECT_GT(most, 0.1);
  EXPECT_EQ(work_until("done")["state"], "done");
  for (const auto& entry : fs::directory_iterator(folder_ / "out"))
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr(".part")));
  EXPECT_FALSE(fs::exists(in_out("progress.json")));
}

}  // namespace
}  // namespace veridyn
