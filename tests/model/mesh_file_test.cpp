// Mesh files of any format: detection, units, numbers, messages, files on disk, and that no damage crashes a
// reader.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "files.h"
#include "mesh_samples.h"

namespace lumbrical {
namespace {

// ---- What all formats share ----

TEST(MeshFile, ReadsTheSameSolidFromEveryFormat) {
  for (const Sample& sample : all_samples()) {
    SCOPED_TRACE(sample.name);
    expect_tetrahedron(parsed(sample.content, sample.name));
  }
}

TEST(MeshFile, BelievesTheContentMoreThanTheName) {
  for (const Sample& sample : all_samples()) {
    for (const char* name : {"x", "x.obj", "x.stl", "x.ply", "x.off", "x.glb", "/tmp.obj/x"}) {
      SCOPED_TRACE(sample.name + " as " + name);
      expect_tetrahedron(parsed(sample.content, name));
    }
  }
}

TEST(MeshFile, ReadsTextWithAnyLineEndsAndAByteOrderMark) {
  for (const Sample& sample :
       {Sample{"a.obj", kObj}, {"a.stl", kAsciiStl}, {"a.ply", kAsciiPly}, {"a.off", kOff}}) {
    for (const char* line_end : {"\n", "\r\n", "\r"}) {
      SCOPED_TRACE(sample.name);
      const std::string text = with_line_ends(sample.content, line_end);
      expect_tetrahedron(parsed(text, sample.name));
      expect_tetrahedron(parsed("\xEF\xBB\xBF" + text, sample.name));
    }
  }
}

TEST(MeshFile, ConvertsUnitsToTheNearestDouble) {
  const std::string triangle = "v 0.1 7 0\nv 1 3 0\nv 0 1 0.3\nf 1 2 3\n";
  EXPECT_EQ(parsed(triangle, "a.obj", Unit::metre).vertices[0], (Vec3{0.1, 7, 0}));
  EXPECT_EQ(parsed(triangle, "a.obj", Unit::centimetre).vertices[0], (Vec3{0.1 / 100, 0.07, 0}));
  EXPECT_EQ(parsed(triangle, "a.obj", Unit::millimetre).vertices[1], (Vec3{0.001, 0.003, 0}));
  EXPECT_EQ(parse_unit("m"), Unit::metre);
  EXPECT_EQ(parse_unit("cm"), Unit::centimetre);
  EXPECT_EQ(parse_unit("mm"), Unit::millimetre);
  EXPECT_EQ(parse_unit("inch"), std::nullopt);
  EXPECT_EQ(parse_unit(""), std::nullopt);
}

TEST(MeshFile, ReadsNumbersInAllTheirSpellings) {
  const Mesh mesh =
      parsed("v +1.5 -2e-007 .5\nv 1E+3 3. 1e-400\nv -0.0 2.2250738585072014e-308 0e999\nf 1 2 3\n", "a.obj");
  EXPECT_EQ(mesh.vertices[0], (Vec3{1.5, -2e-7, 0.5}));
  EXPECT_EQ(mesh.vertices[1], (Vec3{1000, 3, 0}));
  EXPECT_EQ(mesh.vertices[2], (Vec3{0, 2.2250738585072014e-308, 0}));
  const std::string tiny = "0." + std::string(400, '0') + "1";
  EXPECT_EQ(parsed("v " + tiny + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj").vertices[0].x, 0);
  EXPECT_EQ(parsed("v 5e-324 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj").vertices[0].x, 5e-324);
}

TEST(MeshFile, RefusesWhatIsNoFiniteNumberAtItsPlace) {
  const struct {
    const char *word, *what;
  } cases[] = {{"nan", "is not finite"},      {"-inf", "is not finite"},    {"1e999", "is too large"},
               {"-1e400", "is too large"},    {"1,5", "is not a number"},   {"0x10", "is not a number"},
               {"1.#IND", "is not a number"}, {"--1", "is not a number"},   {"1e", "is not a number"},
               {"+-1", "is not a number"},    {"1.2.3", "is not a number"}, {"abc", "is not a number"}};
  for (const auto& [word, what] : cases) {
    SCOPED_TRACE(word);
    expect_refusal(replaced(kObj, "v 0 1 0", std::string("v 0 ") + word + " 0"), "a.obj",
                   "a.obj:6:5: ", what);
    expect_refusal(replaced(kAsciiStl, "vertex 0 1 0", std::string("vertex 0 ") + word + " 0"), "a.stl",
                   "a.stl:5:13: ", what);
    expect_refusal(replaced(kAsciiPly, "9 0 2 7 8 1 0", std::string("9 0 2 7 8 ") + word + " 0"), "a.ply",
                   "a.ply:24:11: ", what);
    expect_refusal(replaced(kOff, "0 1 0 255", std::string("0 ") + word + " 0 255"), "a.off",
                   "a.off:7:3: ", what);
  }
  expect_refusal("v " + std::string(400, '9') + " 0 0\n", "a.obj", "a.obj:1:3: ", "...' is too large");
}

TEST(MeshFile, RefusesWhatIsNotFiniteInBinaryFilesAtItsByte) {
  std::string stl = binary_stl();
  const float infinity = static_cast<float>(kInfinity);
  std::memcpy(stl.data() + 84 + 50 + 12 + 4, &infinity, 4);
  expect_refusal(stl, "a.stl", "a.stl: byte 150: ", "triangle 1");
  for (const bool big : {false, true}) {
    std::string ply = binary_ply(big);
    const std::size_t x = ply.find("end_header\r\n") + 12 + 4;
    std::string bytes;
    append_value(bytes, kNan, big);
    ply.replace(x, 8, bytes);
    expect_refusal(ply, "a.ply", "a.ply: byte " + std::to_string(x) + ": ", "not finite");
  }
}

TEST(MeshFile, SaysWhatToDoWithFilesItCannotRead) {
  expect_refusal("", "a.obj", "a.obj: ", "empty");
  expect_refusal("hello world", "a.txt", "a.txt: ", "OBJ, STL, PLY, OFF and glTF are read");
  expect_refusal(std::string(500, '\0'), "a", "a: ", "OBJ, STL, PLY, OFF and glTF are read");
  expect_refusal(std::string("\xFF\xFEv\0", 4), "a", "a: ", "UTF-16");
  expect_refusal("\n \n", "a.obj", "a.obj: ", "no triangles");
  expect_refusal("v 0 0 0\n", "a", "a: ", "no triangles");
  expect_refusal("solid empty\nendsolid\n", "a", "a: ", "no triangles");
  expect_refusal("OFF 0 0 0\n", "a", "a: ", "no triangles");
}

TEST(MeshFile, NamesFormatsItDoesNotReadAndWhatToConvertTo) {
  const struct {
    const char *content, *name, *format, *advice;
  } cases[] = {{"Kaydara FBX Binary  ", "hand", "FBX", "export glTF or OBJ"},
               {"; FBX 7.3.0 project file", "cup.FBX", "FBX", "export glTF or OBJ"},
               {"PK\3\4", "part.3mf", "3MF", "export STL"},
               {"ISO-10303-21;", "part", "STEP", "export STL or glTF"},
               {"<?xml", "scene.dae", "COLLADA", "export glTF or OBJ"},
               {"\x80\4", "MANO_RIGHT.pkl", "MANO", "OBJ or PLY"},
               {"#usda 1.0", "a", "USD", "export glTF or OBJ"},
               {"\x1f\x8b\b", "cup.obj.gz", "compressed", "gunzip"},
               {"PK\3\4", "meshes.zip", "archive", "unzip"},
               {"\x1f\x8b\b", "cup.obj", "compressed", "gunzip"},
               {"\x1f\x8b\b", "cup.stl", "compressed", "gunzip"},
               {"PK\3\4", "cup.ply", "archive", "unzip"},
               {"\xFF\xFEv", "cup.obj", "UTF-16", "save it in UTF-8"},
               {"\xFE\xFFv", "cup.ply", "UTF-16", "save it in UTF-8"},
               {"BLENDER-v300", "cup.obj", "Blender", "export glTF or OBJ"}};
  for (const auto& [content, name, format, advice] : cases) {
    SCOPED_TRACE(name);
    expect_refusal(content, name, std::string(name) + ": ", format);
    expect_refusal(content, name, std::string(name) + ": ", advice);
  }
}

TEST(MeshFile, TakesNoCommentOfAnObjForAnotherFormat) {
  EXPECT_EQ(parsed("# vtk\nlod 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj").triangles.size(), 1u);
  expect_refusal("# vtk DataFile Version 3.0\nlod 1\n", "a", "a: ", "VTK");
}

TEST(MeshFile, PutsOnlyShortPrintableWordsIntoMessages) {
  const std::string message = refusal("v \x1b[31m" + std::string(1000, 'x') + " 0 0\n", "a.obj");
  EXPECT_LT(message.size(), 150u);
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
}

// ---- Files on disk ----

TEST(MeshFile, LoadsFromDiskAndNamesThePathInMessages) {
  const std::string path = test::write_file("solid.stl", binary_stl());
  Mesh mesh;
  EXPECT_TRUE(load_mesh(path, Unit::metre, mesh).ok());
  expect_tetrahedron(mesh);
  std::ofstream(path, std::ios::binary) << "v 0 0\n";
  EXPECT_EQ(load_mesh(path, Unit::metre, mesh).message().substr(0, path.size() + 5), path + ":1:6:");
  expect_tetrahedron(mesh);
}

TEST(MeshFile, SaysWhyAFileCannotBeOpened) {
  Mesh mesh;
  const std::string folder = test::own_folder().string();
  EXPECT_NE(load_mesh(folder, Unit::metre, mesh).message().find("is a folder"), std::string::npos);
  EXPECT_NE(load_mesh(folder + "/no such file", Unit::metre, mesh).message().find("no such file"),
            std::string::npos);
  EXPECT_NE(load_mesh("", Unit::metre, mesh).message().find("no such file"), std::string::npos);
  EXPECT_FALSE(load_mesh("/dev/zero", Unit::metre, mesh).ok());
  EXPECT_FALSE(load_mesh(std::string(100000, 'a'), Unit::metre, mesh).ok());
}

TEST(MeshFile, SaysThatPermissionIsMissing) {
  const std::string path = test::write_file("locked.obj", kObj);
  std::filesystem::permissions(path, std::filesystem::perms::none);
  const bool readable = std::ifstream(path).good();
  Mesh mesh;
  const Status status = load_mesh(path, Unit::metre, mesh);
  if (readable) GTEST_SKIP() << "This user may read every file.";
  EXPECT_NE(status.message().find("ermission"), std::string::npos) << status.message();
}

TEST(MeshFile, DoesNotReadAFileThatOnlyPretendsToBeLarge) {
  const std::string path = test::write_file("sparse.stl", "x");
  std::error_code error;
  std::filesystem::resize_file(path, std::uintmax_t{1} << 40, error);
  Mesh mesh;
  const Status status = load_mesh(path, Unit::metre, mesh);
  if (error) GTEST_SKIP() << "The file system does not hold sparse files of a terabyte.";
  EXPECT_NE(status.message().find("8 GiB"), std::string::npos) << status.message();
}

// ---- Damage ----

TEST(MeshFile, SurvivesACutAtEveryLength) {
  for (const Sample& sample : all_samples()) {
    const bool binary = sample.name != "a.ply" && sample.content.find('\0') != std::string::npos;
    for (std::size_t size = 0; size < sample.content.size(); ++size) {
      Mesh mesh;
      const Status status = parse_mesh(sample.content.substr(0, size), sample.name, Unit::millimetre, mesh);
      EXPECT_FALSE(binary && status.ok()) << sample.name << " cut at byte " << size << " was accepted";
      EXPECT_TRUE(!status.ok() || is_sound(mesh)) << sample.name << " cut at byte " << size;
      EXPECT_TRUE(status.ok() || mesh.triangles.empty()) << sample.name << " cut at byte " << size;
    }
  }
}

TEST(MeshFile, SurvivesEverySingleBitFlipped) {
  for (const Sample& sample : all_samples()) {
    for (std::size_t byte = 0; byte < sample.content.size(); ++byte) {
      for (int bit = 0; bit < 8; ++bit) {
        std::string damaged = sample.content;
        damaged[byte] = static_cast<char>(damaged[byte] ^ (1 << bit));
        Mesh mesh;
        const Status status = parse_mesh(damaged, sample.name, Unit::centimetre, mesh);
        EXPECT_TRUE(!status.ok() || is_sound(mesh)) << sample.name << " byte " << byte << " bit " << bit;
        EXPECT_TRUE(status.ok() || mesh.triangles.empty())
            << sample.name << " byte " << byte << " bit " << bit;
      }
    }
  }
}

}  // namespace
}  // namespace lumbrical
