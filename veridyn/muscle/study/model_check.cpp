#include "veridyn/muscle/study/model_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "veridyn/core/error.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"

namespace veridyn::muscle {

ModelCheck check_model(const std::filesystem::path& file, Progress& progress, double duration) {
  ModelCheck check;
  check.file = file;
  try {
    Model model = read_osim(file);
    check.loads = true;
    check.version = model.version;
    check.bodies = model.bodies.size() - 1;
    check.coordinates = model.coordinates.size();
    check.muscles = model.muscles.size();
    check.warnings = model.warnings.size();
    for (const UnsupportedElement& u : model.unsupported)
      check.missing.push_back(fmt::format("{} '{}'", u.element, u.name));
    const MusculoskeletalSystem system(std::move(model));
    const MuscleTrajectory t = simulate_forward(
        system, default_start(system.model()), {ControlSignals(std::vector<double>(system.muscles().size(), 0.05)), {}},
        {.end = duration, .rate_Hz = 50.0, .accuracy = 1e-3, .max_steps = 50000}, progress);
    check.simulates = t.usable();
    if (!t.usable()) check.trouble = t.message();
  } catch (const InputError& error) {
    check.trouble = error.what();
  }
  return check;
}

std::vector<std::filesystem::path> model_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  const auto options = std::filesystem::directory_options::skip_permission_denied;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, options))
    if (entry.is_regular_file() && entry.path().extension() == ".osim") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string model_check_table(std::span<const ModelCheck> checks, const std::filesystem::path& folder) {
  std::size_t width = 4, loads = 0, simulates = 0;
  const auto name = [&](const ModelCheck& c) { return c.file.lexically_relative(folder).string(); };
  for (const ModelCheck& c : checks) {
    width = std::max(width, name(c).size());
    loads += c.loads ? 1 : 0;
    simulates += c.simulates ? 1 : 0;
  }
  std::string text = fmt::format("{:<{}} {:>6} {:>6} {:>6} {:>7}  {:<5} {:<9} {:>8}  what is missing\n", "file", width,
                                 "format", "bodies", "coord.", "muscles", "loads", "simulates", "warnings");
  for (const ModelCheck& c : checks) {
    std::string missing = fmt::format("{}", fmt::join(c.missing, ", "));
    if (!c.trouble.empty()) missing += (missing.empty() ? "" : "; ") + c.trouble;
    text +=
        fmt::format("{:<{}} {:>6} {:>6} {:>6} {:>7}  {:<5} {:<9} {:>8}  {}\n", name(c), width, c.version, c.bodies,
                    c.coordinates, c.muscles, c.loads ? "yes" : "no", c.simulates ? "yes" : "no", c.warnings, missing);
  }
  text +=
      fmt::format("{} model{}: {} load, {} simulate\n", checks.size(), checks.size() == 1 ? "" : "s", loads, simulates);
  return text;
}

}  // namespace veridyn::muscle
