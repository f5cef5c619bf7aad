#include "apps/veridyn/live/live_operator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <optional>
#include <thread>

#include "apps/veridyn/live/live_drive.hpp"
#include "apps/veridyn/live/operator_keys.hpp"
#include "apps/veridyn/run/console.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/live/telemetry/sign_checker.hpp"
#ifdef VERIDYN_HAS_PAGE
#include "veridyn/live/page/page_json.hpp"
#include "veridyn/live/page/page_token.hpp"
#include "veridyn/live/page/platform_json.hpp"
#include "veridyn/live/page/status_json.hpp"
#endif

namespace veridyn::app {
namespace {

using namespace veridyn::live;

// A handler gets nothing but the number of its signal, so that what it stops is static.
std::atomic<LiveControl*> stopped_by_signal{nullptr};
std::atomic<bool> hung_up_by_signal{false};
extern "C" void stop_on_signal(int) {
  if (LiveControl* control = stopped_by_signal.load()) control->emergency();
}
extern "C" void hang_up_on_signal(int) { hung_up_by_signal = true; }

/// Messages to the operator, once for each change.
class Console {
 public:
  explicit Console(const CommonOptions& options) : options_(options) {}
  void show(const RigStatus& s, double time) {
    const std::string line = s.step.state == RigState::kRunning || s.readiness == Readiness::kReady
                                 ? std::string(name_of(s.step.state))
                                 : fmt::format("{}: {}", name_of(s.step.state), described(s.readiness, s.answers));
    if (line == last_) return;
    last_ = line;
    say(time, line);
  }
  void say(double time, const std::string& what) const {
    print_line(options_, fmt::format("{:8.2f} s  {}", time, what));
  }

 private:
  CommonOptions options_;
  std::string last_;
};

/// The telemetry's signs, looked at once a second until they are known.
class SignWatch {
 public:
  explicit SignWatch(const LiveStudy& study) : done_(study.options.signs == SignCheck::kOff) {}

  /// @param time of the run [s]
  void update(const std::vector<Telemetry>& motions, LiveControl& control, const RigStatus& status, double time,
              const Console& console, std::vector<std::string>& notes) {
    if (done_) return;
    for (const Telemetry& t : motions) {
      if (t.restarted) {
        checker_.reset();
        samples_.clear();
      }
      samples_.push_back(t.sample);
    }
    if (time < next_) return;
    next_ = time + 1.0;
    checker_.add(samples_);
    samples_.clear();
    const SignVerdict verdict = checker_.check();
    if (verdict.kind != SignVerdict::Kind::kUnknown) {
      const bool right = verdict.kind == SignVerdict::Kind::kRight;
      control.request(right ? OperatorRequest::kSignsRight : OperatorRequest::kSignsWrong);
      done_ = true;
      console.say(time, right ? "signs, axes and units of the telemetry are right" : "wrong: " + verdict.text);
      if (!right) notes.push_back("the platform was kept parked: " + verdict.text);
    } else if (verdict.text != missing_ && status.packets[PacketStatus::kAccepted] > 0) {
      missing_ = verdict.text;
      console.say(time, "signs are not yet checked; still to drive: " + verdict.text);
    }
  }
  /// What is still to be driven; empty where nothing is.
  [[nodiscard]] std::string message() const { return missing_.empty() || done_ ? "" : "still to drive: " + missing_; }

 private:
  SignChecker checker_;
  std::vector<recording::MotionSample> samples_;
  bool done_;
  double next_ = 1.0;  ///< [s]
  std::string missing_;
};

/// What goes wrong around the rig, each said once: records that are lost, a sender's clock that drifts, a loop that
/// stands still.
class TroubleWatch {
 public:
  void update(const RigStatus& status, const LiveRecorder& recorder, Nanoseconds now, double time,
              const Console& console, std::vector<std::string>& notes) {
    if (!loss_said_ && recorder.lost() > 0) {
      loss_said_ = true;
      const std::string trouble = recorder.trouble();
      console.say(time, trouble.empty() ? "the recording is too slow for what comes in: it has gaps" : trouble);
      notes.push_back(trouble.empty() ? "the recording has gaps" : trouble);
    }
    const std::string drift = drift_warning(status.drift);
    if (drift.empty()) drifts_since_ = time;
    constexpr double kLasts = 5.0;  // [s]: what is known after ten seconds moves about at first
    if (drift_.empty() && time - drifts_since_ > kLasts) {
      drift_ = drift;
      console.say(time, drift);
    }
    const bool stands = status.times.steps > 0 && now - status.step.time > kSecond;
    if (stands && !stands_) console.say(time, "the loop stands still");
    stands_ = stands;
  }
  /// For the page.
  [[nodiscard]] const std::string& message() const { return drift_; }

 private:
  bool loss_said_ = false, stands_ = false;
  double drifts_since_ = 0.0;  ///< [s]
  std::string drift_;
};

/// Both, where both say something.
std::string joined(const std::string& first, const std::string& second) {
  return first.empty() || second.empty() ? first + second : first + "; " + second;
}

/// Does what a key asks for. @return whether the run is to end
bool obey(char key, LiveControl& control) {
  switch (key) {
    case 's':
      control.request(OperatorRequest::kStart);
      break;
    case 'p':
      control.request(OperatorRequest::kPark);
      break;
    case ' ':
    case 'e':
      control.emergency();
      break;
    case 'r':
      control.request(OperatorRequest::kRelease);
      break;
    case 'q':
      return true;
    default:
      break;
  }
  return false;
}

}  // namespace

#ifdef VERIDYN_HAS_PAGE

struct PageOfRun::Page {
  void obey(const PageRequest& request, const LiveStudy& study, LiveControl& control);
  /// Another algorithm with these numbers; those that it refuses are left.
  void turn(const std::vector<double>& values, const LiveStudy& study, LiveControl& control) {
    std::unique_ptr<cueing::WashoutDesign> design = design_->clone();
    set_knob_values(*design, values);
    try {
      auto setting = std::make_unique<KnobSetting>();
      setting->values = values;
      setting->washout = design->make(study.cueing.platform);
      control.turn(std::move(setting));
      design_ = std::move(design);
    } catch (const InputError&) {
      if (!before_.empty()) before_.pop_back();
    }
  }

  std::optional<FeltNow> felt_;
  std::unique_ptr<cueing::WashoutDesign> design_;
  std::vector<std::vector<double>> before_;  ///< values of the knobs, the last ones last
  std::unique_ptr<LivePage> shown_at_;
  double shown_ = -1.0, apart_ = 0.05;  ///< [s]
};

void PageOfRun::Page::obey(const PageRequest& r, const LiveStudy& study, LiveControl& control) {
  if (r.kind == PageRequest::Kind::kOperator) {
    if (r.request == OperatorRequest::kEmergency)
      control.emergency();
    else
      control.request(r.request);
    return;
  }
  std::vector<double> values = knob_values(*design_);
  if (r.kind == PageRequest::Kind::kUndo) {
    if (before_.empty()) return;
    values = before_.back();
    before_.pop_back();
  } else {
    if (r.knob >= values.size()) return;
    before_.push_back(values);
    values[r.knob] = r.value;
  }
  turn(values, study, control);
}

PageOfRun::PageOfRun(const LiveStudy& study, const CommonOptions& options) : page_(std::make_unique<Page>()) {
  page_->design_ = study.cueing.algorithms.front().design->clone();
  if (!study.page) return;
  page_->felt_.emplace(study.cueing);
  const PageAccess access = page_access(*study.page, study.page_token);
  page_->shown_at_ = std::make_unique<LivePage>(
      PageOptions{.address = *study.page,
                  .token = access.token,
                  .rate = study.page_rate,
                  .platform = [text = platform_json(study.cueing.platform)](std::size_t) { return text; }});
  page_->apart_ = 1.0 / study.page_rate;
  print_line(options, fmt::format("page: http://{}{}", to_string(*study.page), access.said));
}

void PageOfRun::update(const RigStatus& status, const LiveStudy& study, LiveControl& control, double time,
                       const std::string& message) {
  if (!page_->shown_at_) return;
  page_->felt_->update(status);
  constexpr double kEarly = 1e-3;  // [s]
  if (time - page_->shown_ >= page_->apart_ - kEarly) {
    page_->shown_ = time;
    const std::array runs = {
        ShownRun{.status = status_json(status, study, *page_->felt_, *page_->design_, time, message), .length = time}};
    page_->shown_at_->show(page_json(runs, {}, PageControls::kAll, page_->shown_at_->refused()));
  }
  for (const PageRequest& r : page_->shown_at_->take_requests()) page_->obey(r, study, control);
}

#else

struct PageOfRun::Page {};

PageOfRun::PageOfRun(const LiveStudy& study, const CommonOptions&) {
  if (study.page) throw InputError("live.page", "this program was built without the page (see VERIDYN_PAGE)");
}

void PageOfRun::update(const RigStatus&, const LiveStudy&, LiveControl&, double, const std::string&) {}

#endif

PageOfRun::~PageOfRun() = default;

LiveSignals::LiveSignals(LiveControl& control) {
  stopped_by_signal = &control;
  hung_up_by_signal = false;
  std::signal(SIGUSR1, stop_on_signal);
  std::signal(SIGPIPE, SIG_IGN);
  // Whoever started it with nohup wants it to go on.
  if (std::signal(SIGHUP, hang_up_on_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

LiveSignals::~LiveSignals() {
  std::signal(SIGUSR1, SIG_IGN);  // one that comes late must not end the report
  stopped_by_signal = nullptr;
}

bool LiveSignals::hung_up() { return hung_up_by_signal; }

std::vector<std::string> lead_run(const OperatorOptions& options, const LiveStudy& study, LiveControl& control,
                                  const LiveRecorder& recorder, PageOfRun& page) {
  OperatorKeys keys;
  Console console(options.common);
  SignWatch signs(study);
  TroubleWatch trouble;
  LiveDrive drive(study, options.common.out);
  std::vector<Telemetry> motions;
  std::vector<std::string> notes;
  RealClock clock;
  bool ending = false;
  Nanoseconds give_up = 0;
  // As often as what is felt is followed, and as the page is shown.
  const std::chrono::duration<double> pause(std::min(0.02, 0.5 / study.page_rate));
  if (options.start) control.request(OperatorRequest::kStart);
  while (true) {
    const Nanoseconds now = clock.now();
    const double time = seconds(now - options.at);
    const RigStatus& status = control.status();
    console.show(status, time);
    page.update(status, study, control, time, joined(signs.message(), trouble.message()));
    control.tidy();
    motions.clear();
    control.take_motions(motions);
    drive.add(motions, time);
    signs.update(motions, control, status, time, console, notes);
    trouble.update(status, recorder, now, time, console, notes);
    ending = obey(keys.next(), control) || ending || options.common.interruption.requested() ||
             LiveSignals::hung_up() || (options.length > 0.0 && time >= options.length);
    if (ending && give_up == 0) {
      control.request(OperatorRequest::kPark);
      give_up = now + nanoseconds(study.options.fade + 10.0);
    }
    if (give_up != 0 &&
        (status.step.state == RigState::kParked || status.step.state == RigState::kStopped || now > give_up))
      break;
    std::this_thread::sleep_for(pause);
  }
  if (!drive.trouble().empty()) notes.push_back(drive.trouble());
  return notes;
}

}  // namespace veridyn::app
