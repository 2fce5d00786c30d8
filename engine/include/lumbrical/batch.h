// Many independent jobs over all cores: poses, recordings. Results are those of one job after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lumbrical/tick.h"

namespace lumbrical {

/// Cores this process may use, at least 1.
std::uint32_t core_count();

/// Calls job(0) .. job(count - 1), each once, on up to `threads` threads (1 .. 64) and in any order; returns
/// when all are done. Jobs must not write what another one touches. In a build without oneTBB, one after the
/// other.
void run_jobs(std::size_t count, std::uint32_t threads, const std::function<void(std::size_t)>& job);

/// One tick for each of many poses that have nothing to do with each other, each from its own state, which
/// then is the one after it: output[i] = tick(model, state[i], scratch, frame[i]). All three must have the
/// same size. Forces rise from a new State within Settings::fade_time; where that is 0 they are there at
/// once. `scratch` is working memory, empty at first: up to four Scratches per thread are made in it, and are
/// there for the next call with this model. A model with Execution::threads above 1 shares out single ticks
/// as well.
void tick_each(const Model& model, std::span<const DeviceFrame> frame, std::span<State> state,
               std::span<ActuatorFrame> output, std::uint32_t threads, std::vector<Scratch>& scratch);

}  // namespace lumbrical
