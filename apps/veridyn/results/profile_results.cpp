// What identifications with profile likelihood write and print of it, for every domain.
#include "apps/veridyn/results/profile_results.hpp"

#include <fmt/format.h>

#include <string>

#include "veridyn/io/tables/csv_text.hpp"

namespace veridyn::app {
namespace {

std::string profiles_csv(const estimation::ProfileResult& profiles, std::span<const estimation::Parameter> parameters) {
  std::string text = "parameter,unit,value,likelihood_ratio";
  for (const estimation::Parameter& p : parameters) text += "," + io::csv_text(p.name);
  text += "\n";
  for (const estimation::ParameterProfile& profile : profiles.profiles) {
    for (const estimation::ProfilePoint& point : profile.points) {
      text += fmt::format("{},{},{},{}", io::csv_text(profile.name), io::csv_text(profile.unit),
                          io::csv_number(point.value), io::csv_number(point.statistic));
      for (const double value : point.theta) text += "," + io::csv_number(value);
      text += "\n";
    }
  }
  return text;
}

std::string profile_intervals_csv(const estimation::ProfileResult& profiles) {
  std::string text = "parameter,unit,value,low95,high95,low_end,high_end\n";
  for (const estimation::ParameterProfile& p : profiles.profiles) {
    text += fmt::format("{},{},{},{},{},{},{}\n", io::csv_text(p.name), io::csv_text(p.unit), io::csv_number(p.value),
                        io::csv_number(p.low), io::csv_number(p.high), to_string(p.low_end), to_string(p.high_end));
  }
  return text;
}

}  // namespace

void write_profiles(OutputFolder& folder, const estimation::ProfileResult& profiles,
                    std::span<const estimation::Parameter> parameters) {
  if (profiles.profiles.empty()) return;
  folder.write("profiles.csv", profiles_csv(profiles, parameters));
  folder.write("profile_intervals.csv", profile_intervals_csv(profiles));
}

Summary profiles_summary(const estimation::ProfileResult& profiles) {
  Summary s = Summary::object();
  for (const estimation::ParameterProfile& p : profiles.profiles) {
    Summary& one = s[p.name];
    one["low95"] = p.low;
    one["high95"] = p.high;
    one["low_end"] = to_string(p.low_end);
    one["high_end"] = to_string(p.high_end);
  }
  return s;
}

std::vector<std::string> profile_lines(const estimation::ProfileResult& profiles) {
  std::vector<std::string> lines;
  if (!profiles.message.empty()) lines.push_back("warning: " + profiles.message);
  for (const estimation::ParameterProfile& p : profiles.profiles)
    lines.push_back(fmt::format("  profile      {}: {} {}", p.name, p.text(), p.unit));
  return lines;
}

}  // namespace veridyn::app
