#include "veridyn/numerics/batches/process_share.hpp"

#include <algorithm>
#include <numeric>

namespace veridyn::numerics {

std::vector<std::size_t> ProcessShare::own_first(std::size_t items) const {
  std::vector<std::size_t> order(items);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_partition(order.begin(), order.end(), [this](std::size_t item) { return computes(item); });
  return order;
}

}  // namespace veridyn::numerics
