#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "veridyn/numerics/ranks/rank_transport.hpp"

namespace veridyn::numerics {

/// The functions of libveridyn_mpi.so, which is all that uses MPI. The program loads it where a launcher started it
/// together with others: MPI brings thirty libraries, of which no other start has a use. Nothing is thrown across its
/// border: what returns false has said in `error` why.
struct MpiLibrary {
  bool (*start)(std::size_t& rank, std::size_t& size, std::string& error) = nullptr;
  bool (*send)(std::size_t to, int channel, const double* values, std::size_t count, std::string& error) = nullptr;
  bool (*receive)(std::size_t from, int channel, std::vector<double>& message, bool& there,
                  std::string& error) = nullptr;
  bool (*delivered)(bool& all, std::string& error) = nullptr;
  void (*close)() = nullptr;
};

/// The library's only name: fills in the table above.
using MpiLibraryEntry = void (*)(MpiLibrary& library);
/// How it is called there.
inline constexpr const char* kMpiLibraryEntry = "veridyn_mpi_library";

/// Connects this process by MPI to those that a launcher started with it. Once in a process.
/// @param file  the library, for tests of what is said where it is missing
/// @throws InputError when the library cannot be loaded: the program was built without MPI; std::runtime_error when MPI
/// does not start.
[[nodiscard]] std::shared_ptr<RankTransport> mpi_transport(const char* file = "libveridyn_mpi.so");

}  // namespace veridyn::numerics
