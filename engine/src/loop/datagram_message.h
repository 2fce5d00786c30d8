// The sink's side of schemas/datagram.fbs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lumbrical/datagram_wire.h"

namespace lumbrical {

void write_command(std::uint64_t session, const WireCommand& command, std::size_t actuator_count,
                   std::vector<std::byte>& datagram);

/// False: no feedback, or not of that session.
bool read_feedback(std::span<const std::byte> datagram, std::uint64_t session, std::uint64_t& cycle,
                   WireAnswer& answer);

}  // namespace lumbrical
