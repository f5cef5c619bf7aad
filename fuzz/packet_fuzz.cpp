#include "fuzz/one_input.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"
#include "veridyn/io/packets/packet_log.hpp"

// One byte says which packet; the rest is a file of them, and the first of them alone.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  if (size < 1) return 0;
  static const std::vector<veridyn::io::PacketDecoder> decoders = [] {
    std::vector<veridyn::io::PacketDecoder> all;
    for (const veridyn::io::PacketLayout& layout : veridyn::io::known_packets()) all.emplace_back(layout);
    return all;
  }();
  const veridyn::io::PacketDecoder& decoder = decoders[data[0] % decoders.size()];
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  std::vector<double> values(decoder.layout().fields.size());
  if (decoder.decode(bytes.substr(0, decoder.layout().size), values) && decoder.is_plausible(values))
    VERIDYN_ASSERT(std::isfinite(decoder.motion(values).time) || !decoder.layout().has("time"));
  (void)veridyn::io::packets_in(bytes);
  return veridyn::fuzz::one_input(
      bytes, [&](std::string_view packets) { return veridyn::io::packet_log(decoder.layout(), packets, "fuzz"); });
}
