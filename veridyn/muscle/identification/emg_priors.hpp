#pragma once

#include <array>
#include <string_view>

namespace veridyn::muscle {

/// What is taken of an error of recordings with EMG of which a study says nothing.
struct EmgPrior {
  std::string_view key;  ///< of a study, in `[emg]`
  double sigma;          ///< standard deviation
  std::string_view unit, meaning, source;
};

/// What the EMG is taken to be ahead of the excitation in the mean [s].
inline constexpr double kEmgDelay_s = 0.04;

/// Errors that more samples do not make smaller.
inline constexpr std::array kEmgBudget{
    EmgPrior{"noise", 0.1, "1", "error of an envelope, over its value",
             "9 to 20 % from repetition to repetition within a session (Colyer & McGuigan 2018, J Sports Sci Med "
             "17:101), of which a part is the muscle's own"},
    EmgPrior{"delay_sigma", 0.02, "s", "how far the EMG is ahead of the excitation, about 40 ms",
             "61 to 84 ms to the force of elbow flexors (Vint, McLean & Harron 2001, Med Sci Sports Exerc 33:978), of "
             "which activation and tendon of the model are some 30; 20 to 100 ms at the knee (Zhou et al. 1995, J Hum "
             "Mov Stud 28:127)"}};

}  // namespace veridyn::muscle
