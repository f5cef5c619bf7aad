#pragma once

namespace veridyn {

/// Why a simulation ended. All domains share it, so that those who call a simulation ask one question; each
/// trajectory's `message()` says it in the words of its domain.
enum class SimulationEnd {
  kCompleted,    ///< simulated to the end
  kInterrupted,  ///< the caller's progress asked to stop
  kDiverged,    ///< the state became NaN or infinite, or left every sensible range: the step is too long for this model
  kStepSize,    ///< no step is small enough: a limit of the model
  kStepLimit,   ///< the largest number of steps is used up
  kNoTrim,      ///< aircraft: steady level flight at the desired airspeed does not exist
  kGround,      ///< aircraft: touched the ground
  kUpset,       ///< aircraft: angle of attack beyond 90 deg or rates beyond 50 rad/s, where the model means nothing
  kStopped,     ///< vehicle: forward speed fell below 0.5 m/s, where slip angles lose their meaning
  kSpun,        ///< vehicle: slip angle at the centre of gravity beyond 90 deg, it goes backwards
  kRolledOver,  ///< vehicle: roll or pitch beyond 45 deg, where small angles are over
};

}  // namespace veridyn
