#include "veridyn/muscle/path/path_functions.hpp"

#include <fmt/format.h>

#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::muscle {

std::vector<int> PathFunctions::add(const Model& model, int muscle, std::size_t first_pair) {
  const Muscle& of = model.muscles[muscle];
  const PathFunction& function = *of.function;
  const auto* polynomial = std::get_if<numerics::MultivariatePolynomial>(&function.length);
  const std::size_t arguments = polynomial != nullptr ? at(polynomial->arguments()) : 1;
  if (function.coordinates.size() != arguments)
    throw InputError(model.name, fmt::format("muscle {}: its length is a function of {}, and it has {} coordinates",
                                             of.name(), arguments, function.coordinates.size()));
  std::vector<int> ascending = function.coordinates;
  std::sort(ascending.begin(), ascending.end());
  if (std::adjacent_find(ascending.begin(), ascending.end()) != ascending.end() ||
      (!ascending.empty() && (ascending.front() < 0 || at(ascending.back()) >= model.coordinates.size())))
    throw InputError(model.name,
                     fmt::format("muscle {}: the arguments of its length must be different coordinates", of.name()));
  Entry entry{.muscle = muscle, .arguments = {}, .function = function.length};
  for (const int c : function.coordinates) {
    const auto place = std::lower_bound(ascending.begin(), ascending.end(), c) - ascending.begin();
    const Coordinate& k = model.coordinates[c];
    entry.arguments.push_back({c, first_pair + static_cast<std::size_t>(place), k.low, k.high});
  }
  entries_.push_back(std::move(entry));
  return ascending;
}

void PathFunctions::move_pairs(std::span<const std::size_t> place) {
  for (Entry& entry : entries_)
    for (Argument& argument : entry.arguments) argument.pair = place[argument.pair];
}

int PathFunctions::terms(int muscle) const {
  for (const Entry& entry : entries_)
    if (const auto* p = std::get_if<numerics::MultivariatePolynomial>(&entry.function); entry.muscle == muscle && p)
      return static_cast<int>(p->coefficients().size());
  return 0;
}

}  // namespace veridyn::muscle
