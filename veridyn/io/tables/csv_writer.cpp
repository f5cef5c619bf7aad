#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "veridyn/core/files.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/io/tables/csv_text.hpp"

namespace veridyn::io {
namespace {

bool same_base(const TimeBase& a, const TimeBase& b) { return a == b || (a && b && *a == *b); }

/// Rows of the file: every stamp of any base, as often as the base that repeats it most.
std::vector<double> join(const std::vector<TimeBase>& bases) {
  std::vector<double> rows;
  for (const TimeBase& base : bases) {
    std::vector<double> merged;
    merged.reserve(rows.size() + base->size());
    // The union of sorted multisets keeps max(m, n) copies of a stamp, which is what is wanted.
    std::set_union(rows.begin(), rows.end(), base->begin(), base->end(), std::back_inserter(merged));
    rows = std::move(merged);
  }
  return rows;
}

}  // namespace

std::string to_csv(const Recording& recording) {
  std::vector<TimeBase> bases;
  std::vector<std::size_t> base_of;
  for (const Channel& channel : recording.channels()) {
    const TimeBase time = channel.time ? channel.time : make_time_base({});
    const auto found =
        std::find_if(bases.begin(), bases.end(), [&](const TimeBase& base) { return same_base(base, time); });
    base_of.push_back(at(found - bases.begin()));
    if (found == bases.end()) bases.push_back(time);
  }
  const std::vector<double> rows = join(bases);

  fmt::memory_buffer out;
  const auto to = std::back_inserter(out);
  if (recording.frame == Frame::kFrd) fmt::format_to(to, "# frame: frd\n");
  if (recording.frame == Frame::kFlu) fmt::format_to(to, "# frame: flu\n");
  fmt::format_to(to, "time[s]");
  for (const Channel& channel : recording.channels()) {
    fmt::format_to(to, ",{}", csv_text(fmt::format("{}[{}]", channel.name, channel.unit.si_name())));
  }
  out.push_back('\n');
  std::vector<std::size_t> next(bases.size(), 0);
  std::vector<bool> here(bases.size(), false);
  for (const double stamp : rows) {
    for (std::size_t k = 0; k < bases.size(); ++k)
      here[k] = next[k] < bases[k]->size() && (*bases[k])[next[k]] == stamp;
    fmt::format_to(to, "{}", stamp);
    for (std::size_t i = 0; i < base_of.size(); ++i) {
      out.push_back(',');
      const std::size_t k = base_of[i];
      if (!here[k]) continue;
      const double value = recording.channels()[i].value[next[k]];
      if (std::isfinite(value)) fmt::format_to(to, "{}", value);
    }
    out.push_back('\n');
    for (std::size_t k = 0; k < bases.size(); ++k) next[k] += here[k] ? 1U : 0U;
  }
  return fmt::to_string(out);
}

void write_csv(const Recording& recording, const std::filesystem::path& path) { write_file(path, to_csv(recording)); }

}  // namespace veridyn::io
