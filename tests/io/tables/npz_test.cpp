#include "veridyn/io/tables/npz.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zip.h>
#include <zlib.h>

#include <cmath>
#include <cstring>

#include "tests/support/folders.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/packets/packet_log.hpp"
#include "veridyn/io/read.hpp"

namespace veridyn::io {
namespace {

using ::testing::HasSubstr;

/// A NumPy array of float64.
std::string array_file(const std::vector<double>& values, const std::string& shape) {
  std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }";
  header.resize((10 + header.size() + 1 + 63) / 64 * 64 - 11, ' ');
  header += '\n';
  std::string file("\x93NUMPY\x01\x00", 8);
  file += static_cast<char>(header.size() % 256);
  file += static_cast<char>(header.size() / 256);
  file += header;
  file.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  return file;
}

/// A ZIP archive of these files, stored or deflated.
std::string archive(const std::vector<std::pair<std::string, std::string>>& files, bool deflate) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* buffer = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_t* zip = zip_open_from_source(buffer, ZIP_TRUNCATE, &error);
  zip_source_keep(buffer);
  for (const auto& [name, content] : files) {
    const zip_int64_t index =
        zip_file_add(zip, name.c_str(), zip_source_buffer(zip, content.data(), content.size(), 0), 0);
    zip_set_file_compression(zip, static_cast<zip_uint64_t>(index), deflate ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 0);
  }
  zip_close(zip);
  zip_source_open(buffer);
  zip_source_seek(buffer, 0, SEEK_END);
  std::string bytes(static_cast<std::size_t>(zip_source_tell(buffer)), '\0');
  zip_source_seek(buffer, 0, SEEK_SET);
  zip_source_read(buffer, bytes.data(), bytes.size());
  zip_source_close(buffer);
  zip_source_free(buffer);
  return bytes;
}

std::string drive(bool deflate) {
  return archive({{"t.npy", array_file({0.0, 0.1, 0.2}, "(3,)")},
                  {"speed.npy", array_file({1.0, 2.0, 3.0}, "(3,)")},
                  {"acc.npy", array_file({1, 2, 3, 4, 5, 6}, "(3, 2)")},
                  {"other.npy", array_file({1.0, 2.0}, "(2,)")},
                  {"driver.txt", "a name"}},
                 deflate);
}

TEST(Npz, FindsStampsByTheirNameOrAsTheStudySays) {
  const std::string bytes = archive({{"Time_ms.npy", array_file({0, 20, 40}, "(3,)")},
                                     {"clock.npy", array_file({1, 2, 3}, "(3,)")},
                                     {"p.npy", array_file({5, 6, 7}, "(3,)")}},
                                    true);
  const auto times = [&](const TableOptions& options) { return *read_npz(bytes, "a.npz", options).topics[0].time; };
  EXPECT_THAT(times({}), ::testing::ElementsAre(0.0, 0.02, 0.04));
  EXPECT_THAT(times({.time_column = "clock", .time_unit = "s"}), ::testing::ElementsAre(1.0, 2.0, 3.0));
  EXPECT_THAT(times({.rate = 2.0}), ::testing::ElementsAre(0.0, 0.5, 1.0));
  EXPECT_THAT(why([&] { static_cast<void>(times({.time_column = "cloc"})); }),
              HasSubstr("a.npz: no column 'cloc' for the time (did you mean 'clock'?)"));
}

TEST(Npz, ArraysWithStampsAreChannels) {
  for (const bool deflate : {false, true}) {
    const Log log = read_npz(drive(deflate), "drive.npz");
    const Recording r = to_recording(log);
    EXPECT_EQ(r.at("speed").value, (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(r.at("acc[1]").value, (std::vector<double>{2, 4, 6}));
    EXPECT_EQ(r.at("acc[0]").times()[2], 0.2);
    EXPECT_FALSE(r.has("other"));
    ASSERT_EQ(log.damage.notes.size(), 2u);
    EXPECT_THAT(log.damage.notes[0], HasSubstr("driver.txt"));
    EXPECT_THAT(log.damage.notes[1], HasSubstr("other"));
  }
}

TEST(Npz, DamageIsRefusedInOneLineWithItsPlace) {
  const auto refused = [](const std::string& bytes) { return why([&] { (void)read_npz(bytes, "drive.npz"); }); };
  const std::string whole = drive(true);
  for (std::size_t n = 0; n < whole.size(); n += 7) {
    const std::string text = refused(whole.substr(0, n));
    EXPECT_THAT(text, HasSubstr("drive.npz")) << n;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
  std::string stored = drive(false);
  stored[stored.find("NUMPY") + 125] ^= 1;  // in the values of t
  EXPECT_THAT(refused(stored), HasSubstr("drive.npz: t.npy: is damaged: CRC"));
  EXPECT_THAT(refused(archive({{"a.npy", array_file({1.0}, "(1,)")}}, true)), HasSubstr("no array of stamps"));
  EXPECT_THAT(refused(archive({{"readme.txt", "hello"}}, true)), HasSubstr("no array of numbers: readme.txt"));
  EXPECT_THAT(refused(archive({{"a.npy", "hello"}}, true)), HasSubstr("a.npy"));
}

/// Packets of a car that circles on level ground at 10 m/s, a radius of 20 m, to the left, in the game's axes.
std::string packets(std::size_t count) {
  std::string bytes;
  for (std::size_t k = 0; k < count; ++k) {
    std::array<float, 66> p{};
    const double t = 5.0 + 0.016 * static_cast<double>(k), heading = 0.5 * t;
    // x, y, z of the world are the game's x, -z, y.
    const auto put = [&](std::size_t at, double x, double y, double z) {
      p[at] = static_cast<float>(x);
      p[at + 1] = static_cast<float>(z);
      p[at + 2] = static_cast<float>(-y);
    };
    p[0] = static_cast<float>(t);
    put(4, 20.0 * std::sin(heading), -20.0 * std::cos(heading), 0.0);
    p[7] = 10.0F;
    put(8, 10.0 * std::cos(heading), 10.0 * std::sin(heading), 0.0);
    put(11, std::sin(heading), -std::cos(heading), 0.0);
    put(14, std::cos(heading), std::sin(heading), 0.0);
    p[34] = static_cast<float>(5.0 / kGravity);
    bytes.append(reinterpret_cast<const char*>(p.data()), sizeof p);
  }
  return bytes;
}

TEST(Codemasters, ACircleToTheLeftHasItsAccelerationToTheLeft) {
  const std::string bytes = packets(300);
  ASSERT_EQ(packets_in(bytes), &known_packet("codemasters"));
  const Log log = packet_log(*packets_in(bytes), bytes, "drive.f32");
  const Recording r = to_recording(log);
  EXPECT_EQ(r.frame, Frame::kFlu);
  for (const std::size_t k : {20U, 150U, 280U}) {
    EXPECT_NEAR(r.at("accel_y").value[k], 5.0, 1e-6);
    EXPECT_NEAR(r.at("accel_x").value[k], 0.0, 1e-6);
    EXPECT_NEAR(r.at("accel_z").value[k], 0.0, 1e-3);
    EXPECT_NEAR(r.at("gyro_z").value[k], 0.5, 1e-3);
    EXPECT_NEAR(r.at("gyro_x").value[k], 0.0, 1e-3);
    EXPECT_NEAR(r.at("roll").value[k], 0.0, 1e-6);
    EXPECT_NEAR(std::remainder(r.at("yaw").value[k] - 0.5 * r.at("yaw").times()[k], 2.0 * kPi), 0.0, 1e-5);
  }
  EXPECT_EQ(packets_in(std::string(264 * 20, '\0')), nullptr);
  EXPECT_EQ(packets_in(bytes.substr(1)), nullptr);
}

TEST(Codemasters, TheArchiveAndThePacketsOfARealDriveAreTheSame) {
  const std::filesystem::path folder = test::shared_folder() / "data" / "vehicle" / "dirt_rally_2";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder << "; ACircleToTheLeft... is without it";
  const Recording npz = read_recording(folder / "default.npz"), raw = read_recording(folder / "default_packets.f32");
  ASSERT_EQ(npz.channels().size(), raw.channels().size());
  for (const Channel& c : npz.channels()) EXPECT_EQ(c.value, raw.at(c.name).value) << c.name;
  EXPECT_NEAR(npz.at("accel_x").span().duration(), 202.5, 0.1);
  EXPECT_NEAR(npz.at("accel_x").rate_Hz(), 60.0, 8.0);
  // The game's own lateral g points where the derived yaw rate turns; a car that slides does not do more.
  const auto& ay = npz.at("accel_y").value;
  const auto &u = npz.at("speed").value, &r = npz.at("gyro_z").value, &yaw = npz.at("yaw").value;
  double xy = 0.0, xx = 0.0, yy = 0.0, turned = 0.0, worst = 0.0, unwrapped = yaw[0];
  for (std::size_t k = 0; k < ay.size(); ++k) {
    const double expected = u[k] * r[k];
    xy += expected * ay[k];
    xx += expected * expected;
    yy += ay[k] * ay[k];
    if (k == 0) continue;
    const double step = npz.at("yaw").times()[k] - npz.at("yaw").times()[k - 1];
    turned += 0.5 * step * (r[k] + r[k - 1]);
    unwrapped += std::remainder(yaw[k] - yaw[k - 1], 2.0 * kPi);
    worst = std::max(worst, std::abs(unwrapped - yaw[0] - turned));
  }
  EXPECT_GT(xy / std::sqrt(xx * yy), 0.7);
  // On slopes of up to 14 deg the yaw rate in the body is not quite the yaw angle's.
  EXPECT_LT(worst, 0.1);
}

}  // namespace
}  // namespace veridyn::io
