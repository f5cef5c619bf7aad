#include "veridyn/vehicle/model/four_wheel_model.hpp"

#include <fmt/format.h>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {

void FourWheelOptions::validate() const {
  constexpr double kMost = 1e6;  // of anything here: infinity is not meant
  const auto require = [](bool well, const char* name, double value, const char* rule) {
    if (!well) throw InputError("vehicle", fmt::format("{} is {:g}; must be {}", name, value, rule));
  };
  require(gravity >= 0.0 && gravity < kMost, "gravity", gravity, ">= 0");
  require(ackermann >= 0.0 && ackermann <= 1.0, "ackermann", ackermann, "between 0 (parallel) and 1");
  require(camber_per_roll >= -10.0 && camber_per_roll <= 10.0, "camber_per_roll", camber_per_roll,
          "between -10 and 10");
  require(relaxation_length >= 0.0 && relaxation_length < kMost, "relaxation_length", relaxation_length, ">= 0");
  if (!longitudinal) return;
  if (const std::string why = inadmissible(*longitudinal); !why.empty()) throw InputError("vehicle", why);
}

}  // namespace veridyn::vehicle
