// mesh_grasps: the built-in grasp on every mesh of a folder, with every precision's time and error against
// the exact rung's, which feels once what several bodies hold wherever samples do.
//
// Each mesh is moved onto the plane z = 0 and scaled to --size [m]; the default hand, its palm included, goes
// round it as round the demo's mug, every rung in turn at each of up to 2000 moments. Files that are no
// meshes are named and left out.
//
//   mesh_grasps MESHES [--size 0.11] [--seconds 3] [--felt-once by-samples] [--out FOLDER]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "../tools/lumbrical/compare_precision.h"
#include "lumbrical/mesh.h"
#include "machine.h"
#include "print.h"
#include "usage.h"

namespace lumbrical::bench {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string meshes, out;
  double size = 0.11, seconds = 3;
  FeltOnce felt_once = FeltOnce::by_samples;
};

struct Row {
  std::string mesh;
  std::size_t triangles = 0;
  tool::PrecisionComparison comparison;
};

bool parse(int count, char** words, Options& options) {
  if (count % 2 != 0 || words[1][0] == '-') return false;
  options.meshes = words[1];
  for (int i = 2; i + 1 < count; i += 2) {
    const std::string name = words[i];
    if (name == "--size") {
      options.size = std::strtod(words[i + 1], nullptr);
    } else if (name == "--seconds") {
      options.seconds = std::strtod(words[i + 1], nullptr);
    } else if (name == "--felt-once") {
      const auto parsed = parse_felt_once(words[i + 1]);
      if (!parsed) return false;
      options.felt_once = *parsed;
    } else if (name == "--out") {
      options.out = words[i + 1];
    } else {
      return false;
    }
  }
  return options.size > 0 && options.seconds > 0;
}

// Upright on z = 0, its middle above the origin.
bool fit(double size, Mesh& mesh) {
  Vec3 low = mesh.vertices[0], high = low;
  for (const Vec3 p : mesh.vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  if (!(extent > 0)) return false;
  const Vec3 foot{0.5 * (low.x + high.x), 0.5 * (low.y + high.y), low.z};
  for (Vec3& p : mesh.vertices) p = size / extent * (p - foot);
  return true;
}

Status measure(const std::string& path, const Options& options, Row& row) {
  Mesh mesh;
  if (Status status = load_mesh(path, Unit::metre, mesh); !status.ok()) return status;
  if (!fit(options.size, mesh)) return Status::error(path + ": has no extent");
  row.mesh = fs::path(path).filename().string();
  row.triangles = mesh.triangles.size();
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.max_candidates = 1u << 19;
  scene.settings.felt_once = options.felt_once;
  scene.objects.push_back({"mesh", std::move(mesh)});
  const Motion motion = make_grasp(scene.hand, 0.45 * options.size, options.size, options.seconds);
  return tool::compare_precision(scene, {}, motion, options.seconds, {}, row.comparison);
}

std::string rung_name(double precision) {
  return precision > 0 ? print("1e%.0f", std::log10(precision)) : "exact";
}

std::string to_markdown(const std::vector<Row>& rows, const std::string& command) {
  std::string text = print(
      "# The built-in grasp on real meshes\n\nOn %s, %s with `%s`, %s, one thread. Repeat it "
      "with\n\n```\n%s\n```\n\n"
      "Moments at which the hand feels more than %g N; errors are shares of the segments' forces "
      "together.\n\n",
      cpu_name().c_str(), LUMBRICAL_COMPILER, LUMBRICAL_COMPILER_FLAGS,
      std::string(isa_name(widest_isa())).c_str(), command.c_str(), tool::kLeastForce);
  text +=
      "| mesh | triangles | contacts | moments | rung | median us | p99 us | times exact | hand, 98 % | "
      "hand, worst | "
      "segment, 98 % |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    for (const tool::PrecisionFigures& rung : row.comparison.rungs)
      text += print("| %s | %zu | %.0f | %zu | %s | %.1f | %.1f | %.1f | %.1e | %.1e | %.1e |\n",
                    row.mesh.c_str(), row.triangles, row.comparison.contacts,
                    static_cast<std::size_t>(row.comparison.ticks), rung_name(rung.precision).c_str(),
                    rung.median_us, rung.p99_us, row.comparison.rungs[0].median_us / rung.median_us,
                    rung.hand_error, rung.worst_hand_error, rung.segment_error);
  }
  return text;
}

std::string to_json(const std::vector<Row>& rows, const std::string& command) {
  std::string text = "{\n  \"cpu\": " + quoted(cpu_name()) +
                     ",\n  \"isa\": " + quoted(std::string(isa_name(widest_isa()))) +
                     ",\n  \"compiler\": " + quoted(LUMBRICAL_COMPILER) +
                     ",\n  \"flags\": " + quoted(LUMBRICAL_COMPILER_FLAGS) +
                     ",\n  \"command\": " + quoted(command) + ",\n  \"meshes\": [";
  const char* separator = "\n";
  for (const Row& row : rows) {
    for (const tool::PrecisionFigures& rung : row.comparison.rungs) {
      text += separator + ("    {\"mesh\": " + quoted(row.mesh)) +
              print(", \"triangles\": %zu, \"contacts\": %.1f, \"moments\": %zu, \"rung\": \"%s\"",
                    row.triangles, row.comparison.contacts, static_cast<std::size_t>(row.comparison.ticks),
                    rung_name(rung.precision).c_str());
      text += print(
          ", \"median_us\": %.3f, \"p99_us\": %.3f, \"hand_error\": %.3e, \"worst_hand_error\": %.3e, "
          "\"segment_error\": %.3e}",
          rung.median_us, rung.p99_us, rung.hand_error, rung.worst_hand_error, rung.segment_error);
      separator = ",\n";
    }
  }
  return text + "\n  ]\n}\n";
}

// In the order of their names.
std::vector<std::string> files_of(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->is_regular_file()) files.push_back(entry->path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

int run(const Options& options, const std::string& command) {
  std::vector<Row> rows;
  for (const std::string& file : files_of(options.meshes)) {
    Row row;
    const Status status = measure(file, options, row);
    if (!status.ok()) std::fprintf(stderr, "left out: %s\n", status.message().c_str());
    if (status.ok() && row.comparison.ticks == 0)
      std::fprintf(stderr, "left out: %s: is not touched\n", file.c_str());
    if (status.ok() && row.comparison.ticks > 0) rows.push_back(std::move(row));
  }
  if (rows.empty()) {
    std::fprintf(stderr, "%s: holds no mesh that a grasp touches\n", options.meshes.c_str());
    return 2;
  }
  const std::string table = to_markdown(rows, command);
  if (options.out.empty()) return std::fputs(table.c_str(), stdout) < 0 ? 1 : 0;
  fs::create_directories(options.out);
  std::ofstream markdown(options.out + "/meshes.md"), json(options.out + "/meshes.json");
  markdown << table;
  json << to_json(rows, command);
  markdown.close();
  json.close();
  if (!markdown.fail() && !json.fail()) return 0;
  std::fprintf(stderr, "can't write to %s\n", options.out.c_str());
  return 1;
}

}  // namespace
}  // namespace lumbrical::bench

int main(int count, char** words) {
  lumbrical::bench::Options options;
  if (!lumbrical::bench::parse(count, words, options)) {
    return lumbrical::bench::tell_usage(
        "mesh_grasps MESHES [--size METRES] [--seconds S] [--felt-once never|by-samples|always] "
        "[--out FOLDER]",
        count, words);
  }
  // Where someone keeps meshes says nothing.
  std::string command = "build/release/bench/mesh_grasps MESHES";
  for (int i = 2; i < count; ++i) command += std::string(" ") + words[i];
  return lumbrical::bench::run(options, command);
}
