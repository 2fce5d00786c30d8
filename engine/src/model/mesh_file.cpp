// Reads mesh files: tells the format, calls its reader, converts the unit.
#include <filesystem>
#include <new>

#include "base/floating_point.h"
#include "base/packed_content.h"
#include "base/text_cursor.h"
#include "base/whole_file.h"
#include "model/mesh_formats.h"
#include "model/scene_check.h"

namespace lumbrical {
namespace {

constexpr const char* kFormats = "OBJ, STL, PLY, OFF and glTF are read";

enum class Format : std::uint8_t { unknown, obj, stl, ply, off, gltf };

/// ".obj" of "Mug.OBJ"; empty where the name has no dot.
std::string extension_of(const std::string& name) {
  const std::size_t dot = name.find_last_of("./\\");
  return dot != std::string::npos && name[dot] == '.' ? lower_case(std::string_view(name).substr(dot)) : "";
}

Format format_of_name(const std::string& name) {
  const std::string extension = extension_of(name);
  if (extension == ".obj") return Format::obj;
  if (extension == ".stl") return Format::stl;
  if (extension == ".ply") return Format::ply;
  if (extension == ".off") return Format::off;
  if (extension == ".gltf" || extension == ".glb") return Format::gltf;
  return Format::unknown;
}

Format format_of_content(std::string_view content) {
  if (is_stl_content(content)) return Format::stl;
  if (content.substr(0, 4) == "glTF") return Format::gltf;
  TextCursor cursor(content, {.hash_comments = true});
  cursor.next_line();
  const std::string_view word = cursor.word();
  if (word == "ply") return Format::ply;
  if (is_off_keyword(word)) return Format::off;
  for (const std::string_view keyword : {"v", "vn", "vt", "vp", "f", "g", "o", "s", "mtllib", "usemtl"}) {
    if (word == keyword) return Format::obj;
  }
  if (word.substr(0, 1) == "{" && content.find("\"asset\"") != std::string_view::npos) return Format::gltf;
  return Format::unknown;
}

// Formats that people have and that are not read, by their file names or their first bytes, and the way out.
struct Foreign {
  std::string_view extension, start;
  const char* what;
};

constexpr Foreign kForeign[] = {
    {".fbx", "Kaydara FBX", "FBX is not read; open it in Blender and export glTF or OBJ"},
    {".blend", "BLENDER", "Blender's own format is not read; export glTF or OBJ from it"},
    {".dae", "", "COLLADA is not read; open it in Blender and export glTF or OBJ"},
    {".3mf", "", "3MF is not read; export STL from the program that wrote it"},
    {".step", "ISO-10303-21", "STEP has surfaces, no triangles; export STL or glTF from a CAD program"},
    {".stp", "", "STEP has surfaces, no triangles; export STL or glTF from a CAD program"},
    {".iges", "", "IGES has surfaces, no triangles; export STL or glTF from a CAD program"},
    {".igs", "", "IGES has surfaces, no triangles; export STL or glTF from a CAD program"},
    {".usd", "PXR-USDC", "USD is not read; open it in Blender and export glTF or OBJ"},
    {".usda", "#usda", "USD is not read; open it in Blender and export glTF or OBJ"},
    {".usdz", "", "USD is not read; open it in Blender and export glTF or OBJ"},
    {".3ds", "", "3DS is not read; open it in Blender and export glTF or OBJ"},
    {".wrl", "#VRML", "VRML is not read; open it in MeshLab and export PLY or OBJ"},
    {".x3d", "", "X3D is not read; open it in MeshLab and export PLY or OBJ"},
    {".vtk", "# vtk", "VTK is not read; open it in ParaView and export PLY or STL"},
    {".drc", "DRACO", "Draco is not read; decompress it to PLY or OBJ"},
    {".msh", "$MeshFormat", "Gmsh's format is not read; export STL or PLY from Gmsh"},
    {".npz", "", "NumPy arrays are not read; write vertices and faces as OBJ or PLY (trimesh does it)"},
    {".pkl", "", "pickled models (MANO, SMPL) are not read; write vertices and faces as OBJ or PLY"},
};

/// What to do with a file of another format; null where it is of none that is known. A '#' opens comments of
/// ours, too: it tells nothing where the name tells a format that is read.
const char* foreign_format(std::string_view content, const std::string& name) {
  const std::string extension = extension_of(name);
  for (const Foreign& format : kForeign) {
    if (extension == format.extension) return format.what;
    if (format.start.empty() || (format.start[0] == '#' && format_of_name(name) != Format::unknown)) continue;
    if (content.substr(0, format.start.size()) == format.start) return format.what;
  }
  return nullptr;
}

/// The content tells first, because names lie; the name helps where the content says nothing.
Status parse_in_file_units(std::string_view content, const std::string& name, const std::string& folder,
                           Mesh& mesh) {
  if (content.empty()) return Status::error(name + ": the file is empty");
  Format format = format_of_content(content);
  if (format == Format::unknown) {
    const char* what = foreign_format(content, name);
    if (what == nullptr) what = how_to_unpack(content);
    if (what != nullptr) return Status::error(name + ": " + what);
    format = format_of_name(name);
  }
  switch (format) {
    case Format::obj:
      return parse_obj(content, name, mesh);
    case Format::stl:
      return parse_stl(content, name, mesh);
    case Format::ply:
      return parse_ply(content, name, mesh);
    case Format::off:
      return parse_off(content, name, mesh);
    case Format::gltf:
      return parse_gltf(content, name, folder, mesh);
    case Format::unknown:
      break;
  }
  return Status::error(name + ": neither the content nor the name tells the format; " + kFormats);
}

Status check_size(const Mesh& mesh, const std::string& name) {
  if (mesh.triangles.empty())
    return Status::error(name + ": the file has no triangles; export the mesh with faces");
  if (mesh.triangles.size() >= kTriangleLimit) {
    return Status::error(name + ": 2^31 triangles or more; split the mesh");
  }
  return {};
}

Status out_of_memory(const std::string& name) {
  return Status::error(name + ": not enough memory for this mesh; split or simplify it");
}

Status parse_from(std::string_view content, const std::string& name, const std::string& folder, Unit unit,
                  Mesh& mesh) {
  const FloatingPointGuard guard;
  try {
    Mesh parsed;
    if (Status status = parse_in_file_units(content, name, folder, parsed); !status.ok()) return status;
    if (Status status = check_size(parsed, name); !status.ok()) return status;
    convert_to_metres(unit, parsed);
    mesh = std::move(parsed);
    return {};
  } catch (const std::bad_alloc&) {
    return out_of_memory(name);
  }
}

}  // namespace

// Divides, because x / 1000 is the double nearest to the true value and x * 0.001 is not. The readers have
// refused what is not finite, and a division by more than 1 keeps it finite.
void convert_to_metres(Unit unit, Mesh& mesh) {
  if (unit == Unit::metre) return;
  const double per_metre = unit == Unit::centimetre ? 100.0 : 1000.0;
  for (Vec3& point : mesh.vertices) point = point / per_metre;
}

std::optional<Unit> parse_unit(std::string_view text) {
  if (text == "m") return Unit::metre;
  if (text == "cm") return Unit::centimetre;
  if (text == "mm") return Unit::millimetre;
  return std::nullopt;
}

double metres_per(Unit unit) {
  switch (unit) {
    case Unit::millimetre:
      return 0.001;
    case Unit::centimetre:
      return 0.01;
    case Unit::metre:
      break;
  }
  return 1;
}

Status parse_mesh(std::string_view content, const std::string& name, Unit unit, Mesh& mesh) {
  return parse_from(content, name, "", unit, mesh);
}

Status load_mesh(const std::string& path, Unit unit, Mesh& mesh) {
  std::string content;
  if (Status status = read_whole_file(path, kLargestMeshFile, "a mesh file", content); !status.ok())
    return status;
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return parse_from(content, shown_name(path), folder.empty() ? "." : folder, unit, mesh);
}

}  // namespace lumbrical
