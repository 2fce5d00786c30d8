// Writes the samples of this folder, our own work: three small meshes, each in another format, and three hand
// motions, of which one is of both hands.
//
//   make_samples FOLDER
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

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

// The built-in grasp of the cup as joint angles, 3 s at 40 Hz.
std::string grasp_json() {
  const Motion motion = make_grasp(default_hand(Side::right), 0.037, 0.095, 3);
  std::string text = "{\"format\": \"lumbrical-angles\", \"side\": \"right\", \"samples\": [";
  for (int i = 0; i <= 120; ++i) {
    const double time = i / 40.0;
    const DeviceFrame frame = resample(motion, time);
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
  const bool written = write(folder + "cup.obj", cup_obj()) && write(folder + "stone.ply", stone_ply()) &&
                       write(folder + "bracket.stl", bracket_stl()) &&
                       write(folder + "grasp.json", grasp_json()) &&
                       write(folder + "stroke.csv", stroke_csv()) && write(folder + "hold.json", hold_json());
  return written ? 0 : 2;
}
