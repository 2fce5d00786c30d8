// Writes the samples of this folder, our own work: small meshes, of several formats, and hand motions, of
// which one is of both hands.
//
//   make_samples FOLDER
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"

namespace {

using namespace lumbrical;

std::string number(double value, int decimals) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string numbers(Vec3 v, double unit, int decimals, const char* between) {
  return number(v.x / unit, decimals) + between + number(v.y / unit, decimals) + between +
         number(v.z / unit, decimals);
}

// A cup with a handle, standing on z = 0; in centimetres.
std::string cup_obj() {
  MugShape shape;
  shape.segments = 16;
  const Mesh mesh = make_mug(shape);
  std::string text = "# A cup, made by examples/make_samples.cpp; unit: cm\n";
  for (const Vec3& vertex : mesh.vertices) text += "v " + numbers(vertex, 0.01, 5, " ") + "\n";
  for (const Triangle& triangle : mesh.triangles) {
    text += "f";
    for (const std::uint32_t corner : triangle) text += " " + std::to_string(corner + 1);
    text += "\n";
  }
  return text;
}

template <class Value>
void append(std::string& bytes, Value value) {
  const auto raw = std::bit_cast<std::uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(raw >> shift & 0xFF);
}

constexpr double kStone = 0.03;  // [m] radius

// How far the stone reaches in a direction, as a share of its radius.
double stone_reach(Vec3 d) {
  return 1 + 0.08 * d.x * d.y - 0.1 * d.z * d.z * d.z * d.x + 0.12 * d.y * d.z * d.x;
}

// A round stone with dents, its middle at the origin; in metres, as scanners write.
std::string stone_ply() {
  const Mesh mesh = make_sphere(1, 10);
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment A stone, made by examples/make_samples.cpp; unit: m\n"
      "element vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vec3& d : mesh.vertices) {
    const Vec3 p = d * (kStone * stone_reach(d));
    for (const double coordinate : {p.x, p.y, p.z}) append(bytes, static_cast<float>(coordinate));
  }
  for (const Triangle& triangle : mesh.triangles) {
    bytes += '\3';
    for (const std::uint32_t corner : triangle) append(bytes, corner);
  }
  return bytes;
}

// An L of sheet metal, 40 x 40 x 20, 4 thick; in millimetres, as CAD programs write.
std::string bracket_stl() {
  constexpr std::array<std::array<double, 2>, 6> kOutline = {
      {{0, 0}, {40, 0}, {40, 4}, {4, 4}, {4, 40}, {0, 40}}};
  constexpr std::array<std::array<std::size_t, 3>, 4> kCap = {{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}};
  std::string text = "solid bracket\n";
  const auto facet = [&text](Vec3 a, Vec3 b, Vec3 c) {
    const Vec3 n = unit_or(cross(b - a, c - a), {});
    text += "facet normal " + numbers(n, 1, 0, " ") + "\n outer loop\n";
    for (const Vec3& corner : {a, b, c}) text += "  vertex " + numbers(corner, 1, 0, " ") + "\n";
    text += " endloop\nendfacet\n";
  };
  const auto at = [&](std::size_t i, double y) { return Vec3{kOutline[i % 6][0], y, kOutline[i % 6][1]}; };
  for (const auto& [a, b, c] : kCap) {
    facet(at(a, 0), at(b, 0), at(c, 0));
    facet(at(a, 20), at(c, 20), at(b, 20));
  }
  for (std::size_t i = 0; i < 6; ++i) {
    facet(at(i, 0), at(i, 20), at(i + 1, 20));
    facet(at(i, 0), at(i + 1, 20), at(i + 1, 0));
  }
  return text + "endsolid bracket\n";
}

// A mesh of rings of points, one above the other, closed by fans; in millimetres.
std::string rings_obj(const char* what, const std::vector<std::vector<Vec3>>& rings) {
  std::string text = std::string("# ") + what + ", made by examples/make_samples.cpp; unit: mm\n";
  const std::size_t sides = rings[0].size(), last = rings.size() - 1;
  for (const auto& ring : rings)
    for (const Vec3 point : ring) text += "v " + numbers(point, 0.001, 4, " ") + "\n";
  const auto face = [&text](std::size_t a, std::size_t b, std::size_t c) {
    text += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
  };
  for (std::size_t r = 0; r < last; ++r) {
    for (std::size_t i = 0; i < sides; ++i) {
      const std::size_t a = r * sides + i, b = r * sides + (i + 1) % sides;
      face(a, b, b + sides);
      face(a, b + sides, a + sides);
    }
  }
  for (std::size_t i = 2; i < sides; ++i) {
    face(0, i, i - 1);
    face(last * sides, last * sides + i - 1, last * sides + i);
  }
  return text;
}

std::vector<Vec3> ring_at(double height, double radius, double ribs, int sides) {
  std::vector<Vec3> ring;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * 3.14159265358979 * i / sides, r = radius + (i % 2 == 0 ? ribs : -ribs);
    ring.push_back({r * std::cos(angle), r * std::sin(angle), height});
  }
  return ring;
}

// A jar's ribbed cap, its middle at the origin.
std::string cap_obj() {
  std::vector<std::vector<Vec3>> rings;
  for (int i = 0; i <= 8; ++i) rings.push_back(ring_at(-0.03 + 0.0075 * i, 0.03, 0.0005, 48));
  return rings_obj("A cap", rings);
}

// A pen along z, its middle at the origin.
std::string pen_obj() {
  std::vector<std::vector<Vec3>> rings;
  for (int i = 0; i <= 20; ++i) rings.push_back(ring_at(-0.07 + 0.007 * i, 0.005, 0, 16));
  return rings_obj("A pen", rings);
}

// A link of a chain in the plane of x and y: twelve pieces a hair apart, since physics engines take each by
// its convex hull.
std::string link_obj() {
  std::string text = "# A link of a chain, made by examples/make_samples.cpp; unit: mm\n";
  constexpr int kPieces = 12;
  constexpr double kRadius = 0.012, kHalf = 0.0025;
  int first = 1;
  for (int i = 0; i < kPieces; ++i, first += 8) {
    for (int corner = 0; corner < 8; ++corner) {
      const double angle = 2 * 3.14159265358979 * (i + ((corner & 1) != 0 ? 0.995 : 0.005)) / kPieces;
      const double r = kRadius + ((corner & 2) != 0 ? kHalf : -kHalf), z = (corner & 4) != 0 ? kHalf : -kHalf;
      text += "v " + numbers({r * std::cos(angle), r * std::sin(angle), z}, 0.001, 4, " ") + "\n";
    }
    for (const char* face : {"1 3 2 0", "6 7 5 4", "4 5 1 0", "3 7 6 2", "2 6 4 0", "5 7 3 1"}) {
      text += "f";
      for (const char* c = face; *c != 0; ++c)
        if (*c != ' ') text += " " + std::to_string(first + (*c - '0'));
      text += "\n";
    }
  }
  return text;
}

// A motion in joint angles at 40 Hz.
template <class FrameAt>
std::string angles_json(int samples, const FrameAt& frame_at) {
  std::string text = "{\"format\": \"lumbrical-angles\", \"side\": \"right\", \"samples\": [";
  for (int i = 0; i < samples; ++i) {
    const double time = i / 40.0;
    const DeviceFrame frame = frame_at(time);
    const Quat q = frame.base.orientation;
    text += std::string(i == 0 ? "" : ",") + "\n{\"time\": " + number(time, 3) +
            ", \"wrist\": {\"position\": [" + numbers(frame.base.position, 1, 6, ", ") +
            "], \"orientation\": [" + number(q.w, 6) + ", " + numbers({q.x, q.y, q.z}, 1, 6, ", ") +
            "]}, \"angles\": [";
    for (std::size_t a = 0; a < kAngleCount; ++a)
      text += (a == 0 ? "" : ", ") + number(static_cast<double>(frame.angle[a]), 5);
    text += "]}";
  }
  return text + "\n]}\n";
}

// The built-in grasp of the cup, 3 s.
std::string grasp_json() {
  const Motion motion = make_grasp(default_hand(Side::right), 0.037, 0.095, 3);
  return angles_json(121, [&](double time) { return resample(motion, time); });
}

// From 0 to 1 between two times, at rest at both.
double ease(double time, double from, double to) {
  const double s = std::fmin(std::fmax((time - from) / (to - from), 0.0), 1.0);
  return s * s * s * (10 - 15 * s + 6 * s * s);
}

constexpr std::array<int, 21> kLandmarks = {kWrist,     kThumbMetacarpal, kThumbProximal,      kThumbDistal,
                                            kThumbTip,  kIndexProximal,   kIndexIntermediate,  kIndexDistal,
                                            kIndexTip,  kMiddleProximal,  kMiddleIntermediate, kMiddleDistal,
                                            kMiddleTip, kRingProximal,    kRingIntermediate,   kRingDistal,
                                            kRingTip,   kLittleProximal,  kLittleIntermediate, kLittleDistal,
                                            kLittleTip};

// An index finger comes down on the stone, strokes it and leaves: 21 landmarks, 3 s at 40 Hz.
std::string stroke_csv() {
  std::string text = "time";
  for (int i = 0; i < 21; ++i)
    for (const char axis : {'x', 'y', 'z'}) text += std::string(",") + axis + std::to_string(i);
  const Hand hand = default_hand(Side::right);
  // Fingers forward and 30 degrees down, the back of the hand up: about x by 90 degrees less 30.
  const Quat level{0.70710678118654752, 0.70710678118654752, 0, 0},
      down{0.96592582628906829, -0.25881904510252076, 0, 0};
  const Quat orientation = level * down;
  for (int i = 0; i <= 120; ++i) {
    const double time = i / 40.0;
    std::array<double, kAngleCount> angles{};
    angles[1] = angles[2] = angles[3] = 0.3;
    for (std::size_t f = 1; f < kFingerCount; ++f)
      for (std::size_t k = 1; k < 4; ++k) angles[4 * f + k] = f == 1 ? 0.15 : 1.2;
    std::array<Pose, kJointCount> poses;
    forward_kinematics(hand, Pose{{}, orientation}, angles, poses);
    const double lift = 0.05 * (1 - ease(time, 0, 0.8) + ease(time, 2.2, 3));
    const double along = 0.012 * (ease(time, 0.9, 1.5) - 2 * ease(time, 1.5, 2.1));
    const Vec3 towards = unit_or({0, along, kStone}, {});
    const double height = kStone * stone_reach(towards) + hand.radius[kIndexTip] - 0.0015 + lift;
    const Vec3 wrist = towards * height - poses[kIndexTip].position;
    text += "\n" + number(time, 3);
    for (const int joint : kLandmarks)
      text += "," + numbers(wrist + poses[static_cast<std::size_t>(joint)].position, 1, 5, ",");
  }
  return text + "\n";
}

// A hand closes round a jar's cap, turns it, lets go and leaves, 4 s.
std::string twist_json() {
  const Motion motion = make_grasp(default_hand(Side::right), 0.03, 0.06, 1, 1e-6);
  constexpr double kClosed = 0.4;  // [s] of the grasp, before it would lift
  return angles_json(161, [&](double time) {
    DeviceFrame frame = resample(motion, kClosed * (ease(time, 0, 1.2) - ease(time, 2.6, 3.8)));
    const double half = 0.35 * (ease(time, 1.3, 2.5) - 0.5);
    frame.base = Pose{{}, {std::cos(half), 0, 0, std::sin(half)}} * frame.base;
    frame.base.position.z -= 0.03;  // the cap's middle is the origin
    return frame;
  });
}

// A flat hand, palm up and its thumb laid back, comes from below, lifts by 0.1 m and carries by 0.1 m, 4 s.
std::string carry_json() {
  const Quat level{0.70710678118654752, 0.70710678118654752, 0, 0}, over{0, 0, 0, 1};
  return angles_json(161, [&](double time) {
    DeviceFrame frame;
    frame.kind = InputKind::joint_angles;
    for (std::size_t f = 1; f < kFingerCount; ++f)
      for (std::size_t k = 1; k < 4; ++k) frame.angle[4 * f + k] = 0.03F;
    frame.angle[0] = -0.15F;
    frame.angle[1] = -0.5F;
    frame.base = {{0.1 * ease(time, 2.6, 3.8), -0.1, -0.045 + 0.13 * ease(time, 0.2, 2.4)}, level * over};
    return frame;
  });
}

// Thumb, index and middle fingertip hold a pen that stands on its point, and roll it to and fro: a capture in
// WebXR's names that shows no more of the hand than that, 3 s at 40 Hz.
std::string twirl_json() {
  constexpr double kTip = 0.008, kPen = 0.005, kPressed = 0.0012, kPhalanx = 0.025;
  std::string text = "[";
  for (int i = 0; i <= 120; ++i) {
    const double time = i / 40.0, away = 0.02 * (1 - ease(time, 0, 0.5) + ease(time, 2.6, 3));
    const double roll = 0.006 * (ease(time, 0.7, 1.2) - 2 * ease(time, 1.3, 2.1) + ease(time, 2.1, 2.5));
    text += std::string(i == 0 ? "" : ",") + "\n{\"time\": " + number(time, 3) + ", \"joints\": {";
    // The bone along -z of the orientation, the back of the hand along y.
    const auto joint = [&](const std::string& name, Vec3 p, const char* orientation, double radius,
                           bool last) {
      text += "\"" + name + "\": {\"position\": [" + numbers(p, 1, 5, ", ") + "], \"orientation\": [" +
              orientation + "], \"radius\": " + number(radius, 4) + "}" + (last ? "" : ", ");
    };
    joint("wrist", {0, -0.15, 0.05}, "0.70711, 0, 0, 0.70711", 0.02, false);
    struct Fingertip {
      const char *name, *before;
      double side, height;
    };
    for (const auto& [name, before, side, height] :
         {Fingertip{"thumb-tip", "thumb-phalanx-distal", -1, 0},
          {"index-finger-tip", "index-finger-phalanx-distal", 1, 0.012},
          {"middle-finger-tip", "middle-finger-phalanx-distal", 1, -0.012}}) {
      const Vec3 tip{side * (kPen + kTip - kPressed + away), -side * roll, height};
      const char* const inwards = side > 0 ? "0.5, 0.5, 0.5, 0.5" : "0.5, -0.5, -0.5, 0.5";
      joint(before, tip + Vec3{side * kPhalanx, 0, 0}, inwards, kTip, false);
      joint(name, tip, inwards, kTip, side > 0 && height < 0);
    }
    text += "}}";
  }
  return text + "\n]\n";
}

// One hand of hold_json: 1 of the right, -1 of the left. `closing` goes from 0 to 1.
std::array<Pose, kJointCount> holding(double sign, double closing) {
  const Hand hand = default_hand(sign > 0 ? Side::right : Side::left);
  std::array<double, kAngleCount> angles{};
  for (std::size_t f = 0; f < kFingerCount; ++f)
    for (std::size_t k = 1; k < 4; ++k) angles[4 * f + k] = f == 0 ? 0.1 : 0.1 + 0.2 * closing;
  // Fingers along +y, the thumb up, the palm towards the middle.
  const Pose wrist = {{sign * (0.105 - 0.043 * closing), -0.125, 0.05}, {0.5, 0.5, sign * 0.5, sign * -0.5}};
  std::array<Pose, kJointCount> poses;
  forward_kinematics(hand, wrist, angles, poses);
  return poses;
}

// Two hands take the cup between their palms and let go: a capture of both as LeapJS writes it, in
// millimetres and packed, 2 s at 30 Hz.
std::string hold_json() {
  std::string text =
      "{\"frames\": [[\"timestamp\", {\"hands\": [[\"id\", \"type\", \"direction\", \"palmNormal\", "
      "\"wrist\"]]}, "
      "{\"pointables\": [[\"handId\", \"type\", \"mcpPosition\", \"pipPosition\", \"dipPosition\", "
      "\"btipPosition\"]]}]";
  const auto point = [](Vec3 p) { return "[" + numbers(p, 0.001, 2, ",") + "]"; };
  for (int i = 0; i <= 60; ++i) {
    const double time = i / 30.0, closing = ease(time, 0.2, 0.8) - ease(time, 1.4, 1.9);
    std::string hands, fingers;
    for (const double sign : {1.0, -1.0}) {
      const std::array<Pose, kJointCount> poses = holding(sign, closing);
      const std::string id = sign > 0 ? "1" : "2";
      hands += (hands.empty() ? "[" : ",[") + id + (sign > 0 ? ",\"right\"" : ",\"left\"") + ",[0,1,0]," +
               (sign > 0 ? "[-1,0,0]" : "[1,0,0]") + "," + point(poses[kWrist].position) + "]";
      for (std::size_t f = 0; f < kFingerCount; ++f) {
        const std::size_t first = f == 0 ? static_cast<std::size_t>(kThumbMetacarpal) : 2 + 5 * f;
        fingers += (fingers.empty() ? "[" : ",[") + id + "," + std::to_string(f);
        for (std::size_t k = 0; k < 4; ++k) fingers += "," + point(poses[first + k].position);
        fingers += "]";
      }
    }
    text += ",\n[" + number(1e6 * time, 0) + ",[" + hands + "],[" + fingers + "]]";
  }
  return text + "\n]}\n";
}

bool write(const std::string& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content;
  file.close();
  if (!file) std::fprintf(stderr, "%s: can't be written\n", path.c_str());
  return static_cast<bool>(file);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("make_samples FOLDER\n", stderr);
    return 2;
  }
  const std::string folder = std::string(argv[1]) + "/";
  const bool written =
      write(folder + "cup.obj", cup_obj()) && write(folder + "stone.ply", stone_ply()) &&
      write(folder + "bracket.stl", bracket_stl()) && write(folder + "grasp.json", grasp_json()) &&
      write(folder + "stroke.csv", stroke_csv()) && write(folder + "hold.json", hold_json()) &&
      write(folder + "cap.obj", cap_obj()) && write(folder + "pen.obj", pen_obj()) &&
      write(folder + "link.obj", link_obj()) && write(folder + "twist.json", twist_json()) &&
      write(folder + "carry.json", carry_json()) && write(folder + "twirl.json", twirl_json());
  return written ? 0 : 2;
}
