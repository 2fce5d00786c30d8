// OpenVDB takes forty milliseconds of a program's start and gives it four threads, so it is loaded only when
// a grid is first asked for: the module is looked for beside the program or library that holds this, in the
// folder of libraries of the same installation, and where the system looks.
#include "index/voxel_grid.h"

#include <dlfcn.h>

#include <filesystem>
#include <string>

namespace lumbrical {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = LUMBRICAL_VOXEL_MODULE;
constexpr const char* kFunction = "lumbrical_voxel_grid_module";

fs::path own_folder() {
  static const int here = 0;
  Dl_info holder{};
  if (dladdr(&here, &holder) == 0) return {};
  std::error_code ignored;
  return fs::canonical(holder.dli_fname, ignored).parent_path();
}

struct Loading {
  const VoxelGridModule* module = nullptr;
  std::string refusal;
};

// Never unloaded: what it made may live as long as the process.
void* open_module() {
  std::error_code ignored;
  const fs::path folder = own_folder();
  for (const fs::path& file : {folder / kFile, folder / LUMBRICAL_LIBRARIES / kFile}) {
    if (fs::exists(file, ignored)) return dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  }
  return dlopen(kFile, RTLD_NOW | RTLD_LOCAL);
}

Loading load() {
  void* const file = open_module();
  void* const function = file == nullptr ? nullptr : dlsym(file, kFunction);
  if (function == nullptr) {
    const char* const reason = dlerror();
    return {nullptr, reason == nullptr ? std::string(kFile) + " is of another kind" : reason};
  }
  return {reinterpret_cast<const VoxelGridModule* (*)()>(function)(), {}};
}

const Loading& loaded() {
  static const Loading loading = load();
  return loading;
}

Status not_loaded() {
  return Status::error("the voxel index can't be loaded (" + loaded().refusal + "); put " + kFile +
                       " beside the program and install OpenVDB's library, or use broadphase tree or grid");
}

}  // namespace

bool has_openvdb() { return loaded().module != nullptr; }

Status make_distance_field(const Triangles& triangles, const VoxelLists& lists, DistanceField& field) {
  return has_openvdb() ? loaded().module->distance_field(triangles, lists, field) : not_loaded();
}

Status make_voxel_grid(const VoxelLists& lists, const DistanceField& field,
                       std::shared_ptr<const VoxelGrid>& grid) {
  return has_openvdb() ? loaded().module->grid(lists, field, grid) : not_loaded();
}

}  // namespace lumbrical
