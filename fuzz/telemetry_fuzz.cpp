#include "veridyn/core/assert.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/live/platform/platform_packet.hpp"
#include "veridyn/live/telemetry/even_motion.hpp"

// Datagrams one after the other, each behind a byte of its length, as from a socket; they are tried as orders and
// answers of a platform, too.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace veridyn;
  static const std::vector<io::PacketLayout> layouts = {io::known_packet("veridyn"), io::known_packet("outsim"),
                                                        io::known_packet("outsim_id"), io::known_packet("motion_68")};
  live::PacketIntake intake(layouts);
  live::EvenMotion even;
  std::string_view bytes(reinterpret_cast<const char*>(data), size);
  live::Nanoseconds now = 0;
  while (!bytes.empty()) {
    const std::size_t length = static_cast<unsigned char>(bytes[0]);
    const std::string_view packet = bytes.substr(1, length);
    bytes.remove_prefix(std::min(bytes.size(), length + 1));
    now += 10 * live::kMillisecond;
    if (const auto t = intake.take({packet, {1, 1}, now})) {
      VERIDYN_ASSERT(t->sample.force.allFinite() && t->sample.rate.allFinite());
      even.add(*t);
    }
    if (const auto e = even.at(now, intake.clock())) VERIDYN_ASSERT(e->sample.force.allFinite());
    if (const auto order = live::decode_order(packet)) VERIDYN_ASSERT(order->motion.angle.allFinite());
    (void)live::decode_answer(packet);
  }
  return 0;
}
