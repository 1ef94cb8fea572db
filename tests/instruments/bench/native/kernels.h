// SPDX-License-Identifier: GPL-3.0-or-later
// The hot kernels of the core, timed by Google Benchmark. Each is run over a batch of inputs that
// are drawn beforehand with fixed random numbers; a pass over the whole batch is one iteration, so
// that every repetition does exactly the same work. tests/instruments/bench/kernels.py runs the
// program and reads its JSON: the label names the item that items_per_second counts.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>

namespace spc::bench {

void add_walks();
void add_surfaces();
void add_closures();
void add_rays();
void add_glints();

inline constexpr uint32_t kBatch = 4096;

// Times `pass`, which does `items` pieces of work each time.
template <class Pass>
void time_passes(benchmark::State& state, const char* item, uint64_t items, const Pass& pass) {
    for (auto _ : state) pass();
    state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(items));
    state.SetLabel(item);
}

// Whether a kernel does what its name says; if not, the benchmark fails.
inline bool holds(benchmark::State& state, bool condition, const char* otherwise) {
    if (!condition) state.SkipWithError(otherwise);
    return condition;
}

inline double share(uint64_t part, uint64_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace spc::bench
