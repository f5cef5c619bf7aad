#include "veridyn/numerics/random.hpp"

#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_int_distribution.hpp>

#include "veridyn/core/assert.hpp"

namespace veridyn::numerics {

namespace {

/// Steele, Lea & Flood 2014: spreads neighbouring seeds over all 64 bits.
std::uint64_t split_mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// FNV-1a.
std::uint64_t hash(std::string_view name) {
  std::uint64_t h = 0xCBF29CE484222325ULL;
  for (const char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001B3ULL;
  return h;
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t number) : engine_(split_mix(split_mix(seed) ^ number)) {}

RandomStream::RandomStream(std::uint64_t seed, std::string_view name) : RandomStream(seed, split_mix(hash(name))) {}

double RandomStream::normal() { return boost::random::normal_distribution<double>()(engine_); }

double RandomStream::uniform() { return boost::random::uniform_01<double>()(engine_); }

std::uint64_t RandomStream::index(std::uint64_t count) {
  VERIDYN_ASSERT(count >= 1);
  return boost::random::uniform_int_distribution<std::uint64_t>(0, count - 1)(engine_);
}

}  // namespace veridyn::numerics
