// What each mesh format may look like, what is refused, and at which line or byte.
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "mesh_samples.h"

namespace lumbrical {
namespace {

// ---- OBJ ----

TEST(MeshFile, CutsObjPolygonsIntoFansFromTheFirstCorner) {
  const Mesh mesh = parsed("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 2 3 4 5 1\n", "a.obj");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{1, 2, 3}, {1, 3, 4}, {1, 4, 0}}));
}

TEST(MeshFile, CountsNegativeObjIndicesFromTheVerticesGivenSoFar) {
  const Mesh mesh = parsed("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -3 -2 -1\n", "a.obj");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 2, 3}}));
  expect_refusal("v 0 0 0\nv 1 0 0\nf -2 -1 -3\nv 0 0 1\n", "a.obj", "a.obj:3:9: ", "-3");
}

TEST(MeshFile, LetsPositiveObjIndicesReferForward) {
  EXPECT_EQ(parsed("f 3 2 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", "a.obj").triangles,
            (std::vector<Triangle>{{2, 1, 0}}));
}

TEST(MeshFile, ReportsTheLineOfAnIndexOutOfRange) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_refusal(points + "f 1 2 3\nf 1 2 4\n", "a.obj",
                 "a.obj:5:7: ", "vertex index 4 is out of range 1..3");
  expect_refusal("f 1 2 3\nf 3 4 5\nf 1 2 9\n" + points, "a.obj",
                 "a.obj:2:5: ", "vertex index 4 is out of range 1..3");
  expect_refusal(points + "f 1/9/9 0/1/1 2\n", "a.obj", "a.obj:4:9: ", "index 0");
  expect_refusal(points + "f 1 2 99999999999999\n", "a.obj", "a.obj:4:7: ", "out of range");
  expect_refusal(points + "f 1 2 4294967298\n", "a.obj", "a.obj:4:7: ", "out of range");
  expect_refusal(points + "f 1 2 99999999999999999999999\n", "a.obj", "a.obj:4:7: ", "not of the form");
}

TEST(MeshFile, RefusesObjFacesThatAreNone) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_refusal(points + "  f 1 2\n", "a.obj", "a.obj:4:3: ", "at least 3 corners, this one has 2");
  expect_refusal(points + "f\n", "a.obj", "a.obj:4:1: ", "at least 3 corners, this one has 0");
  for (const char* corner : {"a", "1.0", "1\\2", "/1", "1/a", "1//1x", "-", "--1"}) {
    expect_refusal(points + "f 1 2 " + corner + "\n", "a.obj", "a.obj:4:7: ", "not of the form");
  }
  expect_refusal("v 1 2\n", "a.obj", "a.obj:1:6: ", "before the third coordinate");
}

TEST(MeshFile, CountsLinesThroughObjContinuations) {
  expect_refusal("v 0 \\\n 0 \\\r\n 0\n# no continuation \\\nv 1 0 0\nv 0 1 0\nf 1 \\\n 2 \\\n 7\n", "a.obj",
                 "a.obj:9:2: ", "index 7");
}

TEST(MeshFile, PassesOverObjKeywordsItDoesNotKnow) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvp 1\ncurv 0 1 1 2\nsurprise f 1 2\nf 1 2 3\nfoo\n";
  EXPECT_EQ(parsed(text, "a.obj").triangles.size(), 1u);
}

// ---- STL ----

TEST(MeshFile, TellsBinaryStlFromAsciiStlWhateverTheHeaderSays) {
  expect_tetrahedron(parsed(binary_stl("solid x\n facet normal 0 0 1\n  outer loop\n"), "a.stl"));
  expect_tetrahedron(parsed(binary_stl(""), "a.stl"));
  expect_tetrahedron(parsed(kAsciiStl, "a_bin.stl"));
}

TEST(MeshFile, SaysHowManyTrianglesABinaryStlLacks) {
  const std::string whole = binary_stl();
  expect_refusal(whole.substr(0, 84 + 50 + 7), "a.stl", "a.stl: byte 141: ", "3 are missing");
  expect_refusal(whole.substr(0, 30) + '\0', "a.stl", "a.stl: byte 31: ", "84 bytes");
  expect_refusal(whole + "more", "a.stl", "a.stl: byte 284: ", "4 more bytes");
  std::string boastful = whole;
  std::memset(boastful.data() + 80, 0xFF, 4);
  expect_refusal(boastful, "a.stl", "a.stl: byte 284: ", "4294967291 are missing");
}

TEST(MeshFile, MergesEqualStlVerticesInTheOrderOfTheirFirstOccurrence) {
  const Mesh mesh = parsed(kAsciiStl, "a.stl");
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {2, 1, 3}, {1, 0, 3}}));
}

TEST(MeshFile, TakesAnAsciiStlThatClosesInTwoWordsAndAllSolidsOfAFile) {
  const auto solid = [](const std::string& end) {
    return "solid a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 " + end +
           "\nendloop\nendfacet\n";
  };
  EXPECT_EQ(parsed(solid("0") + "end solid a b\n", "a.stl").triangles.size(), 1u);
  EXPECT_EQ(parsed(solid("0") + "End Solid", "a.stl").triangles.size(), 1u);
  const Mesh two = parsed(solid("0") + "end solid a\n" + solid("2") + "endsolid\n", "a.stl");
  EXPECT_EQ(two.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}}));
  expect_refusal(solid("0") + "end sold\n", "a.stl", "a.stl:9:5: ", "'endsolid' is expected");
  expect_refusal(solid("0") + solid("0") + "endsolid\n", "a.stl", "a.stl:9:1: ", "'endsolid' is expected");
}

TEST(MeshFile, KeepsDegenerateStlTriangles) {
  const std::string facet =
      "solid\nfacet normal 0 0 0 outer loop\nvertex 1 1 1\nvertex 1 1 1\nvertex 1 1 1\nendloop "
      "endfacet\nendsolid";
  EXPECT_EQ(parsed(facet, "a").triangles, (std::vector<Triangle>{{0, 0, 0}}));
}

TEST(MeshFile, PointsAtTheWordThatBreaksAnAsciiStl) {
  expect_refusal(replaced(kAsciiStl, "outer loop", "loop"), "a.stl",
                 "a.stl:3:3: ", "'outer loop' is expected");
  expect_refusal(replaced(kAsciiStl, "endloop", "vertex 1 1 1 endloop"), "a.stl",
                 "a.stl:7:3: ", "'endloop' is expected");
  expect_refusal(replaced(kAsciiStl, "vertex 1 0 0\n", "vertex 1 0\n"), "a.stl",
                 "a.stl:6:14: ", "third coordinate");
  expect_refusal(replaced(kAsciiStl, "ENDSOLID", ""), "a.stl", "a.stl:33:1: ", "the file ends");
  expect_refusal(kAsciiStl + "trailer", "a.stl", "a.stl:33:1: ", "'solid' is expected");
}

// ---- PLY ----

TEST(MeshFile, ReadsPolygonsAndEveryScalarTypeFromPly) {
  for (const char* const index : {"char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16",
                                  "int", "int32", "uint", "uint32"}) {
    for (const char* const coordinate : {"char", "short", "int", "float", "double", "float32", "float64"}) {
      SCOPED_TRACE(std::string(index) + " " + coordinate);
      const std::string type = std::string("property ") + coordinate;
      const Mesh mesh = parsed("ply\nformat ascii 1.0\nelement vertex 4\n" + type + " x\n" + type + " y\n" +
                                   type + " z\nelement face 1\nproperty list " + index + " " + index +
                                   " vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3",
                               "a");
      EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
      EXPECT_EQ(mesh.vertices[2], (Vec3{1, 1, 0}));
    }
  }
}

TEST(MeshFile, ReadsPlyFacesThatComeBeforeTheVertices) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\nelement vertex 3\n"
      "property float z\nproperty float y\nproperty float x\nend_header\n3 0 1 2\n3 2 1\n6 5 4\n9 8 7\n";
  EXPECT_EQ(parsed(text, "a").vertices, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
  expect_refusal(replaced(text, "3 0 1 2", "3 0 1 3"), "a", "a:10:7: ", "not one of the 3 vertices");
}

TEST(MeshFile, RefusesPlyHeadersItDoesNotUnderstand) {
  const auto refused = [](const char* from, const char* to, const char* place, const char* what) {
    expect_refusal(replaced(kAsciiPly, from, to), "a.ply", std::string("a.ply:") + place, what);
  };
  refused("ascii 1.0", "ascii 2.0", "2:14: ", "version '2.0'");
  refused("ascii 1.0", "binary 1.0", "2:8: ", "binary_little_endian");
  refused("format ascii 1.0\n", "", "19:1: ", "no 'format'");
  refused("element edge", "element face", "17:9: ", "twice");
  refused("property float quality", "property half quality", "14:10: ", "type 'half'");
  refused("property float z", "property float x", "7:1: ", "x, y and z");
  refused("vertex_index", "corners", "13:1: ", "vertex_indices");
  refused("list uchar uint vertex_index", "list float uint vertex_index", "15:15: ", "integer type");
  refused("list uchar uint vertex_index", "uint vertex_index", "15:15: ", "must be a list");
  refused("list uchar uint vertex_index", "list uchar float vertex_index", "15:27: ", "integer type");
  refused("element camera 1", "element camera -1", "5:16: ", "'-1'");
  refused("element camera 1", "elephant", "5:1: ", "'elephant'");
  refused("element camera 1\n", "", "5:1: ", "before the first element");
  refused("element face 4", "element phase 4", "20:1: ", "cloud of points");
}

TEST(MeshFile, BelievesNoPlyCountThatTheFileCannotHold) {
  expect_refusal(replaced(kAsciiPly, "element vertex 4", "element vertex 4000000000"), "a.ply",
                 "a.ply:21:", "do not fit");
  expect_refusal(replaced(kAsciiPly, "element vertex 4", "element vertex 9999999999"), "a.ply",
                 "a.ply:7:16: ", "2^32 - 2");
  expect_refusal(replaced(kAsciiPly, "element face 4", "element face 99999999999999"), "a.ply",
                 "a.ply:", "do not fit");
  expect_refusal(replaced(kAsciiPly, "0.5 3 0 2 1 0", "0.5 4000000000 0 2 1 0"), "a.ply",
                 "a.ply:26:5: ", "list's length");
  expect_refusal(replaced(kAsciiPly, "0.5 3 0 2 1 0", "0.5 -3 0 2 1 0"), "a.ply",
                 "a.ply:26:5: ", "list's length");
  expect_refusal(replaced(kAsciiPly, "0.5 3 0 2 1 0", "0.5 2 0 2 0"), "a.ply",
                 "a.ply:26:5: ", "at least 3 corners");
  const std::string binary = binary_ply(false);
  expect_refusal(replaced(binary, "element vertex 4", "element vertex 4000000000"), "a.ply", "a.ply: byte ",
                 "do not fit");
  expect_refusal(replaced(binary, "element extra 2", "element extra 9223372036854775807"), "a.ply",
                 "a.ply: byte ", "do not fit");
  const std::string endless =
      replaced(binary, "element extra 2\r\nproperty int16 a", "element extra 9223372036854775807");
  EXPECT_FALSE(refusal(endless, "a.ply").empty());  // an element without properties must not keep anyone busy
}

TEST(MeshFile, HoldsPlyRowsToTheirLines) {
  expect_refusal(replaced(kAsciiPly, "9 1 1 7 0 0\n", "9 1 1 7 0\n"), "a.ply",
                 "a.ply:23:10: ", "the line ends");
  expect_refusal(replaced(kAsciiPly, "9 1 1 7 0 0\n", "9 1 1 7 0 0 0\n"), "a.ply",
                 "a.ply:23:13: ", "more values");
  expect_refusal(kAsciiPly + "1 2\n", "a.ply", "a.ply:31:1: ", "more follows");
  // Real files of one widespread library have undeclared values behind their faces.
  expect_tetrahedron(parsed(replaced(kAsciiPly, "3 0 2 1 0\n", "3 0 2 1 0 9 1 1 1\n"), "a.ply"));
}

TEST(MeshFile, KnowsWhereBinaryPlyDataBegin) {
  // The first byte of data is a line feed here, which must not be taken for part of the header's last line
  // end.
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    std::string bytes = with_line_ends(
        "ply\nformat binary_little_endian 1.0\nelement odd 1\nproperty uchar a\nelement vertex 3\nproperty "
        "char x\n"
        "property char y\nproperty char z\nelement face 1\nproperty list uchar uchar "
        "vertex_indices\nend_header\n",
        line_end);
    bytes += std::string("\n\0\0\0\1\0\0\0\1\0\3\0\1\2", 14);
    const Mesh mesh = parsed(bytes, "a.ply");
    EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    expect_refusal(bytes + "x", "a.ply", "a.ply: byte " + std::to_string(bytes.size()) + ": ",
                   "more follows");
    EXPECT_EQ(parsed(bytes + "\n", "a.ply").triangles.size(), 1u);
  }
}

TEST(MeshFile, TurnsEveryOtherTriangleOfAPlyStripRound) {
  const std::string strips = replaced(replaced(kPlyStrips, "element vertex 4", "element vertex 5"),
                                      "16 0 2 1 -1 0 1 3 -1 1 2 3 -1 2 0 3 -1", "8 0 1 2 3 4 -1 4 2");
  const Mesh mesh = parsed(replaced(strips, "0 0 1\n", "0 0 1\n5 5 5\n"), "a.ply");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  // Two equal corners only join strips.
  const Mesh joined =
      parsed(replaced(kPlyStrips, "16 0 2 1 -1 0 1 3 -1 1 2 3 -1 2 0 3 -1", "6 0 1 2 2 2 3"), "a.ply");
  EXPECT_EQ(joined.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  expect_refusal(replaced(kPlyStrips, "-1 2 0 3", "-2 2 0 3"), "a.ply", "a.ply:14:", "vertex index");
  expect_refusal(replaced(kPlyStrips, "vertex_indices", "indices"), "a.ply",
                 "a.ply:7:", "tristrips need one list");
}

// ---- OFF ----

TEST(MeshFile, ReadsOffWithAndWithoutItsKeyword) {
  const std::string body = "4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
  for (const char* keyword :
       {"", "OFF\n", "OFF ", "OFF", "# c\nOFF\n# c\n\n", "NOFF\n", "CNOFF ", "STOFF\n", "STCNOFF\n"}) {
    SCOPED_TRACE(keyword);
    EXPECT_EQ(parsed(keyword + body, "a.off").triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  }
  EXPECT_EQ(parsed("OFF\n3 1\n0 0 0 \n1 0 0\n0 1 0\n3 0 1 2", "a.off").triangles.size(), 1u);
}

TEST(MeshFile, PointsAtWhatIsWrongInOff) {
  const auto refused = [](const char* from, const char* to, const char* place, const char* what) {
    expect_refusal(replaced(kOff, from, to), "a.off", std::string("a.off:") + place, what);
  };
  refused("COFF", "4OFF", "1:1: ", "not supported");
  refused("COFF", "OFF BINARY", "1:5: ", "binary OFF");
  refused("4 4 6", "x 4 6", "3:1: ", "number of vertices");
  refused("4 4 6", "4 -4 6", "3:3: ", "number of faces");
  refused("4 4 6", "4000000000 4 6", "3:1: ", "do not fit");
  refused("4 4 6", "4 4000000000 6", "3:3: ", "do not fit");
  refused("4 4 6", "4 5 6", "13:1: ", "after 4 of 5 faces");
  refused("4 4 6", "4 3 6", "12:1: ", "more follows");
  refused("3 0 2 1", "3 0 2 4", "9:7: ", "vertex index '4'");
  refused("3 0 2 1", "3 0 2 -1", "9:7: ", "vertex index '-1'");
  refused("3 0 2 1", "3 0 2", "9:6: ", "after 2 of 3 corners");
  refused("3 0 2 1", "2 0 2", "9:1: ", "3 or more");
  refused("3 0 2 1", "9999999999 0 2 1", "9:17: ", "after 3 of 9999999999");
}

}  // namespace
}  // namespace lumbrical
