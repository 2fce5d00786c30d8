// Writes the fuzzers' first inputs to a folder: fuzz_seeds tests/fuzz/corpus
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

#include "flatbuffers/flatbuffers.h"
#include "fuzz_seeds.h"
#include "loop/datagram_message.h"
#include "lumbrical/recording.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"
#include "lumbrical/world.h"
#include "recording/hand_views.h"
#include "recording/mcap_reader.h"
#include "recording/record_fields.h"
#include "recording/scene_views.h"
#include "recording/session_message.h"
#include "recording/state_message.h"
#include "recording/tick_message.h"
#include "world_input.h"

namespace {

using namespace lumbrical;
namespace fs = std::filesystem;
using ByteVector = std::vector<std::uint8_t>;
using test::write;

Scene seed_scene() {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.max_candidates = 1000;
  scene.objects.push_back({"triangle", {{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}, {{0, 1, 2}}}});
  return scene;
}

// What moves, what it is held by, and how it feels.
Scene seed_scene_of_objects() {
  Scene scene = seed_scene();
  scene.ground = Ground{};
  scene.settings.proxy_stiffness = 500;
  scene.settings.pad = {{{{0.2, 0.5}, {0.5, -0.3}}}, 0.5};
  SceneObject object;
  object.mesh = make_box({0.1, 0.1, 0.1}, 1);
  object.material = {0.5, 0.4, 0.1, 2000};
  object.mechanism.mobility = Mobility::hinge;
  static_cast<void>(mass_properties(object.mesh, 500, object.mechanism.body).ok());
  object.mechanism.lower = 0;
  object.mechanism.latch = {2, 0.1};
  for (const char* const name : {"door", "handle", "body", "tool"}) {
    object.name = name;
    scene.objects.push_back(object);
    object.mechanism.latch = {};
    object.pose.position.x += 0.5;
  }
  scene.objects[3].mechanism.mobility = Mobility::free;
  SceneObject& tool = scene.objects[4];
  tool.mechanism = {};
  tool.mechanism.mobility = Mobility::given;
  tool.surface.crease_angle = 0.5;
  tool.surface.friction_factor.assign(tool.mesh.triangles.size(), 0.5);
  tool.surface.grip = {{2, 1, {0, 65535}}, 0.01, 0.5, 1.5};
  tool.surface.bumps = {{1, 2, {0, 65535}}, 0.01, 0, 0.001};
  return scene;
}

TickRecord seed_record(std::uint64_t tick) {
  TickRecord record;
  record.device.kind = tick % 2 == 0 ? InputKind::joint_angles : InputKind::joint_poses;
  record.device.angle[3] = 0.25f;
  record.device.joint[7].position[1] = tick % 2 == 0 ? 0 : 0.125f;
  record.output.tick = tick;
  record.output.contact_count = 2;
  record.output.segment[4].force.z = 1.5;
  record.stage_hash = {1, 2, 3, 4, 5, 6};
  record.stage_hash[static_cast<std::size_t>(Stage::input)] = hash_fields(record.device);
  record.stage_hash[static_cast<std::size_t>(Stage::limits)] = hash_fields(record.output);
  record.state_hash = 7;
  return record;
}

ByteVector read(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Checksums of 0 mean "not computed", so a fuzzer gets past them.
void clear_checksums(const fs::path& path, ByteVector& bytes) {
  InputFile file;
  mcap::Header header;
  std::uint64_t at = 0;
  if (!file.open(path.string()).ok() || !read_start(file, header, at).ok()) return;
  const auto clear = [&](std::uint64_t offset) {
    std::fill_n(bytes.begin() + static_cast<long>(offset), 4, 0);
  };
  for (bool whole = true; whole;) {
    RecordPlace place;
    if (!find_record(file, at, file.size(), place, whole).ok() || !whole) return;
    if (place.opcode == mcap::Opcode::chunk) clear(place.content() + 24);
    if (place.opcode == mcap::Opcode::attachment || place.opcode == mcap::Opcode::data_end ||
        place.opcode == mcap::Opcode::footer)
      clear(place.end() - 4);
    if (place.opcode == mcap::Opcode::footer) return;
    at = place.end();
  }
}

bool write_recordings(const fs::path& folder) {
  for (const auto& [name, compression] :
       {std::pair("none", Compression::none), std::pair("lz4", Compression::lz4),
        std::pair("zstd", Compression::zstd)}) {
    const fs::path path = folder / name;
    fs::create_directories(folder);
    RecorderOptions options;
    options.compression = compression;
    options.chunk_seconds = 0.003;
    options.metadata = {{"build", "seed"}};
    fs::remove(path);
    Recorder recorder;
    if (!recorder.open(path.string(), seed_scene(), options).ok()) return false;
    for (std::uint64_t tick = 0; tick < 6; ++tick)
      if (!recorder.record(seed_record(tick))) return false;
    if (!recorder.close().ok()) return false;
    ByteVector bytes = read(path);
    write(folder / (std::string(name) + "_torn"), std::span(bytes).first(bytes.size() * 4 / 5));
    clear_checksums(path, bytes);
    write(folder / (std::string(name) + "_unchecked"), bytes);
  }
  return true;
}

void write_datagrams(const fs::path& folder) {
  SafetyOutput output;
  output.command.fill(0.25);
  DeviceCommand made_of;
  made_of.wanted = output.command;
  std::vector<std::byte> bytes;
  const auto keep = [&](const char* name) {
    write(folder / name, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  };
  write_command(1, {2, output, made_of}, 3, bytes);
  keep("command");
  DeviceStatus status;
  status.has_dead_man = true;
  CommandDatagram command;
  command.session = 1;
  write_feedback(command, status, std::array<float, kAngleCount>{}, 7, bytes);
  keep("feedback");
}

// A hand that lies on the triangle, with its posed joints and contact points beside its ticks.
bool write_views(const fs::path& folder) {
  fs::create_directories(folder);
  Scene scene = seed_scene();
  Model model;
  if (!build_model(scene, {}, model).ok()) return false;
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  const fs::path path = folder / "lz4";
  fs::remove(path);
  RecorderOptions options;
  options.pose_interval = 1;
  options.contact_interval = 2;
  options.scene_interval = 2;
  options.models = {&model};
  options.metadata = {{"build", "seed"}};
  Recorder recorder;
  if (!recorder.open(path.string(), scene, options).ok()) return false;
  for (int i = 0; i < 4; ++i) {
    TickRecord record;
    record.device.base.position = {0.03, 0.02, 0.005};
    record.output = tick(model, state, scratch, record.device);
    take_results(state, scratch, record);
    if (!recorder.record(record)) return false;
  }
  if (!recorder.close().ok()) return false;
  CopyOptions uncompressed;
  uncompressed.compression = Compression::none;
  CopyResult copied;
  const fs::path plain = folder / "none_unchecked";
  fs::remove(plain);
  if (!copy_recordings({path.string()}, plain.string(), uncompressed, copied).ok()) return false;
  ByteVector bytes = read(plain);
  clear_checksums(plain, bytes);
  write(plain, bytes);
  return true;
}

bool write_messages(const fs::path& folder) {
  const auto seed = [&](const char* name, std::uint8_t kind, std::span<const std::uint8_t> bytes) {
    ByteVector all{kind};
    all.insert(all.end(), bytes.begin(), bytes.end());
    write(folder / name, all);
  };
  flatbuffers::FlatBufferBuilder builder;
  for (const std::uint64_t tick : {0u, 1u}) {
    const TickRecord record = seed_record(tick);
    encode_tick(record, true, input_check_of(record), builder);
    seed(tick == 0 ? "tick_angles" : "tick_poses", 0, {builder.GetBufferPointer(), builder.GetSize()});
  }
  ByteVector session;
  if (!encode_session(seed_scene(), session).ok()) return false;
  seed("session", 1, session);
  if (!encode_session(seed_scene_of_objects(), session).ok()) return false;
  seed("session_of_objects", 1, session);
  State state;
  state.tick = 5;
  state.rise = 0.5;
  seed("state", 2, encode_state(state));
  Model model;
  if (!build_model(seed_scene_of_objects(), {}, model).ok()) return false;
  seed("state_of_objects", 2, encode_state(make_state(model)));
  if (!build_model(seed_scene(), {}, model).ok()) return false;
  HandViewer viewer(model);
  TickRecord record;
  record.device.base.position = {0.03, 0.02, 0.005};
  if (!viewer.place(record, nullptr)) return false;
  if (!viewer.pose(5, builder)) return false;
  seed("pose", 3, {builder.GetBufferPointer(), builder.GetSize()});
  viewer.contacts(5, builder);
  seed("contacts", 3, {builder.GetBufferPointer(), builder.GetSize()});
  viewer.scene(record.output, 5, builder);
  seed("scene", 3, {builder.GetBufferPointer(), builder.GetSize()});
  draw_objects(seed_scene(), 5, builder);
  seed("objects", 3, {builder.GetBufferPointer(), builder.GetSize()});
  record.object_count = 1;
  draw_transforms(record, 5, builder);
  seed("transforms", 3, {builder.GetBufferPointer(), builder.GetSize()});
  return true;
}

void write_meshes(const fs::path& folder) {
  write(folder / "mesh_obj" / "a",
        "# tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1.5e0\nvn 0 0 1\nf 1 3 2\n"
        "f 1//1 2//1 4//1\nf 2/1 3/2 4/3\nf -1 -2 -4\n");
  write(folder / "mesh_obj" / "b",
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng square\nusemtl none\nf 1 2 \\\n3 4\n");
  write(folder / "mesh_off" / "a",
        "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
  write(folder / "mesh_off" / "b",
        "COFF # colours\n3 1 0\n0 0 0 1 0 0 1\n1 0 0 0 1 0 1\n0 1 0 0 0 1 1\n3 0 1 2 255 0 0\n");
  write(folder / "mesh_stl" / "ascii",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
        "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n");
  std::string binary(80, ' ');
  binary += std::string("\x01\0\0\0", 4) + std::string(12, '\0');
  for (const float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    binary.append(reinterpret_cast<const char*>(&value), 4);
  write(folder / "mesh_stl" / "binary", binary + std::string(2, '\0'));
  const std::string body =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  write(folder / "mesh_ply" / "ascii",
        "ply\nformat ascii 1.0\ncomment c\n" + body + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  std::string little = "ply\nformat binary_little_endian 1.0\n" + body;
  for (const float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    little.append(reinterpret_cast<const char*>(&value), 4);
  little += std::string("\x03\0\0\0\0\x01\0\0\0\x02\0\0\0", 13);
  write(folder / "mesh_ply" / "little", little);
  const std::size_t at = little.find("little");
  write(folder / "mesh_ply" / "big", little.replace(at, 6, "big"));
}

// A mirroring node with a child, two primitives, an index buffer; as .glb, and with its bytes in the text.
void write_gltf(const fs::path& folder) {
  std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[1,2,-1],"children":[1]},
{"mesh":0,"translation":[1,0,0],"rotation":[0,0,0,1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1},
{"attributes":{"POSITION":0},"mode":5}]}],"buffers":[{"byteLength":42}],
"bufferViews":[{"buffer":0,"byteLength":36,"byteStride":12},{"buffer":0,"byteOffset":36,"byteLength":6}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})";
  std::string buffer;
  for (const float value : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})
    buffer.append(reinterpret_cast<const char*>(&value), 4);
  buffer += std::string("\0\0\x01\0\x02\0\0\0", 8);
  std::string text = json;
  text.replace(text.find("\"byteLength\":42"), 15,
               "\"uri\":\"data:application/"
               "octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA\"");
  write(folder / "mesh_gltf" / "gltf", text);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto number = [](std::size_t value) {
    const auto word = static_cast<std::uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&word), 4);
  };
  write(folder / "mesh_gltf" / "glb", "glTF" + number(2) + number(28 + json.size() + buffer.size()) +
                                          number(json.size()) + "JSON" + json + number(buffer.size()) +
                                          std::string("BIN\0", 4) + buffer);
}

void write_scenes(const fs::path& folder) {
  write(folder / "scene" / "a", R"({"objects": [{"name": "m", "mug": {"segments": 12}, "position": [0, 0, 1]},
{"plane": {"cells": 2}}, {"box": {"size": [0.1, 0.2, 0.1], "cells": 1}}, {"sphere": {"cells": 2}}],
"hand": {"side": "left", "length": 0.19}, "motion": {"grasp": {"radius": 0.037, "height": 0.095, "seconds": 1}},
"settings": {"rate": 100, "stiffness": 2e7, "law": "column"}, "execution": {"threads": 2, "broadphase": "grid"}})");
  write(folder / "scene" / "b", R"({"objects": [{"mesh": "x.obj", "unit": "mm"}], "hand_file": "hand.json",
"motion": {"file": "m.json"}, "settings": {"max_force": 5, "fade_time": 0.1, "precision": 0.01}})");
}

// Of every kind that moves, given and held.
void write_moving_scenes(const fs::path& folder) {
  write(folder / "scene" / "moves", R"({"objects": [
{"name": "door", "box": {"cells": 1}, "moves": "hinge", "density": 400, "damping": 0.02, "joint": {"pivot": [0, 0, 1],
"axis": [0, 1, 0], "lower": 0, "upper": 1, "spring": 0.4, "rest": 1.5, "latch": {"object": "handle", "opens": 0.1}}},
{"name": "handle", "box": {"cells": 1}, "moves": "slider", "mass": 0.1, "joint": {"dry_friction": 0.1,
"detent_force": 0.4, "detent_pitch": 0.01}},
{"name": "ball", "sphere": {"cells": 2}, "moves": "ball", "mass": 1, "centre": [0, 0, 0.1], "inertia": [1, 1, 1, 0, 0, 0]},
{"name": "tool", "box": {"cells": 1}, "moves": "given", "friction": 0.5, "kinetic_friction": 0.4,
"path": [{"time": 0, "position": [0, 0, 1]}, {"time": 1, "position": [0, 1, 1], "orientation": [1, 0, 0, 1]}]},
{"name": "body", "box": {"cells": 1}, "moves": "free", "mass": 1, "surface": {"crease_angle": 0.5}}],
"ground": {"height": -0.1, "friction": 0.5}, "gravity": [0, 0, -9.8], "physics": {"engine": "bullet", "friction": 0.5},
"motion": {"grasp": {}}, "settings": {"proxy_stiffness": 500, "pad": {"damping": 0.5, "layers": [{"from": 0.2,
"stiffness": 0.5}]}}})");
}

void write_surfaces(const fs::path& folder) {
  write(folder / "surface" / "plain", "P2\n# dots\n3 2 255\n0 128 255\n 7 9 11\n");
  write(folder / "surface" / "raw", "P5 2 2 255\nabcd");
  write(folder / "surface" / "deep", "P5 2 1 1000\n" + std::string("\x01\x02\x03\x04"));
  write(folder / "surface" / "factors", "1 0.5 # rough\n10 0\n");
}

void write_hands(const fs::path& folder) {
  write(folder / "hand" / "a",
        R"({"side": "left", "length": 0.18, "radii": [{"joint": "index tip", "radius": 0.006}],
"palm": {"thickness": 0.02}})");
  write(folder / "hand" / "b", R"({"fingers": [{"name": "index", "base_position": [0.03, 0.02, 0],
"base_orientation": [1, 0, 0, 0], "bone_length": [0.06, 0.045, 0.026, 0.024], "lower": [-0.3, 0, 0, 0],
"upper": [0.3, 1.5, 1.7, 1.2]}]})");
}

// Between them every table and every name of schemas/device.fbs.
void write_devices(const fs::path& folder) {
  write(folder / "device" / "tcp",
        R"({"name": "a", "source": "s", "transport": {"kind": "tcp", "host": "h", "port": 502},
"rate": 50, "command": "FC23", "actuators": [{"name": "m", "drive": "motor", "at": {"address": 2, "type": "s16",
"scale": 0.001}, "lower": -1, "upper": 1, "slew": 50, "joints": [{"joint": "index proximal", "ratio": 0.5}],
"local": {"angle": {"address": 3}, "stiffness": {"address": 4, "scale": 0.01}, "radius": {"address": 5}}}],
"sensors": [{"joint": "index proximal", "motion": "abduction", "at": {"address": 9, "scale": 0.001}, "upper": 1}],
"control": {"address": 0, "active": 1}, "heartbeat": {"address": 1, "echo": 8},
"status": {"address": 7, "fault": 1, "stop": 2, "dead_man": 4, "ready": 8},
"dynamics": [{"inertia": 4e-5, "damping": 0.01, "friction": 0.008, "encoder_step": 3e-4}]})");
  write(folder / "device" / "rtu",
        R"({"name": "b", "transport": {"kind": "rtu", "line": "/dev/x", "baud": 115200,
"parity": "even", "stop_bits": 2, "unit": 9}, "feedback": "FC4", "response_timeout": 0.05, "first_retry": 0.1,
"last_retry": 2, "actuators": [{"name": "w", "drive": "wire", "at": {"address": 10, "type": "u8 low"}, "upper": 255,
"preload": 3, "joints": [{"joint": "thumb distal"}]}, {"name": "b", "drive": "brake", "at": {"address": 12,
"type": "f32", "words": "low first"}, "upper": 5, "safe": 0, "joints": [{"joint": "little distal", "ratio": -2}]}],
"handshake": [{"unit": 9, "address": 1, "value": 1000}], "expected": [{"address": 2, "mask": 15, "value": 3}],
"safety": {"fade": 0.2, "soft_start": 1, "tick_hold": 0.02, "tick_timeout": 0.2, "answer_timeout": 0.5},
"dynamics": [{"joints": ["index distal"], "inertia": 1e-5}]})");
}

// A few triangles in two objects, one of them wider than a cell.
bool write_world(const fs::path& folder) {
  const fs::path path = folder / "a.world";
  fs::create_directories(folder);
  fs::remove(path);
  WorldWriter writer;
  Execution execution;
  execution.cell_size = 0.1;
  if (!writer.open(path.string(), execution).ok() ||
      !writer.add_object({"box", make_box({0.1, 0.1, 0.1}, 1)}).ok() ||
      !writer.add_object({"plane", make_plane(2, 1, 0)}).ok() || !writer.finish().ok())
    return false;
  const ByteVector file = read(path);
  ByteVector input{0};
  const ByteVector content = test::input_from_world(file);
  input.insert(input.end(), content.begin(), content.end());
  write(folder / "compact", input);
  fs::remove(path);
  return true;
}

void write_motions(const fs::path& folder) {
  std::string angles;
  for (int i = 0; i < 20; ++i) angles += i == 0 ? "0.1" : ", 0.1";
  write(
      folder / "motion" / "angles",
      R"({"format": "lumbrical-angles", "side": "right", "samples": [{"time": 0, "wrist": {"position": [0,0,0],
"orientation": [1,0,0,0]}, "angles": [)" +
          angles + "]}]}");
  std::string row, header = "time";
  for (int i = 0; i < 21; ++i) {
    const std::string number = std::to_string(i);
    header += ",x" + number + ",y" + number + ",z" + number;
    row += ",0.0" + number + ",0.1,0.00" + number;
  }
  write(folder / "motion" / "landmarks", header + "\n0" + row + "\n0.1" + row + "\n");
  std::string fingers, frame = "1 2 3 4 5 6";
  for (const char* const finger : {"Thumb", "Index", "Middle", "Ring", "Pinky"}) {
    fingers +=
        std::string("JOINT RightHand") + finger + "1\n{\nOFFSET " + std::to_string(frame.size() / 10 - 1) +
        " 0 -8\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT b\n{\nOFFSET 0 0 -4\nCHANNELS 1 Xrotation\n"
        "JOINT c\n{\nOFFSET 0 0 -3\nCHANNELS 0\nEnd Site\n{\nOFFSET 0 0 -2\n}\n}\n}\n}\n";
    frame += " 0.1 2 3 4";
  }
  write(folder / "motion" / "bvh",
        "HIERARCHY\nROOT RightHand\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation "
        "Xrotation "
        "Yrotation\n" +
            fingers + "}\nMOTION\nFrames: 2\nFrame Time: 0.01\n" + frame + "\n" + frame + "\n");
  write(folder / "motion" / "webxr", R"([{"time": 0, "joints": {"wrist": {"position": [0,0,0],
"orientation": [0,0,0,1], "radius": 0.02}, "index_proximal": {"position": [0.1,0,0], "orientation": [0,0,0,1]}}}])");
  write(folder / "motion" / "leap",
        R"({"frames": [{"id": 1, "timestamp": 1000, "hands": [{"id": 5, "type": "right",
"palmPosition": [0,100,0]}], "pointables": [{"handId": 5, "type": 1, "carpPosition": [0,0,0], "mcpPosition": [1,0,0],
"pipPosition": [2,0,0], "dipPosition": [3,0,0], "btipPosition": [4,0,0]}]}]})");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const fs::path folder = argv[1];
  write_meshes(folder);
  write_gltf(folder);
  write_scenes(folder);
  write_moving_scenes(folder);
  write_surfaces(folder);
  write_hands(folder);
  write_devices(folder);
  write_motions(folder);
  write_datagrams(folder / "datagram");
#ifdef LUMBRICAL_FUZZ_MODBUS
  write_modbus(folder / "modbus");
#endif
  return write_world(folder / "world") && write_recordings(folder / "recording") &&
                 write_views(folder / "views") && write_messages(folder / "messages")
             ? 0
             : 1;
}
