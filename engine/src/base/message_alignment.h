// FlatBuffers reads its numbers in place and wants them aligned.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "flatbuffers/flatbuffers.h"

namespace lumbrical {

/// Whether a verifier takes bytes at all: it asserts that they are fewer than 2 GiB.
inline bool can_be_verified(std::span<const std::uint8_t> bytes) {
  return bytes.size() < FLATBUFFERS_MAX_BUFFER_SIZE;
}

/// The message in a copy of bytes that stand anywhere, or null.
template <class Message>
const Message* verified(std::span<const std::uint8_t> bytes, std::vector<std::uint64_t>& aligned) {
  if (!can_be_verified(bytes)) return nullptr;
  aligned.resize(bytes.size() / 8 + 1);  // never empty: memcpy wants a place
  if (!bytes.empty()) std::memcpy(aligned.data(), bytes.data(), bytes.size());
  const auto* const data = reinterpret_cast<const std::uint8_t*>(aligned.data());
  flatbuffers::Verifier verifier(data, bytes.size());
  return verifier.VerifyBuffer<Message>(nullptr) ? flatbuffers::GetRoot<Message>(data) : nullptr;
}

// The verifier sees to it that a vector's length is aligned, not its elements, and reading them elsewhere is
// undefined. No writer puts them there, so a message that does is damaged.

/// Numbers of 8 bytes, or structs of such, can be read where they lie. The message itself is aligned; a
/// vector that is not there is fine.
template <class T>
bool is_aligned(const flatbuffers::Vector<T>* vector) {
  return vector == nullptr || vector->size() == 0 ||
         reinterpret_cast<std::uintptr_t>(vector->Data()) % sizeof(std::uint64_t) == 0;
}

}  // namespace lumbrical
