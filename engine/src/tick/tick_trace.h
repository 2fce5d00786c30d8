// Every intermediate value of a tick under its name, stage by stage: what tells where two machines part.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lumbrical/tick.h"
#include "tick/fields.h"

namespace lumbrical {

/// One number of one stage. Where it belongs to a pair, the indices say which.
struct TraceValue {
  std::string field;            ///< "primitive[2].end1.x", "area", "held.segment[3].force.x"
  std::int64_t primitive = -1;  ///< -1: none
  std::int64_t triangle = -1;   ///< -1: none
  NumberType type = NumberType::real;
  std::uint64_t bits = 0;

  /// The same number of the same thing; its bits may differ.
  [[nodiscard]] bool same_place(const TraceValue& other) const;
};

/// The values of a stage of the last tick on `scratch`, in a fixed order; `output` is what that tick returned
/// for `frame` and the objects' `given`. All that the stage's hash covers.
std::vector<TraceValue> trace_stage(const Scratch& scratch, const DeviceFrame& frame,
                                    std::span<const ObjectFrame> given, const ActuatorFrame& output,
                                    Stage stage);

/// The values of a state, in a fixed order.
std::vector<TraceValue> trace_state(const State& state);

/// How many representable numbers lie between two values of the same type, plus one; 0 where they are equal
/// (+0 and -0 are not: 1). Nothing where a NaN or a whole number is among them.
std::optional<std::uint64_t> ulps_between(NumberType type, std::uint64_t a, std::uint64_t b);

}  // namespace lumbrical
