#include "veridyn/aircraft/reconstruction/filter_engine_of.hpp"

namespace veridyn::aircraft::internal {

std::unique_ptr<FilterEngine> model_free_engine(bool imu_errors) {
  if (imu_errors) return std::make_unique<EngineOf<AirDataModel<true>>>();
  return std::make_unique<EngineOf<AirDataModel<false>>>();
}

}  // namespace veridyn::aircraft::internal
