// mesh_grasps: the built-in grasp on every mesh of a folder, with every precision's time and error against
// the exact rung's, which feels once what several bodies hold wherever samples do.
//
// Each mesh is moved onto the plane z = 0 and scaled to --size [m]; the default hand, its palm included, goes
// round it as round the demo's mug, every rung in turn at each of up to 2000 moments. Files that are no
// meshes are named and left out, in the results too.
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
#include "origin.h"
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

struct Grasps {
  std::vector<Row> rows;
  std::vector<std::string> left_out;  // "file: why"
  std::string origin;                 // origin_members()
};

// [us] What an exact tick takes by default: of each part of the hand by itself.
double exact_by_itself(const Row& row) {
  const tool::PrecisionComparison& comparison = row.comparison;
  return (comparison.exact_for_each ? *comparison.exact_for_each : comparison.rungs[0]).median_us;
}

// [us] Where exact ticks feel once what several parts hold, as samples do.
double exact_felt_once(const Row& row) { return row.comparison.rungs[0].median_us; }

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

struct Line {
  std::string rung;
  const tool::PrecisionFigures* figures;
};

// The exact rung of each part for itself is the last, where it feels anything else than the one felt once.
std::vector<Line> lines_of(const Row& row) {
  std::vector<Line> lines;
  for (const tool::PrecisionFigures& rung : row.comparison.rungs)
    lines.push_back({rung_name(rung.precision), &rung});
  if (row.comparison.exact_for_each) lines.push_back({"exact for each", &*row.comparison.exact_for_each});
  return lines;
}

std::string to_markdown(const Grasps& grasps, const std::string& command) {
  std::string text = print(
      "# The built-in grasp on real meshes\n\nOn %s, %s with `%s`, %s, %s, one thread. Repeat it "
      "with\n\n```\n%s\n```\n\n"
      "Moments at which the hand feels more than %g N; errors are shares of the segments' forces "
      "together, against the rung exact, which feels once what several parts of the hand hold. \"exact for "
      "each\" feels each part for itself, as exact settings do by default: \"times exact\" is against its "
      "time, \"times exact, felt once\" against that of the rung exact. Times are the thread's processor "
      "time, "
      "beside those of the clock on the wall.\n\n",
      cpu_name().c_str(), LUMBRICAL_COMPILER, LUMBRICAL_COMPILER_FLAGS,
      std::string(isa_name(widest_isa())).c_str(), origin_words().c_str(), command.c_str(),
      tool::kLeastForce);
  text +=
      "| mesh | triangles | contacts | moments | rung | median us | p99 us | wall median us | wall p99 us | "
      "times exact | times exact, felt once | hand, 98 % | hand, worst | segment, 98 % |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : grasps.rows) {
    for (const auto& [name, rung] : lines_of(row))
      text += print(
          "| %s | %zu | %.0f | %zu | %s | %.1f | %.1f | %.1f | %.1f | %.3g | %.3g | %.1e | %.1e | %.1e |\n",
          row.mesh.c_str(), row.triangles, row.comparison.contacts,
          static_cast<std::size_t>(row.comparison.ticks), name.c_str(), rung->median_us, rung->p99_us,
          rung->wall_median_us, rung->wall_p99_us, exact_by_itself(row) / rung->median_us,
          exact_felt_once(row) / rung->median_us, rung->hand_error, rung->worst_hand_error,
          rung->segment_error);
  }
  if (!grasps.left_out.empty()) text += "\nLeft out:\n\n";
  for (const std::string& one : grasps.left_out) text += "- " + one + "\n";
  return text;
}

std::string to_json(const Grasps& grasps, const std::string& command) {
  std::string left_out;
  for (const std::string& one : grasps.left_out) left_out += (left_out.empty() ? "" : ", ") + quoted(one);
  std::string text = "{" + grasps.origin + "  \"cpu\": " + quoted(cpu_name()) +
                     ",\n  \"isa\": " + quoted(std::string(isa_name(widest_isa()))) +
                     ",\n  \"compiler\": " + quoted(LUMBRICAL_COMPILER) +
                     ",\n  \"flags\": " + quoted(LUMBRICAL_COMPILER_FLAGS) +
                     ",\n  \"command\": " + quoted(command) + ",\n  \"left_out\": [" + left_out +
                     "],\n  \"meshes\": [";
  const char* separator = "\n";
  for (const Row& row : grasps.rows) {
    for (const auto& [name, rung] : lines_of(row)) {
      text +=
          separator + ("    {\"mesh\": " + quoted(row.mesh)) +
          print(", \"triangles\": %zu, \"contacts\": %.1f, \"moments\": %zu, \"rung\": \"%s\"", row.triangles,
                row.comparison.contacts, static_cast<std::size_t>(row.comparison.ticks), name.c_str());
      text += print(
          ", \"median_us\": %.3f, \"p99_us\": %.3f, \"processor_p50_us\": %.3f, \"processor_p99_us\": %.3f, "
          "\"times_exact\": %.3f, \"times_exact_felt_once\": %.3f, \"hand_error\": %.3e, "
          "\"worst_hand_error\": %.3e, \"segment_error\": %.3e}",
          rung->wall_median_us, rung->wall_p99_us, rung->median_us, rung->p99_us,
          exact_by_itself(row) / rung->median_us, exact_felt_once(row) / rung->median_us, rung->hand_error,
          rung->worst_hand_error, rung->segment_error);
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

// Where someone keeps meshes says nothing: a message in the results begins with the file's name.
std::string without_folder(const std::string& message, const std::string& path) {
  const std::string folder = path.substr(0, path.rfind('/') + 1);
  return message.starts_with(folder) ? message.substr(folder.size()) : message;
}

Grasps measure_all(const Options& options) {
  Grasps grasps;
  grasps.origin = origin_members();
  for (const std::string& file : files_of(options.meshes)) {
    Row row;
    Status status = measure(file, options, row);
    if (status.ok() && row.comparison.ticks == 0) status = Status::error(file + ": is not touched");
    if (status.ok()) {
      grasps.rows.push_back(std::move(row));
    } else {
      std::fprintf(stderr, "left out: %s\n", status.message().c_str());
      grasps.left_out.push_back(without_folder(status.message(), file));
    }
  }
  return grasps;
}

int run(const Options& options, const std::string& command) {
  std::error_code error;
  if (!fs::is_directory(options.meshes, error)) {
    std::fprintf(stderr, "mesh_grasps: %s is no folder; name one that holds mesh files\n",
                 options.meshes.c_str());
    return 2;
  }
  const Grasps grasps = measure_all(options);
  if (grasps.rows.empty()) {
    std::fprintf(stderr, "%s: holds no mesh that a grasp touches; put mesh files of closed things there\n",
                 options.meshes.c_str());
    return 2;
  }
  const std::string table = to_markdown(grasps, command);
  if (options.out.empty()) return std::fputs(table.c_str(), stdout) < 0 ? 1 : 0;
  fs::create_directories(options.out);
  std::ofstream markdown(options.out + "/meshes.md"), json(options.out + "/meshes.json");
  markdown << table;
  json << to_json(grasps, command);
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
