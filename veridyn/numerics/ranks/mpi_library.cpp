#include "veridyn/numerics/ranks/mpi_library.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <stdexcept>

#include "veridyn/core/error.hpp"

namespace veridyn::numerics {
namespace {

InputError without_mpi(const char* file) {
  const char* why = dlerror();
  return InputError(file, fmt::format("several processes were started, but this program has no MPI ({}); build it with "
                                      "Open MPI (libopenmpi-dev, VERIDYN_MPI=ON), or start one process",
                                      why != nullptr ? why : "the file is damaged"));
}

MpiLibrary load_mpi_library(const char* file) {
  // Never closed: MPI's libraries do not bear it. Global: MPI loads parts of itself that look for its names.
  void* library = dlopen(file, RTLD_NOW | RTLD_GLOBAL);
  void* entry = library == nullptr ? nullptr : dlsym(library, kMpiLibraryEntry);
  if (entry == nullptr) throw without_mpi(file);
  MpiLibrary functions;
  reinterpret_cast<MpiLibraryEntry>(entry)(functions);
  return functions;
}

class MpiTransport final : public RankTransport {
 public:
  explicit MpiTransport(const char* file) : mpi_(load_mpi_library(file)) {
    std::string error;
    require(mpi_.start(rank_, size_, error), error);
  }
  [[nodiscard]] std::size_t rank() const override { return rank_; }
  [[nodiscard]] std::size_t size() const override { return size_; }
  void send(std::size_t to, int channel, std::span<const double> message) override {
    std::string error;
    require(mpi_.send(to, channel, message.data(), message.size(), error), error);
  }
  [[nodiscard]] bool receive(std::size_t from, int channel, std::vector<double>& message) override {
    std::string error;
    bool there = false;
    require(mpi_.receive(from, channel, message, there, error), error);
    return there;
  }
  [[nodiscard]] bool delivered() override {
    std::string error;
    bool all = false;
    require(mpi_.delivered(all, error), error);
    return all;
  }
  void close() override { mpi_.close(); }

 private:
  static void require(bool good, const std::string& error) {
    if (!good) throw std::runtime_error("MPI: " + error);
  }

  MpiLibrary mpi_;
  std::size_t rank_ = 0, size_ = 1;
};

}  // namespace

std::shared_ptr<RankTransport> mpi_transport(const char* file) { return std::make_shared<MpiTransport>(file); }

}  // namespace veridyn::numerics
