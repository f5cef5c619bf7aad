#include "veridyn/report/live_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/text.hpp"
#include "veridyn/report/cueing_report.hpp"
#include "veridyn/report/document/number_format.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::live;

constexpr double kPerMillisecondOf = 1e3;

Cell milliseconds(double s) { return number_cell(s * kPerMillisecondOf, 3); }

Row times_row(const std::string& name, const LatencyHistogram& h) {
  return {.cells = {text_cell(name), milliseconds(h.quantile(0.5)), milliseconds(h.quantile(0.99)),
                    milliseconds(h.quantile(0.9999)), milliseconds(seconds(h.largest())),
                    number_cell(static_cast<double>(h.count()), 0)}};
}

/// Shares of all in bins, over their upper edges.
XYSeries distribution(const std::string& name, const LatencyHistogram& h) {
  XYSeries s{.name = name, .style = Style::kLine};
  for (std::size_t i = 0; i + 1 < LatencyHistogram::kBins; ++i) {
    if (h.bins()[i] == 0 && (s.x.empty() || LatencyHistogram::upper_edge(i) > seconds(h.largest()) * 1.13)) continue;
    s.x.push_back(LatencyHistogram::upper_edge(i) * kPerMillisecondOf);
    s.y.push_back(100.0 * static_cast<double>(h.bins()[i]) / static_cast<double>(h.count()));
  }
  return s;
}

Section timing_section(const LiveReplay& run) {
  Section section{.title = "Timing"};
  Table t{.title = "Orders to the platform",
          .caption = fmt::format(
              "{} orders at {:g} Hz. A packet waits for the next order, up to a period; the motion itself is taken "
              "{:g} ms late, which is the delay that the study chose, and not in these figures.",
              run.times.steps, run.study.options.rate, run.study.options.even.delay * kPerMillisecondOf)};
  t.columns = {{.name = "time", .align = Align::kLeft}, {.name = "half", .unit = "ms"},
               {.name = "99 %", .unit = "ms"},          {.name = "99.99 %", .unit = "ms"},
               {.name = "longest", .unit = "ms"},       {.name = "of"}};
  t.sortable = false;
  t.rows.push_back(times_row("packet's arrival to order sent", run.times.receive_to_send));
  // Of a run that is replayed they are not known.
  if (run.times.work.count() > 0) {
    t.rows.push_back(times_row("of that: waiting for the next order", run.times.wait));
    t.rows.push_back(times_row("of that: from the step's beginning to the order sent", run.times.work));
  }
  t.rows.push_back(times_row("step's time to order sent", run.times.wake));
  t.rows.push_back(times_row("interval against the period, either way", run.times.jitter));
  section.blocks.emplace_back(std::move(t));
  if (run.times.receive_to_send.count() > 0) {
    XYPlot plot{.title = "How long packets took to an order",
                .x = {"time", "ms"},
                .y = {"share of packets", "%"},
                .log_x = true};
    plot.series.push_back(distribution("arrival to order sent", run.times.receive_to_send));
    section.blocks.emplace_back(std::move(plot));
  }
  section.blocks.emplace_back(
      FactList{{{"Deadlines left out", fmt::format("{}", run.times.left_out)},
                {"Pauses in which the platform stopped", fmt::format("{}", run.gaps)},
                {"Orders whose motion was continued beyond the last packet",
                 fmt::format("{} of {}, by {:.0f} ms at most", run.extrapolated.steps, run.extrapolated.of,
                             run.extrapolated.longest * kPerMillisecondOf)},
                {"Sender's clock against ours",
                 std::isfinite(run.drift) ? fmt::format("{:+.0f} ppm", -1e6 * run.drift) : "not known within 10 s"}}});
  return section;
}

Section packets_section(const LiveReplay& run) {
  Section section{.title = "Telemetry"};
  Table t{.title = "Packets by sender and by what became of them"};
  t.columns = {{.name = "packets", .align = Align::kLeft}};
  for (const PacketIntake::FromSender& s : run.senders) t.columns.push_back({.name = to_string(s.sender)});
  t.sortable = false;
  for (std::size_t i = 0; i < kPacketStatuses; ++i) {
    if (run.packets[i] == 0 && i > 0) continue;
    Row row{.cells = {text_cell(std::string(name_of(static_cast<PacketStatus>(i))))}};
    for (const PacketIntake::FromSender& s : run.senders)
      row.cells.push_back(number_cell(static_cast<double>(s.counts[i]), 0));
    t.rows.push_back(std::move(row));
  }
  section.blocks.emplace_back(std::move(t));
  if (!run.derived.empty()) section.blocks.emplace_back(Paragraph{"Of these packets " + run.derived + "."});
  return section;
}

Section states_section(const LiveReplay& run) {
  Section section{.title = "What the rig did"};
  Table t{.title = "States"};
  t.columns = {{.name = "from", .unit = "s"},
               {.name = "state", .align = Align::kLeft},
               {.name = "telemetry and platform", .align = Align::kLeft}};
  t.sortable = false;
  constexpr std::size_t kRowsShown = 200;
  for (const LiveReplay::Change& c : run.changes) {
    if (t.rows.size() == kRowsShown) {
      t.caption = fmt::format("The first {} of {}.", kRowsShown, run.changes.size());
      break;
    }
    t.rows.push_back({.cells = {number_cell(c.time, 2), text_cell(std::string(name_of(c.to))),
                                text_cell(std::string(name_of(c.readiness)))}});
  }
  section.blocks.emplace_back(std::move(t));
  if (!run.turns.empty())
    section.blocks.emplace_back(Paragraph{fmt::format("Knobs were turned {} times.", run.turns.size())});
  return section;
}

/// How long it takes from pedal to motion, stage by stage.
Table way_table(const LiveReplay& run) {
  Table t{.title = "From pedal to motion",
          .caption =
              "Of one way over the line only bounds can be known: their width is the shortest round trip, which no "
              "exchange of stamps can share out. Stages follow one another; the car's own actuators and the "
              "platform's mechanics come on top."};
  t.columns = {{.name = "stage", .align = Align::kLeft},
               {.name = "half", .unit = "ms"},
               {.name = "99 %", .unit = "ms"},
               {.name = "at least", .unit = "ms"},
               {.name = "at most", .unit = "ms"}};
  t.sortable = false;
  const auto measured = [&](const std::string& name, const LatencyHistogram& h) {
    if (h.count() == 0) return;
    t.rows.push_back({.cells = {text_cell(name), milliseconds(h.quantile(0.5)), milliseconds(h.quantile(0.99)),
                                text_cell(""), milliseconds(seconds(h.largest()))}});
  };
  const auto bounded = [&](const std::string& name, const std::optional<DelayBounds>& b) {
    if (!b) return;
    t.rows.push_back({.cells = {text_cell(name), text_cell(""), text_cell(""), milliseconds(seconds(b->lowest)),
                                milliseconds(seconds(b->highest))}});
  };
  measured("wheel or pedal moved, to command sent", run.times.pedal_to_command);
  bounded("command on the line (the last one)", run.car->quality.command_delay);
  bounded("report on the line (the last one)", run.car->quality.report_delay);
  measured("report's arrival to order sent", run.times.receive_to_send);
  t.rows.push_back(
      {.cells = {text_cell("motion taken late, as the study chose"), milliseconds(run.study.options.even.delay),
                 text_cell(""), text_cell(""), text_cell("")}});
  if (run.answers.count > 0)
    t.rows.push_back(
        {.cells = {text_cell("order to the platform's answer (the last one)"),
                   milliseconds(seconds(run.answers.round_trip)), text_cell(""), text_cell(""), text_cell("")}});
  return t;
}

/// The same measured whole, one movement after the other.
Table trace_table(const LiveReplay& run) {
  const PedalTrace::Result& trace = run.car->pedal_to_platform;
  const cueing::Platform& platform = run.study.cueing.platform;
  Table t{
      .title = "From pedal to platform, followed",
      .caption = fmt::format(
          "Of {} movements of wheel or pedals that were followed one by one: which command knew of it, which report "
          "of that command, which order of that report, and the platform's answer to that. Stages follow one "
          "another; their means add up to that of the whole.{} What moves only after a command comes on top: the "
          "car's servos and mass, the algorithm's filters, and the platform, whose axes come {} later (delay + "
          "2 zeta/omega of [platform]).",
          trace.whole.count(),
          trace.given_up > 0 ? fmt::format(" {} were given up: the link was lost.", trace.given_up) : "", [&] {
            double least = 1e9, most = 0.0;
            for (const cueing::PlatformAxis axis : platform.limits.moving_axes()) {
              const cueing::ActuatorOptions& a = platform.response(axis);
              const double lag = a.delay + (a.omega > 0.0 ? 2.0 * a.zeta / a.omega : 0.0);
              least = std::min(least, lag);
              most = std::max(most, lag);
            }
            return most - least < 5e-4 ? fmt::format("{:.0f} ms", 1e3 * most)
                                       : fmt::format("{:.0f} to {:.0f} ms", 1e3 * least, 1e3 * most);
          }())};
  t.columns = {{.name = "stage", .align = Align::kLeft},
               {.name = "mean", .unit = "ms"},
               {.name = "half", .unit = "ms"},
               {.name = "99 %", .unit = "ms"},
               {.name = "at most", .unit = "ms"}};
  t.sortable = false;
  const auto row = [&](const std::string& name, const LatencyHistogram& h) {
    t.rows.push_back({.cells = {text_cell(name), milliseconds(h.mean()), milliseconds(h.quantile(0.5)),
                                milliseconds(h.quantile(0.99)), milliseconds(seconds(h.largest()))}});
  };
  using Stage = PedalTrace::Stage;
  row("wheel or pedal moved, to command sent", trace[Stage::kInput]);
  row("command and report on the line, both ways", trace[Stage::kLine]);
  row("at the car, to the report that knows of it", trace[Stage::kCar]);
  row("report's arrival, to the order that holds its motion", trace[Stage::kMotion]);
  row("order, to the platform's answer", trace[Stage::kPlatform]);
  row("the whole", trace.whole);
  return t;
}

/// Of a run with a car: how long it takes from pedal to motion, and how good the line was.
Section car_section(const LiveReplay& run) {
  const CarReplay& car = *run.car;
  const LinkQuality& q = car.quality;
  Section section{.title = "The car"};
  section.blocks.emplace_back(way_table(run));
  if (car.pedal_to_platform.whole.count() > 0) section.blocks.emplace_back(trace_table(run));
  const auto share = [](double lost) { return fmt::format("{:.1f} %", 100.0 * lost); };
  FactList facts{
      {{"Commands", fmt::format("{} sent, {} lost, {} different when replayed", q.commands_sent,
                                share(q.command_loss()), car.commands_different)},
       {"Reports", fmt::format("{} received, {} lost, {} late, {} twice", q.reports_received, share(q.report_loss()),
                               q.reports_late, q.reports_duplicate)},
       {"Damaged frames", fmt::format("{}", q.frames_damaged)},
       {"Starts of the car while the rig ran", fmt::format("{}", car.restarts + (q.reports_received > 0 ? 1 : 0))}}};
  section.blocks.emplace_back(std::move(facts));
  if (q.round_trip_median)
    section.blocks.emplace_back(Paragraph{fmt::format(
        "Both ways over the line together, of the last 1024 reports: half within {:.2f} ms, 99 % within {:.2f} ms, the "
        "quickest {:.2f} ms.",
        1e3 * seconds(*q.round_trip_median), 1e3 * seconds(*q.round_trip_p99), 1e3 * seconds(*q.round_trip_least))});
  return section;
}

Verdict verdict_of(const LiveReplay& run, const std::vector<std::string>& notes) {
  Verdict v{.level = Level::kGood, .word = "Run", .headline = {}, .lines = notes};
  std::vector<std::string> bad;
  if (run.outside > 0) bad.push_back(fmt::format("{} orders were beyond the platform's limits", run.outside));
  if (run.answers.outside_limits > 0)
    bad.push_back(fmt::format("the platform counted {} orders beyond its limits", run.answers.outside_limits));
  if (run.different > 0)
    bad.push_back(fmt::format("{} of {} orders differ when the recording is replayed{}", run.different, run.times.steps,
                              run.missing > 0 ? fmt::format(": {} steps are missing in it", run.missing) : ""));
  if (run.car && run.car->commands_different > 0)
    bad.push_back(fmt::format("{} of {} commands to the car differ when the recording is replayed",
                              run.car->commands_different, run.car->commands));
  if (!bad.empty()) {
    v.level = Level::kBad;
    v.word = "Wrong";
    v.headline = capitalised(bad.front());
    bad.erase(bad.begin());
    v.lines.insert(v.lines.begin(), bad.begin(), bad.end());
  } else {
    v.headline = fmt::format("{} orders in {:.1f} s, all within the platform's limits, and the same when replayed",
                             run.times.steps, run.duration);
  }
  const auto caution = [&](std::string line) {
    v.lines.push_back(std::move(line));
    if (v.level == Level::kGood) {
      v.level = Level::kCaution;
      v.word = "Look";
    }
  };
  if (const std::string warning = drift_warning(run.drift); !warning.empty()) caution(warning);
  constexpr double kOften = 1e-3;
  if (const auto missed = static_cast<double>(run.times.left_out);
      missed > kOften * static_cast<double>(run.times.steps))
    caution(fmt::format("{} of {} deadlines were missed: the machine is too busy for the rate", run.times.left_out,
                        run.times.left_out + run.times.steps));
  if (run.damaged > 0 || run.cut_bytes > 0)
    caution(fmt::format("the recording is damaged in {} places and cut by {} bytes at its end", run.damaged,
                        run.cut_bytes));
  return v;
}

}  // namespace

Document live_report(const LiveReplay& run, const cueing::CueingResult& score, const std::vector<std::string>& notes,
                     const std::string& program) {
  Document d{.title = run.study.cueing.title.empty() ? "Live motion" : run.study.cueing.title,
             .subtitle = fmt::format("{} on platform {}", run.run.algorithm, run.study.cueing.platform.name),
             .generator = "Made with " + program};
  d.verdict = verdict_of(run, notes);
  d.facts = {{"Telemetry", run.layout.empty() ? "none was accepted" : run.layout},
             {"Lasts", fmt::format("{:.1f} s", run.duration)},
             {"Platform", run.study.cueing.platform.name},
             {"Algorithm", run.run.algorithm},
             {"Orders", fmt::format("{:g} Hz, fingerprint {}", run.study.options.rate, run.orders_fingerprint)}};
  d.sections = {timing_section(run), run.car ? car_section(run) : packets_section(run), states_section(run)};
  if (score.algorithms.empty()) return d;
  Document felt = cueing_report(run.study.cueing, score, program);
  for (Section& section : felt.sections) d.sections.push_back(std::move(section));
  return d;
}

}  // namespace veridyn::report
