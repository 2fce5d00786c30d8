// A tick record as a FlatBuffer (schemas/recording.fbs) and back, every bit of it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "lumbrical/recording.h"
#include "recording/record_fields.h"

namespace flatbuffers {
class FlatBufferBuilder;
}

namespace lumbrical {

inline constexpr const char* kTickSchemaName = "lumbrical.fb.Tick";
/// The binary schema that makes a file readable without this program.
std::span<const std::uint8_t> tick_schema();

/// Clears the builder and leaves the finished message in it. Joints or angles that hold their defaults take
/// no room, nor do the forces of a tick that is not to keep them. `after` is the state message of the state
/// it left, or empty.
void encode_tick(const TickRecord& record, bool keep_forces, const InputCheck& check,
                 flatbuffers::FlatBufferBuilder& builder, std::span<const std::uint8_t> after = {});

/// The state that a message says its tick left; none where it says none. It is the one whose hash the message
/// has, or an error.
Status decode_state_after(std::span<const std::uint8_t> bytes, std::optional<State>& after);

/// The error tells what is wrong, not where. `bytes` may come from anywhere and need no alignment.
Status decode_tick(std::span<const std::uint8_t> bytes, TickRecord& record, InputCheck& check);

/// Session time at which a tick takes place [ns], for a period of 1e9 / rate; the same on every machine.
std::uint64_t tick_time(std::uint64_t tick, double period);
/// The tick that takes place at a time [ns].
std::uint64_t tick_at(std::uint64_t time, double rate);

}  // namespace lumbrical
