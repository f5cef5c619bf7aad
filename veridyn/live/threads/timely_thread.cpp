#include "veridyn/live/threads/timely_thread.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

namespace veridyn::live {

std::string make_thread_timely() {
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  std::string refused;
  sched_param priority{};
  priority.sched_priority = 50;
  if (::sched_setscheduler(0, SCHED_FIFO, &priority) != 0) refused = "real-time priority";
  if (::mlockall(MCL_CURRENT) != 0) refused += refused.empty() ? "locked memory" : " and locked memory";
  if (refused.empty()) return {};
  return refused + (refused.find(" and ") == std::string::npos ? " is" : " are") +
         " refused to this user: other work on the machine may delay orders (see `ulimit -r` and `ulimit -l`)";
}

}  // namespace veridyn::live
