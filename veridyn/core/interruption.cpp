#include "veridyn/core/interruption.hpp"

#include <csignal>
#include <optional>

namespace veridyn {
namespace {

// A signal handler gets nothing but the number of its signal: what it requests has to be static, and is the only
// changing object of the library that is.
std::optional<Interruption> on_signal;

extern "C" void handle_signal(int signal) {
  on_signal->request();
  std::signal(signal, SIG_DFL);
}

}  // namespace

void request_on_signals(const Interruption& interruption) {
  on_signal = interruption;
  std::signal(SIGINT, handle_signal);
  std::signal(SIGTERM, handle_signal);
}

}  // namespace veridyn
