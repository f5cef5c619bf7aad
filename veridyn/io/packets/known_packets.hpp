#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "veridyn/io/packets/packet_layout.hpp"

namespace veridyn::io {

/// The packets that are known by name. Where offsets and signs come from, in the order of `known_packets`:
/// - `outsim`, `outsim_id`, `outsim2`, `outgauge`, `outgauge_id`: Live for Speed's InSim.txt and OutSimPack.txt; World
///   axes east, north, up; velocity and acceleration are the world's, without gravity. The frame of its angular
///   velocity is not said, so that rates are derived from the attitude.
/// - `motion_68`: the packet of the platform program in the spec, as long as `outsim_id`: floats for the time [s].
/// - `codemasters`: `extradata="3"` of DiRT Rally and others, known from users and checked on recordings.
/// - `forza_sled`, `forza_dash`, `forza_horizon`, `forza_2023`: the maker's "Data Out": right, up, forward.
/// - `beamng`: MotionSim of BeamNG.drive; no time in it.
/// - `assetto_corsa`: `RTCarInfo` of its remote telemetry; accelerations in g, no attitude.
/// - `veridyn`: the project's own, see docs/formats.md: specific force, so gravity is in it.
[[nodiscard]] const std::vector<PacketLayout>& known_packets();

/// One of them. @throws InputError naming those that there are
[[nodiscard]] const PacketLayout& known_packet(std::string_view name);

/// OutSim2 with the parts that `OutSim Opts` in its cfg.txt asks for: 1 header, 2 ID, 4 time, 8 main, 16 inputs, 32
/// drive, 64 distance, 128 wheels, 256 extra.
[[nodiscard]] PacketLayout outsim2(std::uint32_t options);

}  // namespace veridyn::io
