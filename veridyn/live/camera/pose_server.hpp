#pragma once

#include <string_view>
#include <vector>

#include "veridyn/live/link/datagram.hpp"

namespace veridyn::live {

/// Sends packets over TCP to whoever is connected, and waits for nobody: a receiver that does not keep up is cut off,
/// and may connect again.
class PoseServer {
 public:
  /// @throws InputError with `place`: the port is in use, the address is not ours
  PoseServer(const Sender& bound_to, std::string_view place);
  ~PoseServer();
  PoseServer(const PoseServer&) = delete;
  PoseServer& operator=(const PoseServer&) = delete;

  void send(std::string_view packet);
  /// Connected at the last call of `send`.
  [[nodiscard]] std::size_t receivers() const { return clients_.size(); }

 private:
  int listener_ = -1;
  std::vector<int> clients_;
};

}  // namespace veridyn::live
