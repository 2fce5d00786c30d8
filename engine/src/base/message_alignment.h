// What FlatBuffers' verifier leaves open: it sees to it that a vector's length is aligned, not its elements,
// and reading them elsewhere is undefined. No writer puts them there, so a message that does is damaged.
#pragma once

#include <cstdint>

#include "flatbuffers/flatbuffers.h"

namespace lumbrical {

/// Numbers of 8 bytes, or structs of such, can be read where they lie. The message itself is aligned; a
/// vector that is not there is fine.
template <class T>
bool is_aligned(const flatbuffers::Vector<T>* vector) {
  return vector == nullptr || vector->size() == 0 ||
         reinterpret_cast<std::uintptr_t>(vector->Data()) % sizeof(std::uint64_t) == 0;
}

}  // namespace lumbrical
