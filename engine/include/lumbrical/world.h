// Worlds larger than memory: written to a file object by object, mapped, and read ahead of the hand
// (docs/worlds.md).
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "lumbrical/device.h"
#include "lumbrical/model.h"
#include "lumbrical/status.h"

namespace lumbrical {

/// Writes a world file, in memory for one object and one cell of the grid at a time (and for all triangles
/// that are wider than a cell). Its grid is the one build_model would make of a scene of the same objects.
class WorldWriter {
 public:
  WorldWriter();
  ~WorldWriter();  ///< removes what was written, unless it was finished
  WorldWriter(const WorldWriter&) = delete;
  WorldWriter& operator=(const WorldWriter&) = delete;

  /// The file grows as `path`.part and takes its place when it is finished. Of `execution` cell_size,
  /// leaf_size and tree_levels count, and threads. Where `stop`, which is asked now and then, says yes,
  /// whatever comes next is an error.
  Status open(const std::string& path, const Execution& execution, std::function<bool()> stop = {});
  /// A mesh placed in the world [m]; refuses what build_model refuses, and turns what build_model turns, for
  /// good: a model takes a world as it is written. Triangles keep the order in which they come: those that
  /// are near each other in it share pages. An object that is refused leaves the file as it was; one that is
  /// written in part, to a full disk or for want of memory, leaves only its error, which finish() gives too.
  Status add_object(const SceneObject& object, WindingReport* report = nullptr);
  /// Builds the grid and puts the file in its place.
  Status finish();

 private:
  struct Build;
  std::unique_ptr<Build> build_;
};

/// Maps a world file for Scene::world and checks all of it, on one pass that takes as long as reading it; the
/// pages read are let go of again. Whatever the file holds, no tick leaves its arrays. The message of an
/// error names the byte, from 0.
Status open_world(const std::string& path, std::shared_ptr<const World>& world);

/// For a handler of SIGBUS, which is what a program gets that reads a world file someone has shortened: true
/// if `address` lies in one, and then its page is zeros from now on, nothing that a tick could stumble over.
/// What was computed since can't be trusted: see WorldPager::changed and any_page_lost. The library sets no
/// handlers.
bool replace_lost_page(const void* address) noexcept;
bool any_page_lost() noexcept;  ///< whether that ever happened in this process

/// Reads a model's world ahead of the hand, or of both, on a thread of its own, so that no tick waits for a
/// disk, and lets go of what is far behind it, so that memory stays bounded. Never changes a result.
class WorldPager {
 public:
  struct Options {
    double reach = 0.3;     ///< [m] round the hand; what lies farther off is let go of
    double horizon = 0.25;  ///< [s] so long ahead, at the speed the hand has
  };

  /// Does nothing for a model that is not from a world file, nor where the system has no thread for it.
  WorldPager(const Model& model, const Options& options);
  ~WorldPager();
  WorldPager(const WorldPager&) = delete;
  WorldPager& operator=(const WorldPager&) = delete;

  /// Where the hand is now; of two that share the world (share_world) also which, 0 or 1. Wait-free, for the
  /// thread of the ticks, before each.
  void hand_at(const DeviceFrame& frame, std::size_t hand = 0) noexcept;

  /// Returns once everything near the hands as last told is in memory: before a first tick.
  void catch_up();

  /// Whether the file was shortened (told at once, if SIGBUS is handled), or written to (told within a tenth
  /// of a second): then forces of the ticks since can't be trusted. Wait-free.
  [[nodiscard]] bool changed() const noexcept;
  [[nodiscard]] Status failure() const;  ///< the same in words

  /// [bytes] of the file are held for the hands, at most.
  [[nodiscard]] std::size_t held_bytes() const noexcept;

 private:
  struct Thread;
  std::unique_ptr<Thread> thread_;
};

}  // namespace lumbrical
