#include "veridyn/io/ulog/ulog_story.hpp"

#include "tests/io/support.hpp"

namespace veridyn::io {
namespace {

TEST(ULogStory, TellsChangesOfModeAndArming) {
  Log log;
  LogTopic status{.name = "vehicle_status", .time = make_time_base({1.0, 2.0, 3.0}), .fields = {}};
  status.fields.push_back({.name = "nav_state", .values = Column(std::vector<double>{0.0, 3.0, 99.0})});
  status.fields.push_back({.name = "arming_state", .values = Column(std::vector<double>{1.0, 2.0, 2.0})});
  log.topics.push_back(std::move(status));
  read_ulog_events(log);
  std::vector<std::string> told;
  for (const Event& event : log.events) told.push_back(event.kind + " " + event.text);
  EXPECT_THAT(told, ::testing::UnorderedElementsAre("mode MANUAL", "armed disarmed", "mode AUTO_MISSION", "armed armed",
                                                    "mode 99"));
  Log empty;
  read_ulog_events(empty);
  EXPECT_TRUE(empty.events.empty());
}

}  // namespace
}  // namespace veridyn::io
