#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::estimation {

const Parameter* Estimate::find(std::string_view name) const { return find_parameter(parameters, name); }

std::string sentence_of(const Estimate& estimate) {
  return (estimate.interrupted ? "Interrupted: this is the best estimate found by then. " : "") +
         sentence_of(estimate.judgement);
}

}  // namespace veridyn::estimation
