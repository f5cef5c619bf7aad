#include "veridyn/aircraft/identification/options/open_loop_options.hpp"

#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

const KeyTable<OpenLoopOptions>& OpenLoopOptions::keys() {
  using O = OpenLoopOptions;
  static const auto table =
      KeyTable<O>("validate")
          .with(OpenLoopTimes::keys())
          .choices("open_loop_offsets", &O::offsets, choices_of<Coefficient>(kCoefficientNames),
                   "coefficients with a constant of their own in each window, estimated with the initial state")
          .flag("open_loop_gusts", &O::gusts, "the reconstructed gust is an input; `false` says that the air was calm")
          .otherwise("`true` with a ground velocity, against which a gust can be told from motion");
  return table;
}

}  // namespace veridyn::aircraft
