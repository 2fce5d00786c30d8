// World files without the zeros between their arrays, for a fuzzer to change, and back.
#pragma once

#include <algorithm>
#include <cstring>
#include <span>
#include <vector>

#include "files/world_format.h"

namespace lumbrical::test {

/// The file's end, then what its arrays hold.
inline std::vector<std::uint8_t> input_from_world(std::span<const std::uint8_t> file) {
  WorldEnd end;
  std::memcpy(&end, file.data() + file.size() - kPageSize, sizeof(end));
  const WorldLayout layout = layout_of(end);
  std::vector<std::uint8_t> input(sizeof(end));
  std::memcpy(input.data(), &end, sizeof(end));
  for (std::size_t section = 0; section < kHashes; ++section) {
    const auto begin = file.begin() + static_cast<std::ptrdiff_t>(layout.offset[section]);
    input.insert(input.end(), begin, begin + static_cast<std::ptrdiff_t>(layout.bytes[section]));
  }
  return input;
}

/// The file of such an input, with its hashes; empty where it would be large.
inline std::vector<std::uint8_t> world_from_input(std::span<const std::uint8_t> input) {
  constexpr std::uint64_t kMost = 1000;
  WorldEnd end;
  if (input.size() < sizeof(end)) return {};
  std::memcpy(&end, input.data(), sizeof(end));
  input = input.subspan(sizeof(end));
  for (const std::uint64_t count :
       {end.vertices, end.triangles, end.lines, end.cells, end.objects, end.name_bytes})
    if (count > kMost) return {};
  const WorldLayout layout = layout_of(end);
  std::vector<std::uint8_t> file(layout.end + kPageSize);
  std::memcpy(file.data(), &kWorldMagic, sizeof(kWorldMagic));
  for (std::size_t section = 0; section < kHashes; ++section) {
    const std::size_t size = std::min<std::size_t>(layout.bytes[section], input.size());
    if (size > 0) std::memcpy(file.data() + layout.offset[section], input.data(), size);
    input = input.subspan(size);
  }
  std::vector<std::uint64_t> hashes;
  const std::uint64_t all = layout.offset[kHashes];
  for (std::uint64_t first = 0; first < all; first += kHashPiece)
    hashes.push_back(hash_of_bytes(file.data() + first, std::min<std::uint64_t>(kHashPiece, all - first)));
  std::memcpy(file.data() + layout.offset[kHashes], hashes.data(), 8 * hashes.size());
  end.content = content_of(end, hashes.data(), hashes.size());
  std::memcpy(file.data() + layout.end, &end, sizeof(end));
  return file;
}

}  // namespace lumbrical::test
