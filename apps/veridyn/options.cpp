#include "apps/veridyn/options.hpp"

#include <fmt/format.h>

#include "veridyn/numerics/parallel.hpp"

namespace veridyn::app {

void add_common(CLI::App& verb, CommonOptions& options, const std::string& default_out, const std::string& example) {
  options.out = default_out;
  verb.add_option("--out", options.out, "folder of the results")->capture_default_str()->type_name("DIR");
  verb.add_option("--set", options.overrides, "override one key of the study: --set data.from=120 (repeatable)")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  verb.add_option("--seed", options.seed, "seed of all random numbers (key `seed` of the study)")->type_name("N");
  verb.add_option("--threads", options.threads, "threads to use; 0: all. Results do not depend on it")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber)
      ->type_name("N");
  verb.add_flag("--quiet", options.quiet, "no progress, only errors");
  verb.add_flag("--json", options.json, "a machine-readable summary on stdout");
  verb.footer("Example:\n  " + example);
}

Study load_study(const std::string& path, const CommonOptions& options) {
  numerics::set_default_threads(options.threads);
  std::vector<std::string> overrides = options.overrides;
  if (options.seed) overrides.push_back(fmt::format("seed={}", *options.seed));
  return Study::load(path, overrides);
}

}  // namespace veridyn::app
