#include "veridyn/cueing/perception/felt_pair.hpp"

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::cueing {

FeltPair felt_pair(const VestibularModel& model, const MotionThresholds& thresholds, Eigen::Index pair, bool shifts,
                   double height) {
  using numerics::StateSpace;
  constexpr Eigen::Index kOtoliths = FeltPair::kOtolithStates, kCanals = FeltPair::kFeltStates - kOtoliths;
  const StateSpace otoliths = numerics::realise(model.otoliths), canal = numerics::realise(model.canals[pair]);
  if (otoliths.states() != kOtoliths || canal.states() != kCanals || otoliths.D(0, 0) != 0.0 || canal.D(0, 0) != 0.0)
    throw InputError("perception",
                     "a plan takes otoliths of second and canals of third order, as those of \"young_meiry\"");
  FeltPair felt;
  StateSpace& s = felt.system;
  const Eigen::Index n = shifts ? 9 : 7;
  s.A.setZero(n, n);
  s.B.setZero(n, 4);
  s.A.topLeftCorner(kOtoliths, kOtoliths) = otoliths.A;
  s.A.block(kOtoliths, kOtoliths, kCanals, kCanals) = canal.A;
  s.A.block(0, FeltPair::kAngle, kOtoliths, 1) = kGravity * otoliths.B;
  s.A.block(kOtoliths, FeltPair::kAngleRate, kCanals, 1) = canal.B;
  s.A(FeltPair::kAngle, FeltPair::kAngleRate) = 1.0;
  s.B(FeltPair::kAngleRate, FeltPair::kAngleInput) = 1.0;
  s.B.block(0, FeltPair::kAngleInput, kOtoliths, 1) = -height * otoliths.B;
  s.B.block(0, FeltPair::kForce, kOtoliths, 1) = -otoliths.B;
  s.B.block(kOtoliths, FeltPair::kRateInput, kCanals, 1) = -canal.B;
  if (shifts) {
    s.A(FeltPair::kShift, FeltPair::kShiftRate) = 1.0;
    s.B(FeltPair::kShiftRate, FeltPair::kShiftInput) = 1.0;
    s.B.block(0, FeltPair::kShiftInput, kOtoliths, 1) = otoliths.B;
  }
  s.C.setZero(2, n);
  s.C.block(0, 0, 1, kOtoliths) = otoliths.C / thresholds.force[1 - pair];
  s.C.block(1, kOtoliths, 1, kCanals) = canal.C / thresholds.rate[pair];
  s.D.setZero(2, 4);
  return felt;
}

}  // namespace veridyn::cueing
