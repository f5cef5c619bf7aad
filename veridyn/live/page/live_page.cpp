#include "veridyn/live/page/live_page.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "veridyn/core/error.hpp"
#include "veridyn/live/page/page_text.hpp"
#include "veridyn/live/page/page_token.hpp"

namespace veridyn::live {
namespace {

constexpr std::size_t kMostPages = 8, kMostRequests = 64, kLongestRequest = 4096;

std::string text_of(const Sender& s) {
  const std::string all = to_string(s);
  return all.substr(0, all.find(':'));
}

/// A number of a request's address; nothing where it is none.
std::optional<double> parameter(const httplib::Request& request, const char* name) {
  const std::string text = request.get_param_value(name);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return text.empty() || *end != '\0' || !std::isfinite(value) ? std::nullopt : std::optional(value);
}

/// Which run is asked about.
std::optional<std::size_t> run_of(const httplib::Request& request) {
  constexpr double kMostRuns = 1000.0;
  const std::optional<double> run = parameter(request, "run");
  return run && *run >= 0.0 && *run < kMostRuns ? std::optional(static_cast<std::size_t>(*run)) : std::nullopt;
}

/// A request as the page writes it: {"request": "park"}, {"knob": 3, "value": 0.7}, {"undo": true}; with "run" where
/// the page shows several.
std::optional<PageRequest> parse(const std::string& body) {
  const nlohmann::json json = nlohmann::json::parse(body, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  PageRequest r;
  if (json.contains("run")) {
    if (!json["run"].is_number_unsigned()) return std::nullopt;
    r.run = json["run"].get<std::size_t>();
  }
  if (json.contains("request") && json["request"].is_string()) {
    constexpr std::array<std::pair<const char*, OperatorRequest>, 4> kRequests = {
        {{"start", OperatorRequest::kStart},
         {"park", OperatorRequest::kPark},
         {"emergency", OperatorRequest::kEmergency},
         {"release", OperatorRequest::kRelease}}};
    for (const auto& [name, request] : kRequests) {
      if (json["request"] != name) continue;
      r.request = request;
      return r;
    }
    return std::nullopt;
  }
  if (json.contains("knob") && json["knob"].is_number_unsigned() && json.contains("value") &&
      json["value"].is_number()) {
    r.kind = PageRequest::Kind::kKnob;
    r.knob = json["knob"].get<std::size_t>();
    r.value = json["value"].get<double>();
    return r;
  }
  if (json.value("undo", false)) {
    r.kind = PageRequest::Kind::kUndo;
    return r;
  }
  return std::nullopt;
}

}  // namespace

struct LivePage::Server {
  httplib::Server http;
  std::thread thread;
  PageOptions options;
  std::vector<std::string> hosts;  ///< names by which requests may come; empty: any, of a page for other machines

  std::mutex mutex;
  std::condition_variable changed;
  std::string status = "{}";
  std::uint64_t shown = 0;
  std::vector<PageRequest> requests;
  std::atomic<std::uint64_t> refused{0};
  std::atomic<std::size_t> pages{0};
  std::atomic<bool> ended{false};

  /// 0 where the request may control the rig, else the status that it is answered with.
  int refusal(const httplib::Request& request) {
    const std::string host = request.get_header_value("Host");
    if (!hosts.empty() && std::find(hosts.begin(), hosts.end(), host) == hosts.end()) return 403;
    const std::string origin = request.get_header_value("Origin");
    if (!origin.empty() && origin != "http://" + host) return 403;
    constexpr std::string_view kBearer = "Bearer ";
    const std::string given = request.get_header_value("Authorization");
    if (!given.starts_with(kBearer)) return 401;
    if (options.controls == PageControls::kNone || options.token.empty()) return 403;
    return equal_in_constant_time(options.token, given.substr(kBearer.size())) ? 0 : 403;
  }
  /// Whether the page takes such a control at all.
  [[nodiscard]] bool takes(const std::optional<PageRequest>& asked) const {
    return !asked || options.controls == PageControls::kAll ||
           (asked->kind == PageRequest::Kind::kOperator && asked->request == OperatorRequest::kEmergency);
  }

  void control(const httplib::Request& request, httplib::Response& response) {
    if (const int status_of = refusal(request); status_of != 0) {
      ++refused;
      response.status = status_of;
      response.set_content(status_of == 401 ? "a control needs the token" : "refused", "text/plain");
      return;
    }
    const std::optional<PageRequest> asked = parse(request.body);
    if (!takes(asked)) {
      ++refused;
      response.status = 403;
      response.set_content("this page shows runs and can stop them", "text/plain");
      return;
    }
    const std::lock_guard lock(mutex);
    if (!asked || requests.size() >= kMostRequests) {
      response.status = asked ? 503 : 400;
      return;
    }
    requests.push_back(*asked);
    response.status = 204;
  }

  /// One event; waits for a newer status than the last one sent.
  bool send_event(httplib::DataSink& sink, std::uint64_t& sent) {
    std::string event;
    {
      std::unique_lock lock(mutex);
      changed.wait_for(lock, std::chrono::seconds(1), [&] { return shown != sent || ended; });
      if (ended) {
        sink.done();
        return true;
      }
      sent = shown;
      event = "data: " + status + "\n\n";
    }
    const bool taken = sink.write(event.data(), event.size());
    std::this_thread::sleep_for(std::chrono::duration<double>(1.0 / options.rate));
    return taken;
  }
};

LivePage::LivePage(const PageOptions& options) : server_(std::make_unique<Server>()) {
  Server& s = *server_;
  const std::string place = options.place;
  if (!is_loopback(options.address) && options.token.empty() && options.controls != PageControls::kNone)
    throw InputError(place, fmt::format("{} can be reached from other machines: that needs a token (`page_token`)",
                                        to_string(options.address)));
  s.options = options;
  if (is_loopback(options.address))
    s.hosts = {to_string(options.address), fmt::format("localhost:{}", options.address.port)};
  // As many as may look, and one for controls.
  s.http.new_task_queue = [] { return new httplib::ThreadPool(kMostPages + 2); };
  s.http.set_payload_max_length(kLongestRequest);
  s.http.set_keep_alive_max_count(100);
  s.http.set_default_headers({{"Content-Security-Policy", "default-src 'self' 'unsafe-inline'; connect-src 'self'"},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Cache-Control", "no-store"}});
  s.http.Get("/", [](const httplib::Request&, httplib::Response& response) {
    response.set_content(std::string(page_texts()[0].text), "text/html; charset=utf-8");
  });
  s.http.Get("/status", [&s](const httplib::Request&, httplib::Response& response) {
    const std::lock_guard lock(s.mutex);
    response.set_content(s.status, "application/json");
  });
  s.http.Get("/events", [&s](const httplib::Request&, httplib::Response& response) {
    if (s.pages >= kMostPages) {
      response.status = 503;
      return;
    }
    ++s.pages;
    auto sent = std::make_shared<std::uint64_t>(0);
    response.set_chunked_content_provider(
        "text/event-stream", [&s, sent](std::size_t, httplib::DataSink& sink) { return s.send_event(sink, *sent); },
        [&s](bool) { --s.pages; });
  });
  s.http.Get("/frames", [&s](const httplib::Request& request, httplib::Response& response) {
    const std::optional<std::size_t> run = run_of(request);
    const std::optional<double> from = parameter(request, "from"), to = parameter(request, "to");
    if (!s.options.frames || !run || !from || !to) {
      response.status = 404;
      return;
    }
    response.set_content(s.options.frames(*run, *from, *to), "application/json");
  });
  s.http.Get("/platform", [&s](const httplib::Request& request, httplib::Response& response) {
    const std::optional<std::size_t> run = run_of(request);
    if (!s.options.platform || !run) {
      response.status = 404;
      return;
    }
    response.set_content(s.options.platform(*run), "application/json");
  });
  s.http.Post("/control",
              [&s](const httplib::Request& request, httplib::Response& response) { s.control(request, response); });
  // One program at a port: a second one is refused and does not share it.
  s.http.set_socket_options([](socket_t socket) {
    const int on = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  });
  if (!s.http.bind_to_port(text_of(options.address), options.address.port))
    throw InputError(place, fmt::format("{} cannot be listened to: in use, or not ours", to_string(options.address)));
  s.thread = std::thread([&s] { s.http.listen_after_bind(); });
  while (!s.http.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));  // `stop` needs it
}

LivePage::~LivePage() {
  server_->ended = true;
  server_->changed.notify_all();
  server_->http.stop();
  server_->thread.join();
}

void LivePage::show(std::string json) {
  const std::lock_guard lock(server_->mutex);
  server_->status = std::move(json);
  ++server_->shown;
  server_->changed.notify_all();
}

std::vector<PageRequest> LivePage::take_requests() {
  const std::lock_guard lock(server_->mutex);
  return std::exchange(server_->requests, {});
}

std::uint64_t LivePage::refused() const { return server_->refused; }

}  // namespace veridyn::live
