#include <fmt/format.h>

#include <cmath>
#include <map>

#include "veridyn/io/dataflash/dataflash_schema.hpp"

namespace veridyn::io {
namespace {

// Mode numbers of ArduPlane/mode.h and ArduCopter/mode.h.
const char* mode_name(const std::string& vehicle, int number) {
  static const std::map<int, const char*> plane{
      {0, "MANUAL"},        {1, "CIRCLE"},      {2, "STABILIZE"}, {3, "TRAINING"},    {4, "ACRO"},
      {5, "FBWA"},          {6, "FBWB"},        {7, "CRUISE"},    {8, "AUTOTUNE"},    {10, "AUTO"},
      {11, "RTL"},          {12, "LOITER"},     {13, "TAKEOFF"},  {14, "AVOID_ADSB"}, {15, "GUIDED"},
      {16, "INITIALISING"}, {17, "QSTABILIZE"}, {18, "QHOVER"},   {19, "QLOITER"},    {20, "QLAND"},
      {21, "QRTL"},         {22, "QAUTOTUNE"},  {23, "QACRO"},    {24, "THERMAL"},    {25, "LOITER_ALT_QLAND"},
      {26, "AUTOLAND"}};
  static const std::map<int, const char*> copter{
      {0, "STABILIZE"},  {1, "ACRO"},      {2, "ALT_HOLD"}, {3, "AUTO"},    {4, "GUIDED"},      {5, "LOITER"},
      {6, "RTL"},        {7, "CIRCLE"},    {9, "LAND"},     {11, "DRIFT"},  {13, "SPORT"},      {14, "FLIP"},
      {15, "AUTOTUNE"},  {16, "POSHOLD"},  {17, "BRAKE"},   {18, "THROW"},  {19, "AVOID_ADSB"}, {20, "GUIDED_NOGPS"},
      {21, "SMART_RTL"}, {22, "FLOWHOLD"}, {23, "FOLLOW"},  {24, "ZIGZAG"}, {25, "SYSTEMID"}};
  const auto& modes = vehicle == "ArduCopter" ? copter : plane;
  if (vehicle != "ArduCopter" && vehicle != "ArduPlane") return nullptr;
  const auto found = modes.find(number);
  return found == modes.end() ? nullptr : found->second;
}

void read_parameters(Log& log, const LogTopic& topic) {
  const LogField* name = topic.find("Name");
  const LogField* value = topic.find("Value");
  const LogField* standard = topic.find("Default");
  if (name == nullptr || value == nullptr || !name->values.is_text() || value->values.is_text()) return;
  for (std::size_t i = 0; i < topic.size(); ++i) {
    const std::string key = internal::printable(name->values.text(i));
    if (key.empty()) continue;
    log.parameters[key] = value->value(i);
    if (standard != nullptr && !standard->values.is_text()) log.default_parameters[key] = standard->value(i);
  }
}

void read_messages(Log& log, const LogTopic& topic) {
  const LogField* text = topic.find("Message");
  if (text == nullptr) text = topic.find("Msg");
  if (text == nullptr || !text->values.is_text()) return;
  for (std::size_t i = 0; i < topic.size(); ++i) {
    const std::string message = internal::printable(text->values.text(i));
    log.events.push_back({(*topic.time)[i], "message", message});
    for (const char* vehicle :
         {"ArduPlane", "ArduCopter", "ArduRover", "Rover", "ArduSub", "Blimp", "AntennaTracker"}) {
      if (message.rfind(vehicle, 0) == 0 && message.find(" V") != std::string::npos) {
        log.information.emplace("vehicle", vehicle);
        log.information.emplace("firmware", message);
      }
    }
  }
}

void read_modes(Log& log, const LogTopic& topic) {
  const LogField* number = topic.find("ModeNum");
  const LogField* mode = topic.find("Mode");
  if (mode == nullptr) return;
  const auto vehicle = log.information.find("vehicle");
  for (std::size_t i = 0; i < topic.size(); ++i) {
    std::string text;
    if (mode->values.is_text()) {
      text = internal::printable(mode->values.text(i));
    } else {
      const double value = number != nullptr ? number->value(i) : mode->value(i);
      const int code = std::isfinite(value) ? static_cast<int>(value) : -1;
      const char* known = vehicle == log.information.end() ? nullptr : mode_name(vehicle->second, code);
      text = known != nullptr ? known : fmt::format("{}", code);
    }
    log.events.push_back({(*topic.time)[i], "mode", text});
  }
}

void read_armed(Log& log, const LogTopic& topic, const char* field) {
  const LogField* armed = topic.find(field);
  if (armed == nullptr || armed->values.is_text()) return;
  double last = -1.0;
  for (std::size_t i = 0; i < topic.size(); ++i) {
    const double state = armed->value(i) > 0.0 ? 1.0 : 0.0;
    if (state != last) log.events.push_back({(*topic.time)[i], "armed", state > 0.0 ? "armed" : "disarmed"});
    last = state;
  }
}

void read_armed_events(Log& log, const LogTopic& topic) {
  const LogField* id = topic.find("Id");
  if (id == nullptr || id->values.is_text()) return;
  for (std::size_t i = 0; i < topic.size(); ++i) {
    // AP_Logger LogEvent: ARMED 10, DISARMED 11.
    if (id->value(i) == 10.0) log.events.push_back({(*topic.time)[i], "armed", "armed"});
    if (id->value(i) == 11.0) log.events.push_back({(*topic.time)[i], "armed", "disarmed"});
  }
}

void read_errors(Log& log, const LogTopic& topic) {
  const LogField* subsystem = topic.find("Subsys");
  const LogField* code = topic.find("ECode");
  if (subsystem == nullptr || code == nullptr) return;
  for (std::size_t i = 0; i < topic.size(); ++i) {
    log.events.push_back(
        {(*topic.time)[i], "error", fmt::format("subsystem {:.0f}, code {:.0f}", subsystem->value(i), code->value(i))});
  }
}

}  // namespace

void read_dataflash_events(Log& log) {
  for (LogTopic& topic : log.topics) {
    const std::string& name = topic.name;
    topic.schema = name == "FMT" || name == "FMTU" || name == "UNIT" || name == "MULT" || name == "PARM" ||
                   name == "MSG" || name == "FILE" || name == "VER";
    if (name == "PARM") read_parameters(log, topic);
    if (name == "MSG") read_messages(log, topic);
  }
  bool reported = false;  // several messages report arming: the most direct one is used
  for (const char* source : {"ARM", "EV", "STAT"}) {
    if (reported) break;
    for (const LogTopic& topic : log.topics) {
      if (topic.name != source) continue;
      const std::size_t before = log.events.size();
      if (topic.name == "ARM") read_armed(log, topic, "ArmState");
      if (topic.name == "EV") read_armed_events(log, topic);
      if (topic.name == "STAT") read_armed(log, topic, "Armed");
      reported = reported || log.events.size() > before;
    }
  }
  for (const LogTopic& topic : log.topics) {
    if (topic.name == "MODE") read_modes(log, topic);
    if (topic.name == "ERR") read_errors(log, topic);
    if (topic.name == "VER") {
      if (const LogField* text = topic.find("FWS"); text != nullptr && text->values.is_text() && topic.size() > 0) {
        log.information.emplace("firmware", internal::printable(text->values.text(0)));
      }
    }
  }
}

}  // namespace veridyn::io
