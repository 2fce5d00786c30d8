// See lumbrical/batch.h.
#include "lumbrical/batch.h"

#include <algorithm>
#include <cassert>
#include <thread>

#include "base/parallel.h"
#include "stages/feel_model.h"

namespace lumbrical {

std::uint32_t core_count() { return std::max(1u, std::thread::hardware_concurrency()); }

void run_jobs(std::size_t count, std::uint32_t threads, const std::function<void(std::size_t)>& job) {
  assert(threads >= 1 && threads <= 64);
  parallel_chunks(count, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) job(i);
  });
}

namespace {

Scratch batch_scratch(const Model& model) {
  Scratch scratch = make_scratch(model);
  scratch.hash_stages = false;
  scratch.keep_near = false;  // the next pose is another hand's
  return scratch;
}

}  // namespace

void tick_each(const Model& model, std::span<const DeviceFrame> frame, std::span<State> state,
               std::span<ActuatorFrame> output, std::uint32_t threads, std::vector<Scratch>& scratch) {
  assert(frame.size() == state.size() && frame.size() == output.size());
  // Every part has a scratch of its own; more parts than threads even out ticks that take longer.
  const std::size_t parts = std::min<std::size_t>(frame.size(), threads > 1 ? 4 * threads : 1);
  if (scratch.size() < parts) scratch.resize(parts);
  run_jobs(parts, threads, [&](std::size_t part) {
    Scratch& own = scratch[part];
    if (!is_made_for(model, own)) own = batch_scratch(model);
    const std::size_t first = frame.size() * part / parts, last = frame.size() * (part + 1) / parts;
    for (std::size_t i = first; i < last; ++i) output[i] = tick(model, state[i], own, frame[i]);
  });
}

}  // namespace lumbrical
