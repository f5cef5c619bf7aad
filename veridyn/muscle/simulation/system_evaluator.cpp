#include "veridyn/muscle/simulation/system_evaluator_definitions.hpp"

namespace veridyn::muscle {

template class SystemEvaluator<double>;

}  // namespace veridyn::muscle
