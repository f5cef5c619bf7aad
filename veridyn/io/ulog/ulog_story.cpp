#include "veridyn/io/ulog/ulog_story.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace veridyn::io {

// nav_state and arming_state of PX4's vehicle_status.msg.
void read_ulog_events(Log& log) {
  static const std::map<int, const char*> modes{{0, "MANUAL"},         {1, "ALTCTL"},      {2, "POSCTL"},
                                                {3, "AUTO_MISSION"},   {4, "AUTO_LOITER"}, {5, "AUTO_RTL"},
                                                {10, "ACRO"},          {12, "DESCEND"},    {13, "TERMINATION"},
                                                {14, "OFFBOARD"},      {15, "STABILIZED"}, {16, "RATTITUDE"},
                                                {17, "AUTO_TAKEOFF"},  {18, "AUTO_LAND"},  {19, "AUTO_FOLLOW_TARGET"},
                                                {20, "AUTO_PRECLAND"}, {21, "ORBIT"},      {22, "AUTO_VTOL_TAKEOFF"}};
  const LogTopic* status = log.find("vehicle_status");
  if (status == nullptr || !status->time) return;
  const LogField* mode = status->find("nav_state");
  const LogField* arming = status->find("arming_state");
  double last_mode = -1.0;
  int last_armed = -1;
  for (std::size_t i = 0; i < status->size(); ++i) {
    const double time = (*status->time)[i];
    if (mode != nullptr && !mode->values.is_text() && mode->value(i) != last_mode) {
      last_mode = mode->value(i);
      const auto found = modes.find(static_cast<int>(std::clamp(last_mode, -1.0, 1e6)));
      log.events.push_back({time, "mode", found == modes.end() ? fmt::format("{:.0f}", last_mode) : found->second});
    }
    if (arming != nullptr && !arming->values.is_text()) {
      const int armed = arming->value(i) == 2.0 ? 1 : 0;
      if (armed != last_armed) log.events.push_back({time, "armed", armed == 1 ? "armed" : "disarmed"});
      last_armed = armed;
    }
  }
}

}  // namespace veridyn::io
