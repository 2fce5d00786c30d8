// Writing a world file: see lumbrical/world.h and world_format.h.
#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/check_stop.h"
#include "base/floating_point.h"
#include "base/parallel.h"
#include "files/cell_sort.h"
#include "files/output_file.h"
#include "files/spill_file.h"
#include "files/world_format.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "lumbrical/world.h"
#include "model/apart_objects.h"
#include "model/mesh_winding.h"
#include "model/scene_check.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kChunk = 1u << 20;            // triangles between two times that pages are let go of
constexpr std::size_t kBatch = std::size_t{1} << 18;  // triangles whose cells' trees are built at a time
constexpr std::size_t kSortMemory = std::size_t{64} << 20;  // [bytes]

/// A file that is written once from start to end, with the hashes of its pieces; `stop` is asked at each.
class HashedFile {
 public:
  Status open(const std::string& path, std::function<bool()> stop) {
    stop_ = std::move(stop);
    return file_.open(path);
  }

  Status append(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      const std::size_t part = std::min(bytes.size(), kHashPiece - piece_.size());
      piece_.insert(piece_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(part));
      bytes = bytes.subspan(part);
      if (piece_.size() < kHashPiece) continue;
      if (Status status = end_piece(); !status.ok()) return status;
    }
    return {};
  }
  template <class T>
  Status append_items(std::span<const T> items) {
    return append(std::as_bytes(items));
  }

  /// Zeros up to the next page.
  Status fill_page() {
    static constexpr std::array<std::byte, kPageSize> kZeros{};
    return append(std::span(kZeros).first(to_page(size()) - size()));
  }

  /// Everything so far is in the file, where it can be read.
  Status flush() {
    const std::span unwritten = std::span(piece_).subspan(written_);
    written_ = piece_.size();
    return file_.write({reinterpret_cast<const std::uint8_t*>(unwritten.data()), unwritten.size()});
  }

  Status end_piece() {
    if (Status status = check_stop(); !status.ok()) return status;
    if (piece_.empty()) return {};
    hashes_.push_back(hash_of_bytes(piece_.data(), piece_.size()));
    const Status status = flush();
    before_ += piece_.size();
    piece_.clear();
    written_ = 0;
    return status;
  }

  [[nodiscard]] Status check_stop() const { return lumbrical::check_stop(stop_); }
  [[nodiscard]] std::uint64_t size() const { return before_ + piece_.size(); }
  [[nodiscard]] const std::vector<std::uint64_t>& hashes() const { return hashes_; }
  [[nodiscard]] const std::string& growing_at() const { return file_.growing_at(); }
  Status commit() { return file_.commit(); }
  void discard() { file_.discard(); }

 private:
  OutputFile file_;
  std::function<bool()> stop_;
  std::uint64_t before_ = 0;  // bytes of ended pieces
  std::vector<std::byte> piece_;
  std::size_t written_ = 0;  // of the piece
  std::vector<std::uint64_t> hashes_;
};

Status copy_section(SpillFile& spill, HashedFile& file) {
  std::vector<std::byte> buffer(kHashPiece);
  for (std::uint64_t at = 0; at < spill.size(); at += buffer.size()) {
    const auto part = std::span(buffer).first(std::min<std::uint64_t>(buffer.size(), spill.size() - at));
    if (Status status = spill.read(at, part); !status.ok()) return status;
    if (Status status = file.append(part); !status.ok()) return status;
  }
  return file.fill_page();
}

template <class T>
Status append_items(std::span<const T> items, SpillFile& spill) {
  return spill.append(std::as_bytes(items));
}

/// What the trees of the cells are built from, and where they go.
struct GridWriter {
  const Triangles& triangles;
  const Execution& execution;
  HashedFile& file;
  SpillFile cells{}, heads{};
  std::vector<std::uint64_t> batch_cells{};
  std::vector<std::uint32_t> members{};
  std::vector<std::size_t> start{};
  std::uint64_t cell_count = 0, lines = 0;
  std::uint32_t frontier = 0;

  Status write(CellSort& sorted, const std::shared_ptr<const std::byte>& mapped, std::size_t size);
  Status write_batch();
};

// Trees of whole cells; or the last, that of the wide triangles, on all threads.
Status GridWriter::write_batch() {
  start.push_back(members.size());
  std::vector<TreeHead> batch;
  const std::uint64_t count = plan_trees(start, execution, batch);
  const auto trees = make_lines(count);
  if (batch_cells.empty()) {
    build_tree(triangles, members, execution, batch[0], trees.get());
  } else {
    build_trees(triangles, members, start, execution, batch, trees.get());
  }
  for (TreeHead& head : batch) {
    head.first_line += lines;
    frontier = std::max(frontier, static_cast<std::uint32_t>(frontier_capacity(head)));
  }
  lines += count;
  cell_count += batch_cells.size();
  Status status = file.append_items(std::span<const TreeLine>(trees.get(), count));
  if (status.ok()) status = append_items(std::span<const TreeHead>(batch), heads);
  if (status.ok()) status = append_items(std::span<const std::uint64_t>(batch_cells), cells);
  batch_cells.clear();
  members.clear();
  start.clear();
  return status;
}

Status GridWriter::write(CellSort& sorted, const std::shared_ptr<const std::byte>& mapped, std::size_t size) {
  for (;;) {
    CellEntry entry;
    bool end = false;
    if (Status status = sorted.next(entry, end); !status.ok()) return status;
    const bool wide = end || entry.cell == kWideCell;
    const bool other_cell = !batch_cells.empty() && batch_cells.back() != entry.cell;
    if (!batch_cells.empty() && (wide || (other_cell && members.size() >= kBatch))) {
      if (Status status = write_batch(); !status.ok()) return status;
      release_pages(mapped.get(), size);
    }
    if (end) break;
    if (!wide && (batch_cells.empty() || batch_cells.back() != entry.cell)) {
      batch_cells.push_back(entry.cell);
      start.push_back(members.size());
    }
    members.push_back(entry.triangle);
  }
  start.push_back(0);
  return write_batch();
}

}  // namespace

struct WorldWriter::Build {
  std::string path;
  Execution execution;
  HashedFile file;
  std::array<SpillFile, 6> arrays;  // x y z a b c
  std::vector<WorldObject> objects;
  std::string names;
  Box extent;
  WorldEnd end;
  Status failure;  // that left a part of an object in the arrays; nothing comes after it

  Status open(std::function<bool()> stop);
  Status add(const SceneObject& object, WindingReport& report);
  Status append(const Mesh& mesh, const std::vector<bool>& turned);
  void count(const SceneObject& object);
  Status write_triangles();
  Status write_grid();
  Status sort_by_cell(const Triangles& triangles, const std::shared_ptr<const std::byte>& mapped,
                      std::size_t size, SphereGrid& grid, CellSort& sorted) const;
  Status write_rest();
};

Status WorldWriter::Build::open(std::function<bool()> stop) {
  if (Status status = check_execution(execution); !status.ok()) return status;
  if (Status status = file.open(path, std::move(stop)); !status.ok()) return status;
  for (std::size_t i = 0; i < arrays.size(); ++i) {
    if (Status status = arrays[i].open(path + kPartSuffix + std::to_string(i)); !status.ok()) return status;
  }
  return {};
}

Status WorldWriter::Build::add(const SceneObject& added, WindingReport& report) {
  const Mesh& mesh = added.mesh;
  if (!failure.ok()) return failure;
  if (Status status = file.check_stop(); !status.ok()) return status;
  if (Status status = check_object(added.name, mesh, execution.threads); !status.ok()) return status;
  if (Status status =
          check_counts(end.vertices + mesh.vertices.size(), end.triangles + mesh.triangles.size());
      !status.ok())
    return status;
  if (added.name.size() > 65535)
    return Status::error("an object's name has more than 65535 bytes; shorten it");
  const std::vector<bool> turned = turned_triangles(mesh, added.winding, execution.threads, report);
  // What an exception leaves.
  failure = Status::error(path + ": an object is there in part, for want of memory; write the world anew");
  Status status = append(mesh, turned);
  if (status.ok()) count(added);
  failure = status;
  return status;
}

// To the arrays, one after the other.
Status WorldWriter::Build::append(const Mesh& mesh, const std::vector<bool>& turned) {
  std::vector<double> numbers(mesh.vertices.size());
  std::vector<std::uint32_t> corners(mesh.triangles.size());
  for (std::size_t k = 0; k < 3; ++k) {
    std::transform(mesh.vertices.begin(), mesh.vertices.end(), numbers.begin(),
                   [&](const Vec3& p) { return p.*kAxis[k]; });
    if (Status status = append_items(std::span<const double>(numbers), arrays[k]); !status.ok())
      return status;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const bool swap = k > 0 && !turned.empty() && turned[i];
      corners[i] = static_cast<std::uint32_t>(end.vertices) + mesh.triangles[i][swap ? 3 - k : k];
    }
    if (Status status = append_items(std::span<const std::uint32_t>(corners), arrays[3 + k]); !status.ok())
      return status;
  }
  return {};
}

// Once it is in the arrays.
void WorldWriter::Build::count(const SceneObject& added) {
  const Mesh& mesh = added.mesh;
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) extent.add(mesh.vertices[corner]);
  }
  WorldObject object;
  object.first_triangle = static_cast<std::uint32_t>(end.triangles);
  object.triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
  object.first_vertex = static_cast<std::uint32_t>(end.vertices);
  object.vertex_count = static_cast<std::uint32_t>(mesh.vertices.size());
  object.name_size = static_cast<std::uint32_t>(added.name.size());
  objects.push_back(object);
  names += added.name;
  end.vertices += mesh.vertices.size();
  end.triangles += mesh.triangles.size();
}

Status WorldWriter::Build::write_triangles() {
  std::array<std::byte, kPageSize> first{};
  std::memcpy(first.data(), &kWorldMagic, sizeof(kWorldMagic));
  if (Status status = file.append(first); !status.ok()) return status;
  for (SpillFile& array : arrays) {
    if (Status status = copy_section(array, file); !status.ok()) return status;
    array = SpillFile();  // its room on the disk is wanted
  }
  return file.flush();
}

Status WorldWriter::Build::sort_by_cell(const Triangles& triangles,
                                        const std::shared_ptr<const std::byte>& mapped, std::size_t size,
                                        SphereGrid& grid, CellSort& sorted) const {
  const auto count = static_cast<std::uint32_t>(triangles.size());
  Box centres;
  for (std::uint32_t first = 0; first < count; first += std::min(kChunk, count - first)) {
    if (Status status = file.check_stop(); !status.ok()) return status;
    centres.add(
        box_round_centres(triangles, first, first + std::min(kChunk, count - first), execution.threads));
    release_pages(mapped.get(), size);
  }
  grid = plan_grid(centres, execution);
  std::vector<std::uint64_t> cell(std::min(kChunk, count));
  for (std::uint32_t first = 0; first < count; first += static_cast<std::uint32_t>(cell.size())) {
    if (Status status = file.check_stop(); !status.ok()) return status;
    cell.resize(std::min<std::size_t>(cell.size(), count - first));
    parallel_pieces(cell.size(), 16384, execution.threads,
                    [&](std::size_t, std::size_t begin, std::size_t last) {
                      for (std::size_t i = begin; i < last; ++i)
                        cell[i] = cell_of_triangle(grid, triangles, first + static_cast<std::uint32_t>(i));
                    });
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const CellEntry entry{cell[i], first + static_cast<std::uint32_t>(i)};
      if (Status status = sorted.add(entry); !status.ok()) return status;
    }
    release_pages(mapped.get(), size);
  }
  return sorted.merge();
}

Status WorldWriter::Build::write_grid() {
  if (end.triangles == 0) {
    for (int empty = 0; empty < 3; ++empty)  // lines, cells and heads
      if (Status status = file.fill_page(); !status.ok()) return status;
    return {};
  }
  std::shared_ptr<const std::byte> mapped;
  std::size_t size = 0;
  if (Status status = map_file(file.growing_at(), mapped, size); !status.ok()) return status;
  const Triangles triangles = triangles_in(end, mapped);
  CellSort sorted;
  SphereGrid grid;
  if (Status status = sorted.open(path + kPartSuffix + ".sort", kSortMemory); !status.ok()) return status;
  if (Status status = sort_by_cell(triangles, mapped, size, grid, sorted); !status.ok()) return status;
  GridWriter writer{triangles, execution, file};
  if (Status status = writer.cells.open(path + kPartSuffix + ".cells"); !status.ok()) return status;
  if (Status status = writer.heads.open(path + kPartSuffix + ".heads"); !status.ok()) return status;
  if (Status status = writer.write(sorted, mapped, size); !status.ok()) return status;
  if (Status status = file.fill_page(); !status.ok()) return status;
  if (Status status = copy_section(writer.cells, file); !status.ok()) return status;
  end.origin[0] = grid.origin.x;
  end.origin[1] = grid.origin.y;
  end.origin[2] = grid.origin.z;
  end.grid_cell_size = grid.cell_size;
  end.frontier = writer.frontier;
  end.lines = writer.lines;
  end.cells = writer.cell_count;
  return copy_section(writer.heads, file);
}

Status WorldWriter::Build::write_rest() {
  end.objects = objects.size();
  end.name_bytes = names.size();
  if (Status status = file.append_items(std::span<const WorldObject>(objects)); !status.ok()) return status;
  if (Status status = file.fill_page(); !status.ok()) return status;
  if (Status status = file.append(std::as_bytes(std::span(names))); !status.ok()) return status;
  if (Status status = file.fill_page(); !status.ok()) return status;
  if (Status status = file.end_piece(); !status.ok()) return status;
  const std::vector<std::uint64_t> hashes = file.hashes();
  for (std::size_t k = 0; k < 3; ++k) {
    end.lower[k] = extent.lower.*kAxis[k];
    end.upper[k] = extent.upper.*kAxis[k];
  }
  end.cell_size = execution.cell_size;
  end.leaf_size = execution.leaf_size;
  end.tree_levels = execution.tree_levels;
  end.content = content_of(end, hashes.data(), hashes.size());
  if (Status status = file.append_items(std::span<const std::uint64_t>(hashes)); !status.ok()) return status;
  if (Status status = file.fill_page(); !status.ok()) return status;
  std::array<std::byte, kPageSize> last{};
  std::memcpy(last.data(), &end, sizeof(end));
  if (Status status = file.append(last); !status.ok()) return status;
  if (Status status = file.flush(); !status.ok()) return status;
  return file.commit();
}

WorldWriter::WorldWriter() = default;

WorldWriter::~WorldWriter() {
  if (build_) build_->file.discard();
}

Status WorldWriter::open(const std::string& path, const Execution& execution,
                         std::function<bool()> stop) try {
  if (build_) return Status::error(build_->path + ": is not finished yet; finish it first");
  auto build = std::make_unique<Build>();
  build->path = path;
  build->execution = execution;
  if (Status status = build->open(std::move(stop)); !status.ok()) {
    build->file.discard();
    return status;
  }
  build_ = std::move(build);
  return {};
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to write a world");
}

Status WorldWriter::add_object(const SceneObject& object, WindingReport* report) try {
  const FloatingPointGuard guard;
  if (!build_) return Status::error("no world file is open; open one first");
  if (Status status = check_material(object); !status.ok()) return status;
  if (is_apart(object))
    return Status::error(
        "object \"" + object.name +
        "\" moves, rubs or has a surface feel, and a world file holds what stands still; leave it "
        "out (in C++ it may stand in Scene::objects, beside Scene::world)");
  WindingReport ignored;
  return build_->add(object, report != nullptr ? *report : ignored);
} catch (const std::bad_alloc&) {
  return Status::error("object \"" + object.name + "\": not enough memory for it; split it");
}

Status WorldWriter::finish() {
  const FloatingPointGuard guard;
  if (!build_) return Status::error("no world file is open; open one first");
  const std::unique_ptr<Build> build = std::move(build_);
  Status status = build->failure;
  try {
    if (status.ok()) status = build->write_triangles();
    if (status.ok()) status = build->write_grid();
    if (status.ok()) status = build->write_rest();
  } catch (const std::bad_alloc&) {
    status = Status::error(build->path + ": not enough memory for one cell; make cells smaller");
  }
  if (!status.ok()) build->file.discard();
  return status;
}

}  // namespace lumbrical
