#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "veridyn/live/link/datagram.hpp"
#include "veridyn/live/recording/live_record.hpp"

namespace veridyn::live {

/// What somebody at the page asks for.
struct PageRequest {
  enum class Kind {
    kOperator,  ///< `request`
    kKnob,      ///< value `knob` of the algorithm's knobs becomes `value`
    kUndo,      ///< the knobs as they were before the last turn
  };
  Kind kind = Kind::kOperator;
  OperatorRequest request = OperatorRequest::kPark;
  std::size_t knob = 0;
  double value = 0.0;
  std::size_t run = 0;  ///< of those that the page shows
};

/// What a page may be asked for.
enum class PageControls {
  kAll,
  kStop,  ///< the emergency stop only
  kNone,  ///< it only shows
};

struct PageOptions {
  Sender address = {0x7f000001, 8090};
  /// For any control.
  std::string token;
  PageControls controls = PageControls::kAll;
  double rate = 20.0;  ///< of the statuses that a reader gets, at most [Hz]
  /// Earlier statuses of a run, between two times [s]; called on threads of the page. Empty: none are kept.
  std::function<std::string(std::size_t run, double from, double to)> frames = {};
  /// The platform of a run as `platform_json` has it; called on threads of the page. Empty: it is not drawn in space.
  std::function<std::string(std::size_t run)> platform = {};
  std::string place = "live.page";  ///< the address, in messages
};

/// The page of live runs: shows their status as server-sent events, and takes requests from whoever has the token. It
/// has threads of its own; a page that is slow or closed delays nobody.
///
/// A control is answered 401 without a token, 403 with a wrong one, where the page takes no such control, or where the
/// request came by another name than an address of this machine (so that no foreign page reaches it through a browser);
/// all of these are counted. The token comes in the header `Authorization: Bearer`, never in an address.
class LivePage {
 public:
  /// @throws InputError: the port is in use, the address is not ours; beyond loopback, controls without a token
  explicit LivePage(const PageOptions& options);
  ~LivePage();
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;

  /// The newest status, as JSON in one line.
  void show(std::string json);
  [[nodiscard]] std::vector<PageRequest> take_requests();
  /// Controls that were refused.
  [[nodiscard]] std::uint64_t refused() const;

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace veridyn::live
