#pragma once

#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/model/external_load.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// In whose axes reactions are expressed: the ground's, or those of the joint's frame in its parent or child body.
enum class ReactionFrame { kGround, kParent, kChild };

/// What each joint transmits: force [N] on its child body, and moment [N m] about the origin of the joint's frame in
/// the child. Rows are instants; three columns a joint.
struct JointReactions {
  std::vector<int> joints;  ///< of the model: all, welded ones too
  estimation::RowMatrix force, moment;
};

/// View of a motion and the forces that make it, which must outlive it: rows are instants.
struct MovedModel {
  const std::vector<double>& time;
  const estimation::RowMatrix& q;
  const estimation::RowMatrix& qdot;
  const estimation::RowMatrix& qddot;         ///< empty: what the forces give
  const estimation::RowMatrix& tendon_force;  ///< by muscle [N]; empty: muscles do not act
  const estimation::RowMatrix& reserve;       ///< by coordinate [N m or N]; empty: none
  const ExternalLoads* external = nullptr;
  bool passive = true;  ///< whether the model's springs, contacts and passive paths act
};

/// Reactions by recursive Newton-Euler with the tensions of muscles where they pull: at the points of their paths and
/// on their wrap objects. Paths by functions of coordinates pull at no place: of them reactions have the moments, as
/// of reserves, and not what they press the bones together with (`paths_without_place`). As cutting a joint would show,
/// they have the moments of reserves, of coordinate forces and of couplers at the joint with them. Where nothing of the
/// kind acts along a coordinate of the joint, no muscle has a moving point and constraints are met, the reaction does
/// no work along it. Constraints that close loops pull too: of a given motion with what its forces lack across the
/// motions that the loops allow. Where muscles and reserves balance along these, that is all they lack, and reactions
/// are those of a forward simulation; without muscles they are of the least generalised forces, as in `analyse_motion`.
/// Equations of loops that repeat others carry nothing: where there are such, reactions are one of many that give the
/// motion.
[[nodiscard]] JointReactions joint_reactions(const MusculoskeletalSystem& system, const MovedModel& moved,
                                             ReactionFrame frame);

/// Names of muscles and passive paths that are given as functions of coordinates.
[[nodiscard]] std::vector<std::string> paths_without_place(const MusculoskeletalSystem& system);

}  // namespace veridyn::muscle
