// veridyn serve, where the program was built without the page.
#include "apps/veridyn/run/command.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::app {

Command serve_command() {
  return {.name = "serve",
          .summary = "the dashboard (not in this build: cpp-httplib was missing)",
          .example = "veridyn serve --help",
          .run = [](const Arguments&) -> int {
            throw InputError("serve", "this program was built without the page (see VERIDYN_PAGE)");
          }};
}

}  // namespace veridyn::app
