#include "veridyn/vehicle/model/four_wheel_options.hpp"

#include <fmt/format.h>

#include <string>

#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {

void FourWheelOptions::validate() const {
  constexpr double kLargestNumber = 1e6;  // of anything here: infinity is not meant
  const auto require = [](bool well, const char* name, double value, const char* rule) {
    if (!well) throw InputError("vehicle", fmt::format("{} is {:g}; must be {}", name, value, rule));
  };
  require(gravity >= 0.0 && gravity < kLargestNumber, "gravity", gravity, ">= 0");
  require(ackermann >= 0.0 && ackermann <= 1.0, "ackermann", ackermann, "between 0 (parallel) and 1");
  require(camber_per_roll >= -10.0 && camber_per_roll <= 10.0, "camber_per_roll", camber_per_roll,
          "between -10 and 10");
  require(relaxation_length >= 0.0 && relaxation_length < kLargestNumber, "relaxation_length", relaxation_length,
          ">= 0");
  for (const std::string& why :
       {inadmissible(suspension_f, 'f'), inadmissible(suspension_r, 'r'), inadmissible(lift)}) {
    if (!why.empty()) throw InputError("vehicle", why);
  }
  if (convention == FourWheelConvention::kSource) {
    const auto plain = [](const AxleSuspension& axle) { return axle.roll_centre == 0.0 && !axle.steers(); };
    if (!plain(suspension_f) || !plain(suspension_r) || lift.acts() || aligning_moment) {
      throw InputError("vehicle",
                       "the source's convention has no roll centres, no steer by the suspension, no lift and no "
                       "aligning moments; they need convention = \"first principles\"");
    }
  }
  if (!longitudinal) return;
  if (const std::string why = inadmissible(*longitudinal); !why.empty()) throw InputError("vehicle", why);
}

}  // namespace veridyn::vehicle
