#include "tests/support/tlog_writer.hpp"

#include <cmath>
#include <utility>

#include "tests/support/synthetic_logs.hpp"

namespace veridyn::testing {
namespace {

/// CRC-16/MCRF4XX bit by bit: polynomial 0x1021 reflected.
std::uint16_t crc_of(std::string_view bytes, std::uint8_t extra) {
  std::uint16_t crc = 0xffff;
  const auto take = [&crc](unsigned byte) {
    crc = static_cast<std::uint16_t>(crc ^ byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 1U) != 0 ? crc >> 1U ^ 0x8408U : crc >> 1U);
  };
  for (const char c : bytes) take(static_cast<unsigned char>(c));
  take(extra);
  return crc;
}

}  // namespace

void TlogWriter::stamp(std::uint64_t us) {
  for (int shift = 56; shift >= 0; shift -= 8) bytes_ += static_cast<char>((kBegin_us + us) >> shift & 0xffU);
}

void TlogWriter::second(std::uint64_t us, std::uint32_t message, std::uint8_t crc_extra, std::string payload,
                        Sender sender, bool is_signed) {
  while (payload.size() > 1 && payload.back() == '\0') payload.pop_back();
  stamp(us);
  std::string body =
      pack(static_cast<std::uint8_t>(payload.size()), static_cast<std::uint8_t>(is_signed ? 1 : 0), std::uint8_t{0},
           sequence_++, sender.system, sender.component, static_cast<std::uint8_t>(message),
           static_cast<std::uint8_t>(message >> 8U), static_cast<std::uint8_t>(message >> 16U)) +
      payload;
  bytes_ += '\xfd' + body + pack(crc_of(body, crc_extra));
  if (is_signed) bytes_ += std::string(13, 's');
}

void TlogWriter::packet(std::uint64_t us, std::uint32_t message, std::uint8_t crc_extra, std::string payload,
                        Sender sender) {
  second(us, message, crc_extra, std::move(payload), sender, false);
}

void TlogWriter::signed_packet(std::uint64_t us, std::uint32_t message, std::uint8_t crc_extra, std::string payload,
                               Sender sender) {
  second(us, message, crc_extra, std::move(payload), sender, true);
}

void TlogWriter::packet1(std::uint64_t us, std::uint8_t message, std::uint8_t crc_extra, std::string_view payload,
                         Sender sender) {
  stamp(us);
  const std::string body =
      pack(static_cast<std::uint8_t>(payload.size()), sequence_++, sender.system, sender.component, message) +
      std::string(payload);
  bytes_ += '\xfe' + body + pack(crc_of(body, crc_extra));
}

std::string small_tlog() {
  TlogWriter log;
  const auto parameter = [&](const char* name, float value) {
    std::string id(name);
    id.resize(16, '\0');
    log.packet(0, 22, 220, pack(value, std::uint16_t{2}, std::uint16_t{0}) + id + pack(std::uint8_t{9}));
  };
  parameter("SERVO2_FUNCTION", 19.0F);
  parameter("SERVO2_TRIM", 1500.0F);
  for (int i = 0; i < 40; ++i) {
    const std::uint64_t us = 50'000ULL * static_cast<std::uint64_t>(i) + 10'000;
    const auto boot_ms = static_cast<std::uint32_t>(100'000 + 50 * i);
    const std::uint64_t boot_us = 1000ULL * boot_ms;
    // The link is late by up to 70 ms, now and then by nothing.
    const std::uint64_t received = us + (i % 4 == 0 ? 0 : 70'000);
    const auto x = static_cast<float>(std::sin(0.3 * i));
    const auto deci = static_cast<std::int16_t>(10 * i);
    log.packet(received, 30, 39, pack(boot_ms, 0.1F * x, 0.2F * x, 0.3F * x, 1.0F * x, 2.0F * x, 3.0F * x));
    log.packet(received, 27, 144,
               pack(boot_us, deci, std::int16_t{0}, std::int16_t{-1000}, std::int16_t{500}, deci, std::int16_t{0},
                    std::int16_t{200}, std::int16_t{0}, std::int16_t{400}));
    log.packet(
        received, 33, 104,
        pack(boot_ms, std::int32_t{473'000'000 + i}, std::int32_t{85'000'000}, std::int32_t{500'000},
             std::int32_t{100'000}, deci, static_cast<std::int16_t>(-250 - i), std::int16_t{30}, std::uint16_t{65535}));
    log.packet(received, 36, 222,
               pack(static_cast<std::uint32_t>(boot_us), std::uint16_t{1500}, static_cast<std::uint16_t>(1500 + 5 * i),
                    std::uint16_t{1700}, std::uint16_t{1500}, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0},
                    std::uint16_t{0}, std::uint8_t{0}));
    log.packet(received, 74, 20, pack(20.0F + x, 22.0F, 500.0F, 0.5F, std::int16_t{90}, std::uint16_t{55}));
    log.packet1(received, 29, 115, pack(boot_ms, 950.5F, 2.5F + x, std::int16_t{1800}));
    if (i % 5 == 0) {
      log.packet(received, 24, 24,
                 pack(boot_us, std::int32_t{473'000'000}, std::int32_t{85'000'000}, std::int32_t{505'000 + 100 * i},
                      std::uint16_t{80}, std::uint16_t{120}, static_cast<std::uint16_t>(2200 + i),
                      static_cast<std::uint16_t>(9000 + 10 * i), std::uint8_t{3}, std::uint8_t{12}));
      log.packet(received, 30, 39, pack(boot_ms, 9.0F, 9.0F, 9.0F, 0.0F, 0.0F, 0.0F), {1, 154});
      log.packet(received, 30, 39, pack(boot_ms + 7'000'000, 0.5F + x, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F), {2, 1});
      log.packet(received, 11'000, 17, "unknown");
    }
    if (i % 20 == 0)
      log.packet(received, 0, 50,
                 pack(std::uint32_t{10}, std::uint8_t{1}, std::uint8_t{3}, static_cast<std::uint8_t>(i == 0 ? 81 : 209),
                      std::uint8_t{4}, std::uint8_t{3}));
  }
  std::string text = "Throttle armed";
  text.resize(50, '\0');
  log.signed_packet(2'000'000, 253, 83, pack(std::uint8_t{6}) + text);
  return std::move(log.bytes());
}

}  // namespace veridyn::testing
