#include <array>
#include <vector>

#include "veridyn/core/assert.hpp"
#include "veridyn/live/serial/frame.hpp"
#include "veridyn/live/teleoperation/car_end.hpp"
#include "veridyn/live/teleoperation/operator_end.hpp"

namespace veridyn::live {
namespace {

struct Decoded {
  FrameHeader header;
  std::vector<std::uint8_t> payload;
  bool operator==(const Decoded&) const = default;
};

/// All frames of the bytes, in chunks of that size; each encodes to what passes again.
std::vector<Decoded> decode(FrameDecoder& decoder, Bytes bytes, std::size_t chunk) {
  std::vector<Decoded> frames;
  while (!bytes.empty()) {
    Bytes part = bytes.first(std::min(chunk, bytes.size()));
    bytes = bytes.subspan(part.size());
    while (const std::optional<SerialFrame> frame = decoder.next(part))
      frames.push_back({frame->header, {frame->payload.begin(), frame->payload.end()}});
    VERIDYN_ASSERT(part.empty());
  }
  return frames;
}

/// A payload of any bytes decodes to what encodes to the same, or to nothing.
void check_payload(Bytes payload) {
  std::array<std::uint8_t, kReportPayload> bytes;
  if (const std::optional<CommandPayload> command = decode_command(payload)) {
    encode_command(*command, bytes);
    VERIDYN_ASSERT(std::equal(payload.begin(), payload.begin() + 6, bytes.begin()));
    VERIDYN_ASSERT(decode_command(Bytes(bytes).first(kCommandPayload))->command == command->command);
  }
  if (const std::optional<ReportPayload> report = decode_report(payload)) {
    encode_report(*report, bytes);
    VERIDYN_ASSERT(std::equal(payload.begin(), payload.begin() + 31, bytes.begin()));
  }
}

/// Both ends take the bytes as they are, and then as the payload of a frame that passes the CRC.
void check_ends(Bytes bytes) {
  CarEnd car({.neutral_for = 0}, 1);
  OperatorEnd driver({}, 2);
  std::array<std::uint8_t, kLongestFrame> frame;
  Nanoseconds now = kSecond;
  driver.receive(Bytes(frame).first(car.report({}, now, frame)), now);
  car.receive(bytes, now);
  driver.receive(bytes, now);
  for (const std::uint8_t kind : {kCommandKind, kReportKind}) {
    const std::size_t length = kind == kCommandKind ? kCommandPayload : kReportPayload;
    std::uint32_t sequence = 0;
    for (Bytes rest = bytes; rest.size() >= length; rest = rest.subspan(length)) {
      now += kMillisecond;
      const FrameHeader header = {.kind = kind, .run = rest[0], .sequence = sequence++};
      const std::size_t size = encode_frame(header, rest.first(length), frame);
      car.receive(Bytes(frame).first(size), now);
      driver.receive(Bytes(frame).first(size), now);
      const CarActuation actuation = car.step({}, now);
      VERIDYN_ASSERT(what_is_wrong(actuation.command, {}).empty());
      (void)driver.quality(now);
      (void)driver.command({}, now, frame);
    }
  }
}

}  // namespace
}  // namespace veridyn::live

// One byte says how large the chunks are, the rest came over the line.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace veridyn::live;
  if (size < 1) return 0;
  const Bytes bytes(data + 1, size - 1);
  FrameDecoder whole, chunked;
  const std::vector<Decoded> frames = decode(whole, bytes, size);
  VERIDYN_ASSERT(decode(chunked, bytes, 1 + data[0] % 64U) == frames);
  VERIDYN_ASSERT(whole.counts().good == frames.size() && whole.counts().bytes == bytes.size());
  VERIDYN_ASSERT(whole.counts().damaged() == chunked.counts().damaged());
  for (const Decoded& frame : frames) {
    std::array<std::uint8_t, kLongestFrame> encoded;
    const std::size_t length = encode_frame(frame.header, frame.payload, encoded);
    FrameDecoder again;
    VERIDYN_ASSERT(decode(again, Bytes(encoded).first(length), 7) == std::vector<Decoded>{frame});
    check_payload(frame.payload);
  }
  check_payload(bytes);
  if (bytes.size() >= kReportPayload) check_payload(bytes.first(kReportPayload));
  if (bytes.size() >= kCommandPayload) check_payload(bytes.first(kCommandPayload));
  check_ends(bytes);
  return 0;
}
