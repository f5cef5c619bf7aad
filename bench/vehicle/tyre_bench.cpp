// One call of each tyre at combined slip and at no slip ratio, as the models of constant speed have it. A four-wheel
// model calls 16 a millisecond.
#include <benchmark/benchmark.h>

#include "tests/vehicle/tyre/small_tir.hpp"
#include "veridyn/vehicle/road/iso8608_road.hpp"
#include "veridyn/vehicle/tyre/fiala_tyre.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"
#include "veridyn/vehicle/tyre/simple_magic_formula.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace {

using namespace veridyn::vehicle;

template <typename Tyre>
void call(benchmark::State& state, const Tyre& tyre, double slip_ratio) {
  double alpha = 0.0;
  for (auto _ : state) {
    alpha = alpha > 0.15 ? 0.0 : alpha + 1e-5;
    benchmark::DoNotOptimize(tyre.forces(3500.0 + alpha, slip_ratio, alpha, 0.01));
  }
}

MagicFormulaTyre<double> from_file(CombinedSlip way) {
  MagicFormulaTyre<double> tyre = parse_tir(testing::small_tir(), "small").tyre;
  tyre.combined_slip = way;
  return tyre;
}

const LinearTyre<double> kLinear{60000.0, 100000.0, 1.0};
const FialaTyre<double> kFiala{};
const SimpleMagicFormulaTyre<double> kSimple{};
const MagicFormulaTyre<double> kWeighting = from_file(CombinedSlip::kWeighting);
const MagicFormulaTyre<double> kEquivalent = from_file(CombinedSlip::kEquivalentSlip);

BENCHMARK_CAPTURE(call, linear, kLinear, 0.02);
BENCHMARK_CAPTURE(call, fiala, kFiala, 0.02);
BENCHMARK_CAPTURE(call, simple_magic_formula, kSimple, 0.02);
BENCHMARK_CAPTURE(call, magic_formula_weighting, kWeighting, 0.02);
BENCHMARK_CAPTURE(call, magic_formula_weighting_no_slip_ratio, kWeighting, 0.0);
BENCHMARK_CAPTURE(call, magic_formula_equivalent_slip, kEquivalent, 0.02);
BENCHMARK_CAPTURE(call, magic_formula_equivalent_slip_no_slip_ratio, kEquivalent, 0.0);

void iso8608_height(benchmark::State& state) {
  const Iso8608Road road({});
  double x = 0.0;
  for (auto _ : state) {
    x += 0.02;
    benchmark::DoNotOptimize(road.height({x, 0.7, x, 0.7}));
  }
}
BENCHMARK(iso8608_height);

}  // namespace
