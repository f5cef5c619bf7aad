// libveridyn_mpi.so: the only source that includes MPI.
#include <mpi.h>

#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "veridyn/numerics/ranks/mpi_library.hpp"

namespace {

/// A message on its way, which MPI reads until it is handed over.
struct Sent {
  std::vector<double> values;
  MPI_Request request = MPI_REQUEST_NULL;
};

// What MPI itself is: one in a process.
std::mutex mutex;
std::list<Sent> on_their_way;

bool good(int code, std::string& error) {
  if (code == MPI_SUCCESS) return true;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(code, text, &length);
  error.assign(text, static_cast<std::size_t>(length));
  return false;
}

/// Forgets those that are handed over.
bool sweep(std::string& error) {
  for (auto sent = on_their_way.begin(); sent != on_their_way.end();) {
    int done = 0;
    if (!good(MPI_Test(&sent->request, &done, MPI_STATUS_IGNORE), error)) return false;
    sent = done != 0 ? on_their_way.erase(sent) : std::next(sent);
  }
  return true;
}

bool start(std::size_t& rank, std::size_t& size, std::string& error) {
  int provided = 0, r = 0, s = 0;
  if (!good(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided), error)) return false;
  if (provided < MPI_THREAD_SERIALIZED) {
    error = "this MPI cannot be used on several threads";
    return false;
  }
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  if (!good(MPI_Comm_rank(MPI_COMM_WORLD, &r), error) || !good(MPI_Comm_size(MPI_COMM_WORLD, &s), error)) return false;
  rank = static_cast<std::size_t>(r);
  size = static_cast<std::size_t>(s);
  return true;
}

bool send(std::size_t to, int channel, const double* values, std::size_t count, std::string& error) {
  const std::lock_guard lock(mutex);
  if (!sweep(error)) return false;
  Sent& sent = on_their_way.emplace_back(Sent{.values = {values, values + count}});
  return good(MPI_Isend(sent.values.data(), static_cast<int>(count), MPI_DOUBLE, static_cast<int>(to), channel,
                        MPI_COMM_WORLD, &sent.request),
              error);
}

bool receive(std::size_t from, int channel, std::vector<double>& message, bool& there, std::string& error) {
  const std::lock_guard lock(mutex);
  int found = 0, count = 0;
  MPI_Status status;
  const int source = static_cast<int>(from);
  if (!good(MPI_Iprobe(source, channel, MPI_COMM_WORLD, &found, &status), error)) return false;
  there = found != 0;
  if (!there) return true;
  if (!good(MPI_Get_count(&status, MPI_DOUBLE, &count), error)) return false;
  message.resize(static_cast<std::size_t>(count));
  return good(MPI_Recv(message.data(), count, MPI_DOUBLE, source, channel, MPI_COMM_WORLD, MPI_STATUS_IGNORE), error);
}

bool delivered(bool& all, std::string& error) {
  const std::lock_guard lock(mutex);
  if (!sweep(error)) return false;
  all = on_their_way.empty();
  return true;
}

void close() {
  const std::lock_guard lock(mutex);
  MPI_Finalize();
}

}  // namespace

extern "C" __attribute__((visibility("default"))) void veridyn_mpi_library(veridyn::numerics::MpiLibrary& library) {
  library = {.start = start, .send = send, .receive = receive, .delivered = delivered, .close = close};
}
