// What a tool that does not know this project needs to label a tick's numbers.
#pragma once

#include <map>
#include <string>

namespace lumbrical {

/// Metadata of the channel "tick": names of segments, joints, angles and flags in their order, units by the
/// schema's names, and what log times are.
std::map<std::string, std::string> channel_metadata();

}  // namespace lumbrical
