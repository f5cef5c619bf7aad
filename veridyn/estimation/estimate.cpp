#include "veridyn/estimation/estimate.hpp"

#include <algorithm>

namespace veridyn::estimation {

const EstimatedParameter* Estimate::find(std::string_view name) const {
  const auto found =
      std::find_if(parameters.begin(), parameters.end(), [&](const EstimatedParameter& p) { return p.name == name; });
  return found == parameters.end() ? nullptr : &*found;
}

}  // namespace veridyn::estimation
