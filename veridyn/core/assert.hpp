#pragma once

#include <cstdio>
#include <cstdlib>

/// Checks an invariant of the library itself. When it is broken, prints the condition with its place and aborts, in
/// release builds too. Wrong input is never reported this way (see InputError), and hot loops use `assert` instead.
#define VERIDYN_ASSERT(condition)                                                            \
  do {                                                                                       \
    if (!(condition)) {                                                                      \
      std::fprintf(stderr, "%s:%d: broken invariant: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                          \
    }                                                                                        \
  } while (false)
