// The layers of the source tree, and who may include whom. A file that no rule names fails the test, so that
// whoever adds one decides where it belongs.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

enum class Layer {
  base,
  model,
  motion,
  kernels,
  stages,
  engine,
  device,
  loop,
  session,
  wire,
  physics,
  capi,
  program,
  test
};

struct Rule {
  Layer layer;
  const char* folder;  // "folder/*" stands for every folder in it
  const char* names;   // of files without suffix; * at the end stands for anything
};

const Rule kRules[] = {
    {Layer::base, "engine/include/lumbrical", "math nearest_name shared_array status"},
    {Layer::base, "engine/src/base", "*"},

    {Layer::model, "engine/include/lumbrical",
     "mesh shapes hand model object surface contact voxel search_memory"},
    {Layer::model, "engine/src/model", "*"},
    {Layer::model, "engine/src/index", "*"},

    {Layer::motion, "engine/include/lumbrical", "device motion object_path"},
    {Layer::motion, "engine/src/motion", "resampler grasp_motion"},

    {Layer::kernels, "engine/src/simd", "*"},
    {Layer::kernels, "engine/src/search", "*"},
    {Layer::kernels, "engine/src/exact", "*"},
    {Layer::kernels, "engine/src/section", "*"},
    {Layer::kernels, "engine/src/borders", "*"},
    {Layer::kernels, "engine/src/samples", "*"},

    {Layer::stages, "engine/src/stages", "*"},

    {Layer::engine, "engine/include/lumbrical", "tick probe jacobian batch clearance shared_objects"},
    {Layer::engine, "engine/src/objects", "*"},
    {Layer::engine, "engine/src/proxy", "*"},
    {Layer::engine, "engine/src/tick", "*"},

    {Layer::device, "engine/include/lumbrical",
     "device_profile actuator_model safety passivity local_model loop_timing haptic_loop device_simulation "
     "device_link"},
    {Layer::device, "engine/src/device", "*"},

    {Layer::loop, "engine/include/lumbrical",
     "datagram_wire device_guard device_sink device_wire loop real_time shared_device shared_memory_wire "
     "ways_out"},
    {Layer::loop, "engine/src/loop", "*"},

    {Layer::session, "engine/include/lumbrical", "mesh_fix recording scene_file surface_file world"},
    {Layer::session, "engine/src/motion", "motion_*"},
    {Layer::session, "engine/src/files", "*"},
    {Layer::session, "engine/src/recording", "*"},

    {Layer::wire, "engine/include/lumbrical", "modbus_wire modbus_server"},
    {Layer::wire, "engine/src/modbus", "*"},

    {Layer::physics, "engine/include/lumbrical", "bullet"},
    {Layer::physics, "engine/src/bullet", "*"},

    {Layer::capi, "engine/include", "lumbrical"},
    {Layer::capi, "engine/src/capi", "*"},

    {Layer::program, "bindings/python", "*"},
    {Layer::program, "tools/lumbrical", "*"},
    {Layer::program, "examples", "*"},
    {Layer::test, "tests/*", "*"},
    {Layer::test, "bench", "*"},
};

bool may_include(Layer from, Layer to) {
  switch (from) {
    case Layer::base:
      return to == Layer::base;
    case Layer::model:
      return to <= Layer::model;
    case Layer::motion:
      return to <= Layer::motion;
    case Layer::kernels:
      return to == Layer::base || to == Layer::model || to == Layer::kernels;
    case Layer::stages:
      return to <= Layer::stages && to != Layer::motion;
    case Layer::engine:
      return to <= Layer::engine;
    case Layer::device:
      return to <= Layer::device && to != Layer::kernels && to != Layer::stages;
    case Layer::loop:
      return to <= Layer::loop && to != Layer::kernels && to != Layer::stages;
    case Layer::wire:
      return (to <= Layer::loop && to != Layer::kernels && to != Layer::stages) || to == Layer::wire;
    case Layer::session:
      return to <= Layer::session && to != Layer::loop && to != Layer::kernels && to != Layer::stages;
    case Layer::physics:
      return (to <= Layer::engine && to != Layer::kernels && to != Layer::stages) || to == Layer::physics;
    case Layer::capi:
      return to == Layer::capi ||
             (to <= Layer::session && to != Layer::loop && to != Layer::kernels && to != Layer::stages);
    case Layer::program:
    case Layer::test:
      return true;
  }
  return false;
}

// Headers that stages share: plain data and the engine's own vocabulary, not stages themselves.
const std::set<std::string> kSharedByStages = {"engine/src/stages/joint_torques.h",
                                               "engine/include/lumbrical/device.h",
                                               "engine/include/lumbrical/tick.h"};

// What runs the stages one after the other, and so knows them all.
constexpr const char* kRunsStages = "engine/src/stages/feel_model";

// Who may use what comes from outside. Everything else in angle brackets must be the standard library.
struct Outside {
  const char* header;  // regular expression
  const char* users;   // regular expression
};

const Outside kOutside[] = {
    {"(oneapi/)?tbb/.*", "engine/src/base/parallel[.]cpp"},
    {"xsimd/.*", "engine/src/simd/wide[.]h"},
    {"openvdb/.*", "engine/src/index/voxel_grid_openvdb[.]cpp"},
    {"(xmmintrin|immintrin|cfenv)([.]h)?", "engine/src/base/floating_point[.].*|tests/.*"},
    {"flatbuffers/.*",
     "engine/src/(files/(json_file|device_profile_file|scene_file|scene_mechanics|scene_parts)|recording/"
     "\\w+)[.].*|engine/src/(loop/datagram_message[.]cpp|base/message_alignment[.]h)|tests/"
     ".*"},
    {"nlohmann/.*",
     "(engine/src/(motion/motion_\\w+|model/(mesh_gltf|gltf_\\w+|json_text))[.].*|tools/.*|tests/.*)"},
    {"(lz4frame|zstd|zlib)[.]h", "(engine/src/recording/(mcap_\\w+|npz_file)[.]cpp|tests/.*)"},
    {"(unistd|fcntl|sys/\\w+)[.]h",
     "(engine/src/(files/(mapped|output|spill|readable)_file|recording/mcap_reader|modbus/"
     "modbus_(server|link)|loop/\\w+)[.]cpp|engine/include/lumbrical/device_guard[.]h|tools/"
     ".*|tests/"
     ".*|bench/.*)"},
    {"dlfcn[.]h", "engine/src/index/voxel_grid[.]cpp"},
    {"malloc[.]h", "tests/.*"},
    {"(stddef|stdint|string)[.]h", "engine/include/(lumbrical|lumbrical/shared_device)[.]h"},
    {"modbus/.*", "engine/src/modbus/modbus_link[.]cpp"},
    {"(poll|sched|pthread|signal|spawn|termios|errno|time|netdb|arpa/\\w+|netinet/\\w+)[.]h",
     "(engine/src/(base/thread_signals[.]h|modbus/line_rates[.]h|(modbus/modbus_|loop/)\\w+[.]cpp|"
     "recording/recorder[.]cpp)|"
     "tools/.*|tests/.*)"},
    {"CLI/.*", "tools/lumbrical/command_line[.]cpp"},
    {"pybind11/.*", "bindings/python/\\w+[.](h|cpp)"},
    {"(gtest|boost)/.*", "tests/.*"},
    {"benchmark/.*", "bench/.*"},
    {"(btBulletCollisionCommon[.]h|fcl/.*|ode/ode[.]h|embree3/.*)", "bench/peer_\\w+[.]cpp"},
    {"(btBulletDynamicsCommon[.]h|Bullet(Collision|Dynamics)/.*|LinearMath/.*)",
     "engine/src/bullet/.*|bench/hold_bullet[.]cpp"},
    {"mujoco/mujoco[.]h", "bench/hold_mujoco[.]cpp"},
};

bool matches(const std::string& text, const char* pattern) {
  return std::regex_match(text, std::regex(pattern));
}

bool in_folder(const fs::path& folder, const fs::path& path) {
  if (folder.filename() == "*") return path.parent_path().parent_path() == folder.parent_path();
  return path.parent_path() == folder;
}

bool named_by(const Rule& rule, const fs::path& path) {
  if (!in_folder(rule.folder, path)) return false;
  const std::string stem = path.stem().string();
  std::istringstream names(rule.names);
  for (std::string name; names >> name;) {
    const bool open = name.back() == '*';
    if (open ? stem.starts_with(name.substr(0, name.size() - 1)) : stem == name) return true;
  }
  return false;
}

bool layer_of(const std::string& path, Layer& layer) {
  for (const Rule& rule : kRules) {
    if (!named_by(rule, path)) continue;
    layer = rule.layer;
    return true;
  }
  return false;
}

struct Include {
  std::string name;
  bool angled = false;
};

std::vector<Include> includes_of(const fs::path& file) {
  static const std::regex pattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"].*)");
  std::vector<Include> includes;
  std::ifstream stream(file);
  std::smatch match;
  for (std::string line; std::getline(stream, line);) {
    if (std::regex_match(line, match, pattern)) includes.push_back({match[2], match[1] == "<"});
  }
  return includes;
}

// The path from the source root of a header of ours; empty for generated ones.
std::string resolve(const std::string& name, const std::string& includer, const fs::path& root) {
  const std::string beside = (fs::path(includer).parent_path() / name).lexically_normal().generic_string();
  for (const std::string& path :
       {beside, "engine/include/" + name, "engine/src/" + name, "tests/support/" + name, "tests/" + name,
        "bench/" + name, "tools/lumbrical/" + name}) {
    if (fs::exists(root / path)) return path;
  }
  return {};
}

void check_outside(const std::string& path, const std::string& header) {
  for (const Outside& outside : kOutside) {
    if (!matches(header, outside.header)) continue;
    EXPECT_TRUE(matches(path, outside.users)) << path << " must not include <" << header << ">";
    return;
  }
  EXPECT_TRUE(matches(header, "[a-z_0-9]+"))
      << path << " includes <" << header << ">, which is not of the standard library and has no rule here";
}

void check_own(const std::string& path, Layer layer, const std::string& target) {
  Layer other = Layer::base;
  ASSERT_TRUE(layer_of(target, other)) << target << " belongs to no layer";
  const bool shared = layer == Layer::stages && kSharedByStages.contains(target);
  EXPECT_TRUE(may_include(layer, other) || shared) << path << " must not include " << target;
  const bool own = fs::path(path).stem() == fs::path(target).stem() || path.starts_with(kRunsStages);
  EXPECT_FALSE(layer == Layer::stages && other == Layer::stages && !own && !shared)
      << path << " and " << target << " are stages and must not know each other";
  EXPECT_FALSE(layer == Layer::program && target.starts_with("engine/src/"))
      << path << " must use public headers only, not " << target;
  EXPECT_FALSE(path.starts_with("engine/include/") && target.starts_with("engine/src/"))
      << path << " is public and must not include the private " << target;
}

TEST(Layers, FilesIncludeOnlyWhatLiesBelowThem) {
  const fs::path root = LUMBRICAL_SOURCE_DIR;
  std::size_t file_count = 0;
  for (const char* const folder :
       {"engine/include", "engine/src", "bindings", "tools", "examples", "tests", "bench"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string path = entry.path().lexically_relative(root).generic_string();
      if (!matches(path, ".*[.](h|cpp)")) continue;
      ++file_count;
      Layer layer = Layer::base;
      if (!layer_of(path, layer)) {
        ADD_FAILURE() << path << " belongs to no layer; give it its place in this test";
        continue;
      }
      for (const Include& include : includes_of(entry.path())) {
        if (include.angled) {
          check_outside(path, include.name);
        } else if (const std::string target = resolve(include.name, path, root); !target.empty()) {
          check_own(path, layer, target);
        } else if (layer < Layer::loop || !matches(include.name, "\\w+_generated[.]h")) {
          check_outside(path, include.name);
        }
      }
    }
  }
  EXPECT_GT(file_count, 40u);
}

// A source file whose header says it need not say it again.
bool has_header(const fs::path& file, const fs::path& root) {
  const std::string header = file.stem().string() + ".h";
  return fs::exists(file.parent_path() / header) || fs::exists(root / "engine/include/lumbrical" / header);
}

TEST(Layers, EveryFileOpensWithASentenceThatSaysWhatItDoes) {
  const fs::path root = LUMBRICAL_SOURCE_DIR;
  for (const char* const folder : {"engine", "bindings", "tools", "examples", "tests", "bench"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path& file = entry.path();
      const bool header = file.extension() == ".h";
      if (!header && (file.extension() != ".cpp" || has_header(file, root))) continue;
      std::string word;
      std::ifstream(file) >> word;
      EXPECT_TRUE(word == "//" || word == "/*") << file;
    }
  }
}

}  // namespace
