#include "index/voxel_cache.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <new>
#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include "base/hash.h"

namespace lumbrical {
namespace {

constexpr std::uint64_t kMagic =
    0x315845444e58564cu;  // "LVXNDEX1"; a new number with every change of the format

struct Header {
  std::uint64_t magic = kMagic;
  std::uint64_t source = 0;   // hash of what the index was made from
  std::uint64_t content = 0;  // hash of all that follows
  double origin[3] = {0, 0, 0};
  double voxel_size = 0;
  std::uint64_t voxels = 0, entries = 0, wide = 0, field = 0;  // lengths of the arrays that follow
};
static_assert(sizeof(Header) == 11 * 8);

// Calls visit(array) for each array in the file's order.
template <class Lists, class Field, class Visit>
bool for_each_array(Lists& lists, Field& field, const Visit& visit) {
  return visit(lists.key) && visit(lists.voxel) && visit(lists.triangle) && visit(lists.wide) &&
         visit(field.key) && visit(field.value);
}

std::uint64_t hash_of_content(const Header& header, const VoxelLists& lists, const DistanceField& field) {
  Hasher hasher;
  for (const double number : header.origin) hasher.value(number);
  hasher.value(header.voxel_size);
  for (const std::uint64_t length : {header.voxels, header.entries, header.wide, header.field})
    hasher.value(length);
  for_each_array(lists, field, [&](const auto& array) {
    hasher.array(array);
    return true;
  });
  return hasher.digest();
}

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

std::string system_words(int error) { return std::generic_category().message(error); }

Status rejected(const std::string& path, const std::string& why) {
  return Status::error(path + ": is not used, because " + why);
}

bool is_ascending(const std::vector<std::uint64_t>& keys) {
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i] <= keys[i - 1]) return false;
  }
  return keys.empty() || keys.back() < std::uint64_t{1} << 63;
}

bool are_below(const std::vector<std::uint32_t>& triangles, std::size_t count) {
  for (const std::uint32_t triangle : triangles) {
    if (triangle >= count) return false;
  }
  return true;
}

// A search that finds a triangle twice would have it felt twice.
bool are_found_once(const VoxelLists& lists, std::size_t triangles) {
  std::vector<bool> found(triangles, false);
  const auto is_first = [&](std::uint32_t triangle) {
    const bool first = !found[triangle];
    found[triangle] = true;
    return first;
  };
  for (const Voxel& voxel : lists.voxel) {
    for (std::uint32_t i = voxel.first; i < voxel.others; ++i)
      if (!is_first(lists.triangle[i])) return false;
  }
  return std::all_of(lists.wide.begin(), lists.wide.end(), is_first);
}

// Nothing that passes can lead a search out of an array, or to a triangle twice.
bool is_sound(const VoxelLists& lists, const DistanceField& field, std::size_t triangles) {
  const bool sizes = lists.voxel_size > 0 && std::isfinite(lists.voxel_size) && is_finite(lists.origin);
  if (!sizes || !is_ascending(lists.key) || !is_ascending(field.key)) return false;
  std::uint32_t last = 0;
  for (const Voxel& voxel : lists.voxel) {
    if (voxel.first < last || voxel.others < voxel.first || !(voxel.reach <= 1e6f)) return false;
    last = voxel.others;
  }
  for (const float value : field.value) {
    if (!std::isfinite(value)) return false;
  }
  return lists.voxel.back().first == last && last == lists.triangle.size() &&
         are_below(lists.triangle, triangles) && are_below(lists.wide, triangles) &&
         are_found_once(lists, triangles);
}

// Lengths that fit the file's size, so that no one is asked for memory that the file doesn't fill.
bool lengths_fit(const Header& header, std::uintmax_t size) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 40;
  for (const std::uint64_t length : {header.voxels, header.entries, header.wide, header.field}) {
    if (length > kMost) return false;
  }
  const std::uint64_t bytes = sizeof(Header) + header.voxels * (sizeof(std::uint64_t) + sizeof(Voxel)) +
                              sizeof(Voxel) + (header.entries + header.wide) * sizeof(std::uint32_t) +
                              header.field * (sizeof(std::uint64_t) + sizeof(float));
  return bytes == size;
}

Status read(const std::string& path, std::uint64_t source, std::size_t triangles, VoxelLists& lists,
            DistanceField& field) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return rejected(path, "it is no regular file");
  const File file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) return rejected(path, "it can't be opened: " + system_words(errno));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return rejected(path, "it is no regular file");
  Header header;
  if (std::fread(&header, sizeof(header), 1, file.get()) != 1) return rejected(path, "it is too short");
  if (header.magic != kMagic) return rejected(path, "it is no voxel index of this version");
  if (header.source != source) return rejected(path, "it was made from another scene or with other settings");
  if (!lengths_fit(header, size))
    return rejected(path, "it is cut or damaged: its size is not the one it tells");
  lists.origin = {header.origin[0], header.origin[1], header.origin[2]};
  lists.voxel_size = header.voxel_size;
  lists.key.resize(header.voxels);
  lists.voxel.resize(header.voxels + 1);
  lists.triangle.resize(header.entries);
  lists.wide.resize(header.wide);
  field.key.resize(header.field);
  field.value.resize(header.field);
  const bool whole = for_each_array(lists, field, [&](auto& array) {
    return std::fread(array.data(), sizeof(array[0]), array.size(), file.get()) == array.size();
  });
  if (!whole) return rejected(path, "it is cut");
  if (header.content != hash_of_content(header, lists, field))
    return rejected(path, "its content is damaged");
  if (!is_sound(lists, field, triangles)) return rejected(path, "its lists contradict themselves");
  for (const Voxel& voxel : lists.voxel) lists.reach = voxel.reach > lists.reach ? voxel.reach : lists.reach;
  return {};
}

Status not_written(const std::string& path, const std::string& why) {
  return Status::error(path + ": the voxel index is not kept, because " + why);
}

}  // namespace

std::uint64_t hash_of_source(const Triangles& triangles, const Execution& execution) {
  Hasher hasher;
  hasher.value(kMagic);
  hasher.value(execution.voxel_size);
  for (const auto* numbers : {&triangles.x, &triangles.y, &triangles.z})
    hasher.array(std::span<const double>(*numbers));
  for (const auto* corners : {&triangles.a, &triangles.b, &triangles.c})
    hasher.array(std::span<const std::uint32_t>(*corners));
  return hasher.digest();
}

std::string cache_path(const std::string& folder, std::uint64_t source) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "%016llx.voxels", static_cast<unsigned long long>(source));
  return (std::filesystem::path(folder) / name.data()).string();
}

Status read_voxel_cache(const std::string& path, std::uint64_t source, std::size_t triangles,
                        VoxelLists& lists, DistanceField& field) {
  VoxelLists read_lists;
  DistanceField read_field;
  try {
    if (Status status = read(path, source, triangles, read_lists, read_field); !status.ok()) return status;
  } catch (const std::bad_alloc&) {
    return rejected(path, "there is not enough memory for it");
  }
  lists = std::move(read_lists);
  field = std::move(read_field);
  return {};
}

Status write_voxel_cache(const std::string& path, std::uint64_t source, const VoxelLists& lists,
                         const DistanceField& field) {
  Header header;
  header.source = source;
  header.origin[0] = lists.origin.x;
  header.origin[1] = lists.origin.y;
  header.origin[2] = lists.origin.z;
  header.voxel_size = lists.voxel_size;
  header.voxels = lists.key.size();
  header.entries = lists.triangle.size();
  header.wide = lists.wide.size();
  header.field = field.key.size();
  header.content = hash_of_content(header, lists, field);
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), error);
  const std::string part = path + ".part";
  File file(std::fopen(part.c_str(), "wb"), &std::fclose);
  if (!file) return not_written(part, system_words(errno));
  bool whole = std::fwrite(&header, sizeof(header), 1, file.get()) == 1;
  whole = whole && for_each_array(lists, field, [&](const auto& array) {
            return std::fwrite(array.data(), sizeof(array[0]), array.size(), file.get()) == array.size();
          });
  whole = std::fclose(file.release()) == 0 && whole;
  if (whole) std::filesystem::rename(part, path, error);
  if (whole && !error) return {};
  const std::string why = error ? error.message() : system_words(errno);
  std::filesystem::remove(part, error);
  return not_written(path, why);
}

}  // namespace lumbrical
