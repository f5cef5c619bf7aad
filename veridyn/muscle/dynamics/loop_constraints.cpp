#include "veridyn/muscle/dynamics/loop_constraints.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

int rows_of(LoopKind kind) {
  switch (kind) {
    case LoopKind::kPoint:
      return 3;
    case LoopKind::kWeld:
      return 6;
    case LoopKind::kDistance:
      return 1;
    case LoopKind::kPointOnLine:
      break;
  }
  return 2;
}

/// Coordinates that move `link` but not `other`.
std::vector<int> beyond(const Mechanism& mechanism, int link, int other) {
  std::vector<int> coordinates;
  for (const int c : mechanism.ancestors(link))
    if (!mechanism.moves(c, other)) coordinates.push_back(c);
  return coordinates;
}

}  // namespace

std::string loop_text(const LoopConstraint& constraint) {
  const char* kind = "PointConstraint";
  if (constraint.kind == LoopKind::kWeld) kind = "WeldConstraint";
  if (constraint.kind == LoopKind::kDistance) kind = "ConstantDistanceConstraint";
  if (constraint.kind == LoopKind::kPointOnLine) kind = "PointOnLineConstraint";
  return fmt::format("{} '{}'", kind, constraint.name);
}

void LoopConstraints::check_at_rest(const Constraint& constraint, const Mechanism& mechanism) {
  const std::vector<double> zero(mechanism.coordinates(), 0.0);
  Kinematics<double> kinematics(mechanism);
  update_positions(mechanism, zero.data(), kinematics);
  std::vector<LoopRow<double>> rows(constraint.rows);
  evaluate(constraint, kinematics, rows.data());
  for (const LoopRow<double>& row : rows) {
    constexpr double kHolds = 1e-6;
    if (!(std::abs(row.error) < kHolds))
      throw InputError(constraint.text, fmt::format("its bodies are welded to each other {:.3g} away from where it "
                                                    "would hold them",
                                                    std::abs(row.error)));
  }
}

LoopConstraints::LoopConstraints(const Model& model, const Mechanism& mechanism) {
  for (int c = 0; c < mechanism.coordinates(); ++c) coordinate_link_.push_back(mechanism.link_of_coordinate(c));
  for (const LoopConstraint& from : model.loops) {
    const Mechanism::BodyPlace &one = mechanism.body(from.body_1), &two = mechanism.body(from.body_2);
    if (from.kind == LoopKind::kDistance && !(from.distance > 0.0))
      throw InputError(loop_text(from), fmt::format("its distance, {} m, must be > 0", from.distance));
    Constraint made{
        loop_text(from), from.kind, one.link,          two.link, one.in_link * from.frame_1, two.in_link * from.frame_2,
        from.distance,   rows(),    rows_of(from.kind)};
    if (one.link == two.link) {
      check_at_rest(made, mechanism);  // of bodies that are one it holds already
      continue;
    }
    row_constraint_.insert(row_constraint_.end(), at(made.rows), static_cast<int>(constraints_.size()));
    moving_1_.push_back(beyond(mechanism, one.link, two.link));
    moving_2_.push_back(beyond(mechanism, two.link, one.link));
    constraints_.push_back(std::move(made));
  }
}

}  // namespace veridyn::muscle
