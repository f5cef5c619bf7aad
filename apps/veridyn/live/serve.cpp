// veridyn serve FOLDER_OR_RECORDING...: the dashboard, for runs and other work of any process.
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <thread>

#include "apps/veridyn/live/served.hpp"
#include "apps/veridyn/run/console.hpp"
#include "veridyn/live/page/page_token.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::live;
using Clock = std::chrono::steady_clock;

/// Until Ctrl-C or the end of its time.
void show_all(const Arguments& arguments, Served& served, LivePage& page, PageControls controls, double rate) {
  const CommonOptions& options = arguments.common;
  const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate));
  const double seconds = arguments.number("--seconds");
  const Clock::time_point begun = Clock::now();
  Clock::time_point next = begun, looked = begun;
  while (!options.interruption.requested() &&
         (seconds == 0.0 || Clock::now() - begun < std::chrono::duration<double>(seconds))) {
    constexpr std::chrono::milliseconds kBetweenLooks(500);
    if (Clock::now() - looked > kBetweenLooks) {
      looked = Clock::now();
      served.look();
    }
    served.advance(period / 2);
    page.show(page_json(served.runs(), served.work(), controls, page.refused()));
    for (const PageRequest& r : page.take_requests()) {
      const bool asked = served.stop(r.run);
      print_line(options, asked ? "emergency stop" : "emergency stop: no run that goes on here takes it");
    }
    next = std::max(next + period, Clock::now());
    std::this_thread::sleep_until(next);
  }
}

int serve(const Arguments& arguments) {
  const CommonOptions& options = arguments.common;
  const Sender address = parse_address(arguments.text("--page"), "--page");
  const PageAccess access = page_access(address, arguments.text("--token-file"));
  const double rate = arguments.number("--rate");
  constexpr double kFastest = 60.0;
  if (!(rate >= 1.0 && rate <= kFastest))
    throw InputError("--rate", fmt::format("is {:g} Hz; takes 1 to {:g}", rate, kFastest));
  ignore_broken_pipes();
  // A run on this machine goes first.
  constexpr int kNice = 10;
  static_cast<void>(::setpriority(PRIO_PROCESS, 0, kNice));
  Served served(arguments.texts("FOLDER_OR_RECORDING"), rate);
#ifdef VERIDYN_HAS_SOCKETS
  const PageControls controls = access.token.empty() ? PageControls::kNone : PageControls::kStop;
#else
  const PageControls controls = PageControls::kNone;
#endif
  LivePage page({.address = address,
                 .token = access.token,
                 .controls = controls,
                 .rate = rate,
                 .frames = [&](std::size_t run, double from, double to) { return served.frames(run, from, to); },
                 .platform = [&](std::size_t run) { return served.platform(run); },
                 .place = "--page"});
  print_line(options, fmt::format("page: http://{}{}", to_string(address),
                                  controls == PageControls::kNone ? "  (it only shows)" : access.said));
  show_all(arguments, served, page, controls, rate);
  Summary summary;
  summary["controls_refused"] = page.refused();
  print_summary(summary, options);
  if (page.refused() > 0) print_line(options, fmt::format("{} controls refused", page.refused()));
  return kDone;
}

}  // namespace

Command serve_command() {
  return {
      .name = "serve",
      .summary = "a page in the browser: live runs as their recordings grow or played again, progress of other work",
      .arguments = {{.name = "FOLDER_OR_RECORDING",
                     .help = "recordings run_TIME.vlr; folders of results, which are watched with those in them",
                     .value = std::vector<std::string>{},
                     .required = true},
                    {.name = "--page",
                     .help = "address of the page; beyond 127.0.0.1 it only shows, unless there is a token",
                     .value = std::string("127.0.0.1:8091"),
                     .type = "ADDRESS:PORT"},
                    {.name = "--token-file",
                     .help = "what the emergency stop of the page needs; on 127.0.0.1 one is drawn when left out",
                     .type = "FILE"},
                    {.name = "--rate", .help = "how often the page moves [Hz]", .value = 20.0, .type = "HZ"},
                    {.name = "--seconds", .help = "end after this time; 0: with Ctrl-C", .value = 0.0}},
      .example = "veridyn serve out/live out/identify",
      .run = serve};
}

}  // namespace veridyn::app
