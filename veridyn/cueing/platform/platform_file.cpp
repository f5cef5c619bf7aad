#include "veridyn/cueing/platform/platform_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "veridyn/core/error.hpp"

namespace veridyn::cueing {
namespace {

/// As short as reads back to the same number, and a number of TOML.
std::string number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string list(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(number(value));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string places(const std::vector<Eigen::Vector3d>& all) {
  std::vector<double> values;
  for (const Eigen::Vector3d& p : all) values.insert(values.end(), {p.x(), p.y(), p.z()});
  return list(values);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> platform_keys(const Platform& p) {
  std::vector<std::pair<std::string, std::string>> keys;
  const auto add = [&](const std::string& key, const std::string& value) { keys.emplace_back(key, value); };
  const auto follows = [&](const std::string& before, const ActuatorOptions& a) {
    add(before + "omega", number(a.omega));
    add(before + "zeta", number(a.zeta));
    add(before + "delay", number(a.delay));
  };
  add("name", fmt::format("\"{}\"", p.name));
  follows("", p.actuators);
  for (const PlatformAxis axis : kAllPlatformAxes) {
    const std::string name(name_of(axis));
    if (const AxisLimits& l = p.limits[axis]; l.moves()) {
      add(name, list({l.lowest, l.highest}));
      add(name + "_rate", number(l.rate));
      add(name + "_acceleration", number(l.acceleration));
      add(name + "_jerk", number(l.jerk));
    }
    if (p.axis_actuators[axis]) follows(name + "_", *p.axis_actuators[axis]);
    if (!p.reach[axis].empty()) {
      add(name + "_commanded", list(p.reach[axis].commanded));
      add(name + "_reached", list(p.reach[axis].reached));
    }
  }
  if (p.legs) {
    add("feet", places(p.legs->feet));
    add("heads", places(p.legs->heads));
    add("leg_stroke", list({p.legs->leg.lowest, p.legs->leg.highest}));
    add("leg_rate", number(p.legs->leg.rate));
    add("leg_acceleration", number(p.legs->leg.acceleration));
    add("leg_jerk", number(p.legs->leg.jerk));
  }
  add("rider", list({p.rider.x(), p.rider.y(), p.rider.z()}));
  return keys;
}

std::string platform_file(const Platform& platform, const std::string& comment) {
  std::string text = comment.empty() ? "" : "# " + comment + "\n";
  text += "[platform]\n";
  for (const auto& [key, value] : platform_keys(platform)) text += fmt::format("{} = {}\n", key, value);
  return text;
}

Platform read_platform_file(const std::filesystem::path& path) {
  const Study study = Study::load(path);
  if (!study.root().has("platform")) throw InputError(path.string(), "has no table [platform]");
  const StudyTable table = study.root().table("platform");
  if (table.has("file")) table.fail("file", "names a further file; the numbers have to be in this one");
  Platform platform = Platform::read(table);
  study.root().finish();
  return platform;
}

}  // namespace veridyn::cueing
