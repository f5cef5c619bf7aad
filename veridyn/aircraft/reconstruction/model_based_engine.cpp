#include "veridyn/aircraft/reconstruction/filter_engine_of.hpp"

namespace veridyn::aircraft::internal {

std::unique_ptr<FilterEngine> model_based_engine(bool imu_errors) {
  if (imu_errors) return std::make_unique<EngineOf<ModelBasedAirData<true>>>();
  return std::make_unique<EngineOf<ModelBasedAirData<false>>>();
}

}  // namespace veridyn::aircraft::internal
