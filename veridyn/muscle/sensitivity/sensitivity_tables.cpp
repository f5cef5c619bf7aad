#include "veridyn/muscle/sensitivity/sensitivity_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/index.hpp"
#include "veridyn/io/tables/csv_text.hpp"

namespace veridyn::muscle {
namespace {

std::string joined(const std::vector<std::string>& texts, const char* between) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : between) + text;
  return all;
}

bool contains(const std::optional<TaskSet>& set, std::size_t task) {
  return set && std::binary_search(set->tasks.begin(), set->tasks.end(), task);
}

}  // namespace

std::string sensitivity_csv(const MuscleSensitivity& s) {
  std::string text = "task,muscle,mean_nrmse,sd_nrmse,greatest_nrmse,samples,failed\n";
  for (std::size_t t = 0; t < s.tasks.size(); ++t) {
    for (std::size_t m = 0; m < s.muscles.size(); ++m) {
      const auto i = signed_index(m), j = signed_index(t);
      text += fmt::format("{},{},{},{},{},{},{}\n", io::csv_text(s.tasks[t].name), io::csv_text(s.muscles[m]),
                          io::csv_number(s.sampling.mean(i, j)), io::csv_number(s.sampling.sd(i, j)),
                          io::csv_number(s.sampling.greatest(i, j)), s.sampling.samples, s.sampling.failed(i, j));
    }
  }
  return text;
}

std::string task_choice_csv(const MuscleSensitivity& s, std::span<const PreparedTask> tasks) {
  std::string text =
      "task,chosen,runner_up,excites,obstacle,wrap_bands,failed,tracking_error[rad],reserve_share,overloaded_windows\n";
  for (std::size_t t = 0; t < s.tasks.size(); ++t) {
    const TaskFinding& f = s.tasks[t];
    std::vector<std::string> excited;
    for (const std::size_t m : s.cover.excites[t]) excited.push_back(s.muscles[m]);
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{}\n", io::csv_text(f.name), contains(s.cover.chosen, t) ? "yes" : "no",
                    contains(s.cover.runner_up, t) ? "yes" : "no", joined(excited, " "), io::csv_text(f.obstacle),
                    io::csv_text(joined(f.wrap_bands, "; ")), f.failed, io::csv_number(tasks[t].tracking_error),
                    io::csv_number(tasks[t].reserve_share), tasks[t].overloaded);
  }
  return text;
}

std::string task_list(const MuscleSensitivity& s, const TaskSet& set) {
  std::vector<std::string> names;
  for (const std::size_t t : set.tasks)
    names.push_back(s.tasks[t].number > 0 ? fmt::format("{}", s.tasks[t].number)
                                          : fmt::format("\"{}\"", s.tasks[t].name));
  return joined(names, ", ");
}

}  // namespace veridyn::muscle
