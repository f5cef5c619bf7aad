#include "veridyn/muscle/path/pose_text.hpp"

#include <fmt/format.h>

#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {

std::string pose_text(const Model& model, const MusclePaths& paths, int muscle, const Eigen::VectorXd& q) {
  std::string text;
  for (std::size_t k = paths.first_pair(muscle); k < paths.end_pair(muscle); ++k) {
    const int index = paths.pairs()[k].coordinate;
    const Coordinate& c = model.coordinates[index];
    const bool angle = c.motion == CoordinateMotion::kRotational;
    text += fmt::format("{}{} = {:.4g} {}", text.empty() ? "" : ", ", c.name, q(index) / (angle ? kDegree : 1.0),
                        angle ? "deg" : c.unit());
  }
  return text.empty() ? "which does not move it" : text;
}

}  // namespace veridyn::muscle
