// What lies behind a difference between a recording and its replay: the very number, and all numbers as text.
#pragma once

#include <string>

#include "lumbrical/recording.h"
#include "lumbrical/tick.h"

namespace lumbrical {

/// A tick that has just been run, with what it needs to be looked into.
struct TickRun {
  const Execution& execution;
  const State& after;
  const Scratch& scratch;
  const DeviceFrame& device;
  std::span<const ObjectFrame> given;
  const ActuatorFrame& output;
};

/// Runs the recorded tick once more in the plainest way (one number at a time, every triangle, one thread)
/// from the state `before` it. Where that gives the recorded hash of the stage that differs, the first
/// differing value, its owner and its distance go into `divergence`; otherwise it is left as it is.
Status name_difference(const Scene& recorded_scene, const State& before, const TickRecord& recorded,
                       const TickRun& replayed, Divergence& divergence);

/// Writes the values of one stage ("input" .. "limits", "state"; "output" is "limits"), or of all where
/// `stage` is empty: lines that begin with # tell the circumstances, all others may be compared.
Status write_trace(const std::string& path, const TickRun& run, const std::string& stage);

}  // namespace lumbrical
