#include "veridyn/muscle/model/muscle_parameters.hpp"

namespace veridyn::muscle {

numerics::PiecewisePolynomial SchutteCurves::default_tendon() {
  constexpr std::array kStrain{-10.0,   -0.002, -0.001, 0.0,    0.00131, 0.00281, 0.00431, 0.00581, 0.00731,
                               0.00881, 0.0103, 0.0118, 0.0123, 9.2,     9.201,   9.202,   20.0};
  constexpr std::array kForce{0.0,   0.0,   0.0,   0.0,   0.0108, 0.0257, 0.0435, 0.0652, 0.0915,
                              0.123, 0.161, 0.208, 0.227, 345.0,  345.0,  345.0,  345.0};
  return numerics::PiecewisePolynomial::simm_spline(kStrain, kForce);
}

numerics::PiecewisePolynomial SchutteCurves::default_active() {
  constexpr std::array kLength{-5.307692, -4.307692, -1.923077, -0.884615, -0.269231, 0.230769, 0.461538,
                               0.52725,   0.62875,   0.71875,   0.86125,   1.045,     1.2175,   1.43875,
                               1.5,       1.615385,  2.0,       2.961538,  3.692308,  5.461538, 9.901902};
  constexpr std::array kForce{0.012188, 0.021899, 0.036466, 0.052493, 0.075312, 0.114158, 0.157859,
                              0.226667, 0.636667, 0.856667, 0.95,     0.993333, 0.77,     0.246667,
                              0.193821, 0.133252, 0.072683, 0.044417, 0.036341, 0.021899, 0.007332};
  return numerics::PiecewisePolynomial::simm_spline(kLength, kForce);
}

}  // namespace veridyn::muscle
