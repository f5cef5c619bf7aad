// What a user of the installed library writes first: a built-in aircraft and a recording.
#include <cstdio>
#include <veridyn/aircraft.hpp>

int main() {
  const veridyn::aircraft::Subject subject = veridyn::aircraft::builtin_subject("unatrap");
  veridyn::Recording recording;
  recording.add(veridyn::make_channel("airspeed", "m/s", veridyn::make_time_base({0.0, 0.1}), {15.0, 15.5}));
  const veridyn::io::Log log = veridyn::io::read_csv(veridyn::io::to_csv(recording), "memory.csv");
  std::printf("%s: %.1f kg, %zu topic\n", subject.name.c_str(), subject.mass, log.topics.size());
  return subject.mass > 0.0 && log.topics.size() == 1 ? 0 : 1;
}
