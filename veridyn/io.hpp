#pragma once

/// Files in and out.
///
///     io::read_recording("flight.bin")            // a log of any known format: channels in SI
///     io::read_log(...)                           // the same as its topics, as they were written
///     io::log_formats()                           // which formats there are
///     io::write_csv(recording, "flight.csv")
///     io::to_json(estimate)                       // estimate.json, and
///     io::read_estimate("estimate.json")          // back
///     io::parse_storage, io::to_storage_text      // motions of OpenSim
///     io::PacketDecoder                           // packets of telemetry, one by one
///
/// Component `io`.

#include "veridyn/core.hpp"
#include "veridyn/io/log_formats.hpp"
#include "veridyn/io/opensim/storage.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"
#include "veridyn/io/read.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/io/tables/number_table.hpp"
