#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace veridyn::numerics {

/// Messages between the processes that a launcher started together; they are counted from 0. What a process sends to
/// another on one channel arrives in that order. All functions but `close` may be called on any thread.
/// @throws std::runtime_error, from any function, when the connection is lost.
class RankTransport {
 public:
  virtual ~RankTransport() = default;
  [[nodiscard]] virtual std::size_t rank() const = 0;
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// Sends a copy, without waiting for who receives it.
  virtual void send(std::size_t to, int channel, std::span<const double> message) = 0;
  /// Takes the next message of a process on a channel, all bits of it; false where none is there.
  [[nodiscard]] virtual bool receive(std::size_t from, int channel, std::vector<double>& message) = 0;
  /// Whether everything that was sent has been handed over; it may not be while the receiver has not asked for it.
  [[nodiscard]] virtual bool delivered() = 0;
  /// Ends the connection; all processes do, and nothing is sent any more.
  virtual void close() = 0;
};

}  // namespace veridyn::numerics
