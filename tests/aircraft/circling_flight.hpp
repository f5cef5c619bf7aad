#pragma once

#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft::testing {

inline constexpr double kCirclingEnd_s = 300.0;

/// Level circles of 60 s at 20 m/s in a steady wind, in gusts that the aircraft drifts with slowly.
struct Circles {
  double scale = 1.0;         ///< of the airspeed
  double alpha_bias = 0.0;    ///< rad
  double gust = 1.5;          ///< m/s
  double turn_period = 60.0;  ///< s; 0: straight
  std::uint64_t seed = 1;
};

inline Recording circling(const Circles& c) {
  numerics::RandomStream random(c.seed, "gust");
  constexpr double kStep = 0.02, kAirspeed = 20.0, kPitch = 4.0 * kDegree;
  std::vector<double> t, roll, pitch, yaw, north, east, down, airspeed, alpha, beta, density;
  double along = 0.0, slow = 0.0;
  for (double time = 0.0; time < kCirclingEnd_s; time += kStep) {
    // First-order gusts of 10 s; the aircraft follows them with a lag of 5 s.
    const double decay = std::exp(-kStep / 10.0);
    along = decay * along + c.gust * std::sqrt(1.0 - decay * decay) * random.normal();
    slow += kStep / 5.0 * (along - slow);
    const double heading = c.turn_period > 0.0 ? 2.0 * kPi * time / c.turn_period : 0.5;
    t.push_back(time);
    roll.push_back(0.2);
    pitch.push_back(kPitch);
    yaw.push_back(std::remainder(heading, 2.0 * kPi));
    north.push_back(kAirspeed * std::cos(heading) + 4.0 + slow * std::cos(heading));
    east.push_back(kAirspeed * std::sin(heading) - 2.0 + slow * std::sin(heading));
    down.push_back(0.0);
    airspeed.push_back(c.scale * (kAirspeed + slow - along));
    // Wings at 0.2 rad, nose up: alpha of level flight along the heading.
    alpha.push_back(std::atan2(std::sin(kPitch) * std::cos(0.2), std::cos(kPitch)) + c.alpha_bias +
                    0.01 * random.normal());
    beta.push_back(0.0);
    density.push_back(1.1);
  }
  Recording r;
  const TimeBase time = make_time_base(t);
  for (const auto& [name, unit, value] :
       {std::tuple{"roll", "rad", &roll}, std::tuple{"pitch", "rad", &pitch}, std::tuple{"yaw", "rad", &yaw},
        std::tuple{"vel_north", "m/s", &north}, std::tuple{"vel_east", "m/s", &east},
        std::tuple{"vel_down", "m/s", &down}, std::tuple{"airspeed", "m/s", &airspeed},
        std::tuple{"alpha", "rad", &alpha}, std::tuple{"beta", "rad", &beta},
        std::tuple{"air_density", "kg/m^3", &density}})
    r.add(make_channel(name, unit, time, *value));
  return r;
}

}  // namespace veridyn::aircraft::testing
