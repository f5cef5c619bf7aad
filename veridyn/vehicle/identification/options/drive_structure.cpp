#include "veridyn/vehicle/identification/options/drive_structure.hpp"

#include <fmt/format.h>

namespace veridyn::vehicle {

std::string name_of(DriveStructure structure, const DriveEffects& effects) {
  std::string name(to_string(structure));
  for (const DriveEffect effect : kAllDriveEffects)
    if (effects[effect]) name += fmt::format(", {}", kDriveEffectNames[effect]);
  return name;
}

}  // namespace veridyn::vehicle
