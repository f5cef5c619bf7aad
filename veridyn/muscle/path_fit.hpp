#pragma once
#include "veridyn/muscle/muscle_path.hpp"
namespace veridyn::muscle {
class PathFit {
 public:
  PathFit(const Model&, const Mechanism&, const MusclePaths&) {}
  template <typename Scalar>
  void evaluate(const Scalar*, Scalar*, Scalar*) const {}
  std::vector<std::string> notes() const { return {}; }
};
}  // namespace veridyn::muscle
