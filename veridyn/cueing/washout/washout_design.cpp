#include "veridyn/cueing/washout/washout_design.hpp"

#include <fmt/format.h>

#include <array>
#include <string>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/cueing/washout/classical_washout.hpp"

namespace veridyn::cueing {
namespace {

template <typename Design>
std::unique_ptr<WashoutDesign> design() {
  return std::make_unique<Design>();
}

/// A new algorithm is a line here.
constexpr std::array kAlgorithms = {
    WashoutAlgorithm{"classical", "filters and tilt coordination (Reid & Nahon 1985)", &design<ClassicalDesign>},
};

}  // namespace

std::span<const WashoutAlgorithm> washout_algorithms() { return kAlgorithms; }

const WashoutAlgorithm& washout_algorithm(std::string_view name) {
  std::vector<std::string> names;
  for (const WashoutAlgorithm& a : kAlgorithms) {
    if (a.name == name) return a;
    names.emplace_back(a.name);
  }
  throw InputError("washout", fmt::format("there is no algorithm '{}'{}", name, suggestion(name, names)));
}

}  // namespace veridyn::cueing
