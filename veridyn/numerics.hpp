#pragma once

/// Mathematics of sampled signals: filters, delays, noise, rotations, random numbers.
///
///     numerics::low_pass_differentiator(band)     // smooth and differentiate without delay, and
///     numerics::filter(signal, kernel, edges)     // the kernel over a signal with gaps
///     numerics::measurement_noise(...)            // white noise of a channel, from the channel itself
///     numerics::estimate_delay(...)               // of one channel behind another
///     numerics::RandomStream(seed, name)          // the same numbers everywhere
///     numerics::parallel_for(...)                 // work on threads, with the same result on any number of them
///
/// Component `numerics`.

#include "veridyn/numerics/delay.hpp"
#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/linear_systems/causal_filter.hpp"
#include "veridyn/numerics/linear_systems/transfer_function.hpp"
#include "veridyn/numerics/noise.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/resample.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/threads/parallel.hpp"
