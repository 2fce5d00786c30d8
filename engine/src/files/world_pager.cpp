// The thread ahead of the hands: see lumbrical/world.h. It keeps an account of pages, so that what it holds
// is bounded by what lies near them, whatever the order of the file.
#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "base/newest.h"
#include "base/set_bits.h"
#include "files/mapped_file.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "lumbrical/recording.h"
#include "lumbrical/world.h"

namespace lumbrical {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kNap = std::chrono::milliseconds(2);
constexpr auto kCheck = std::chrono::milliseconds(50);
constexpr auto kAgain = std::chrono::seconds(1);
constexpr double kFastest = 20;         // [m/s] of a hand; faster is a jump
constexpr double kStep = 1.0 / 8;       // of the reach: moves shorter than that need no new look
constexpr double kVelocityTime = 0.02;  // [s] over which the hand's velocity is taken

Box widened(const Box& box, double margin) {
  Box result = box;
  result.add(box.lower, margin);
  result.add(box.upper, margin);
  return result;
}

constexpr double kAngleReach = 0.25;  // [m] from wrist to fingertip, where only joint angles are known

// Round the joints; false where there is none to be trusted.
bool box_round(const DeviceFrame& frame, Box& box) {
  const Vec3 wrist = frame.base.position;
  Box hand;
  if (frame.kind == InputKind::joint_angles) hand.add(wrist, kAngleReach);
  for (std::size_t j = 0; j < kJointCount && frame.kind == InputKind::joint_poses; ++j) {
    if (!has_bit(frame.valid, j)) continue;
    const auto& p = frame.joint[j].position;
    hand.add(transform(frame.base, {p[0], p[1], p[2]}));
  }
  if (!(norm(hand.upper - hand.lower) <= 2) || !is_finite(hand.lower) || hand.upper.x < hand.lower.x)
    return false;
  box = hand;
  return true;
}

/// The parts of the file that are held in memory. They are touched one by one, but let go of by the region:
/// a touch may map all of one, where the system keeps the file in large pages, and a part of such a page
/// can't be let go of alone.
class HeldParts {
 public:
  static constexpr std::size_t kPart = std::size_t{64} << 10, kRegion = std::size_t{2} << 20;

  explicit HeldParts(const World& world)
      : first_(reinterpret_cast<std::uintptr_t>(world.bytes.get()) / kRegion * kRegion),
        begin_(world.bytes.get()),
        end_(begin_ + world.byte_count),
        round_of_(world.byte_count / kPart + 2 * kRegion / kPart),
        held_in_(world.byte_count / kRegion + 2) {
    held_.reserve(round_of_.size());  // all of them, as the thread could tell nobody that it has no memory
  }

  void begin_round() { ++round_; }

  void touch(const void* data, std::size_t size) {
    if (size == 0) return;
    const std::uintptr_t at = reinterpret_cast<std::uintptr_t>(data) - first_;
    for (std::size_t part = at / kPart; part <= (at + size - 1) / kPart; ++part) {
      if (round_of_[part] == round_) continue;
      if (round_of_[part] == 0) hold(part);
      round_of_[part] = round_;
      // Also if it is held: the system may have taken it away.
      const auto [from, to] = bytes_of(part * kPart, kPart);
      for (const std::byte* page = from; page < to; page += kPageSize)
        static_cast<void>(*static_cast<const volatile std::byte*>(page));
    }
  }

  void release_others() {
    std::size_t kept = 0;
    for (const std::size_t part : held_) {
      if (round_of_[part] == round_) {
        held_[kept++] = part;
      } else {
        let_go(part);
      }
    }
    held_.resize(kept);
  }

  /// Of regions in which something is held: no more can be in memory.
  [[nodiscard]] std::size_t bytes() const { return regions_ * kRegion; }

 private:
  void hold(std::size_t part) {
    held_.push_back(part);
    if (held_in_[part * kPart / kRegion]++ == 0) ++regions_;
  }

  void let_go(std::size_t part) {
    round_of_[part] = 0;
    const std::size_t region = part * kPart / kRegion;
    if (--held_in_[region] > 0) return;
    --regions_;
    const auto [from, to] = bytes_of(region * kRegion, kRegion);
    release_pages(from, static_cast<std::size_t>(to - from));
  }

  // What of the file lies `size` bytes from `offset` on, counted from first_.
  [[nodiscard]] std::pair<const std::byte*, const std::byte*> bytes_of(std::size_t offset,
                                                                       std::size_t size) const {
    const std::size_t before = reinterpret_cast<std::uintptr_t>(begin_) - first_;
    return {begin_ + (std::max(offset, before) - before), std::min(begin_ + (offset + size - before), end_)};
  }

  const std::uintptr_t first_;  // start of the region that the file begins in
  const std::byte* const begin_;
  const std::byte* const end_;
  std::uint32_t round_ = 0;
  std::size_t regions_ = 0;              // with a part that is held
  std::vector<std::uint32_t> round_of_;  // in which a part was last wanted; 0: it is not held
  std::vector<std::uint32_t> held_in_;   // parts, by region
  std::vector<std::size_t> held_;
};

struct Told {
  DeviceFrame frame;
  std::uint64_t number = 0;
};

/// A hand as the thread knows it.
struct FollowedHand {
  Newest<Told> newest;
  std::uint64_t told = 0;  // the ticking thread's own
  std::atomic<std::uint64_t> looked{0};
  Box box;   // where it is, and
  Box seen;  // where it was when its neighbourhood was last touched; far from everything at first
  bool known = false;
  Vec3 place, velocity;  // [m], [m/s] of its middle
  Clock::time_point placed_at;
};

// False where the frame does not tell where the hand is.
bool follow(const DeviceFrame& frame, Clock::time_point now, FollowedHand& hand) {
  if (!box_round(frame, hand.box)) return false;
  hand.known = true;
  const double passed = std::chrono::duration<double>(now - hand.placed_at).count();
  if (passed < kVelocityTime) return true;
  hand.velocity = (hand.box.middle() - hand.place) / passed;
  if (!(norm(hand.velocity) <= kFastest)) hand.velocity = {};
  hand.place = hand.box.middle();
  hand.placed_at = now;
  return true;
}

double moved(const FollowedHand& hand) {
  return max(norm(hand.box.lower - hand.seen.lower), norm(hand.box.upper - hand.seen.upper));
}

struct TreePlace {
  const TreeLine* lines = nullptr;
  TreeLayout layout;
};

// Of no lines where the file was written to, so that there are none of that head.
TreePlace tree_place(const SphereGrid& grid, std::uint32_t tree) {
  const TreeHead head = grid.tree[tree];
  if (head.level_count > kTreeLevels) return {};
  const TreeLayout layout = layout_of(head);
  const std::size_t all = grid.lines.size();
  if (head.first_line > all || layout.lines > all - head.first_line) return {};
  return {grid.lines.data() + head.first_line, layout};
}

}  // namespace

struct WorldPager::Thread {
  Thread(const Model& of, const Options& chosen)
      : model(of), options(chosen), held_parts(*of.world), trees(of.world->grid.tree.size()) {}

  void run();
  [[nodiscard]] bool is_unchanged() const noexcept;
  void follow_hands();
  void look();
  void touch(const Box& box);

  Model model;  // shares the world, so that the mapping outlives the thread
  const Options options;
  HeldParts held_parts;
  std::vector<std::uint32_t> trees;
  std::array<FollowedHand, kMostHands> hands;
  Clock::time_point seen_at;

  std::atomic<std::size_t> held{0};
  std::atomic<bool> stop{false}, changed{false};
  Clock::time_point checked_at;
  std::mutex mutex;  // of the naps only
  std::condition_variable wake;
  std::thread thread;
};

// Everything that a search in the box reads: heads, trees, triangles, vertices.
void WorldPager::Thread::touch(const Box& box) {
  const SphereGrid& grid = model.world->grid;
  const Triangles& triangles = model.world->triangles;
  // Every search halves its way through the table of cells.
  held_parts.touch(grid.cell.data(), grid.cell.size() * sizeof(std::uint64_t));
  const auto found = std::span(trees).first(find_cells(grid, box, trees));
  for (const std::uint32_t tree : found) {
    held_parts.touch(&grid.tree[tree], sizeof(TreeHead));
    const auto [lines, layout] = tree_place(grid, tree);
    expect_pages(reinterpret_cast<const std::byte*>(lines), layout.lines * sizeof(TreeLine));
  }
  for (const std::uint32_t tree : found) {
    const auto [lines, layout] = tree_place(grid, tree);
    if (layout.lines == 0) continue;
    held_parts.touch(lines, layout.lines * sizeof(TreeLine));
    const std::uint32_t* const numbers = numbers_of(lines, layout);
    for (std::size_t k = 0; k < layout.lowest * SphereBlock::kWidth; ++k) {
      if (stop.load(std::memory_order_relaxed)) return;
      const std::uint32_t number = numbers[k];
      if (number >= triangles.size()) return;  // the file was written to
      for (const auto* corners : {&triangles.a, &triangles.b, &triangles.c}) {
        const std::uint32_t* const vertex = corners->data() + number;
        held_parts.touch(vertex, sizeof(*vertex));
        if (*vertex >= triangles.x.size()) return;  // the file was written to
        for (const auto* axis : {&triangles.x, &triangles.y, &triangles.z})
          held_parts.touch(axis->data() + *vertex, sizeof(double));
      }
    }
  }
}

// Near all hands in one round: what one needs is not let go of for the other.
void WorldPager::Thread::look() {
  held_parts.begin_round();
  for (FollowedHand& hand : hands) {
    if (!hand.known) continue;
    Box ahead = hand.box;
    ahead.add(hand.box.lower + options.horizon * hand.velocity);
    ahead.add(hand.box.upper + options.horizon * hand.velocity);
    touch(widened(ahead, options.reach));
    hand.seen = hand.box;
  }
  held_parts.release_others();
  held.store(held_parts.bytes(), std::memory_order_relaxed);
}

// Also of a change that there is no memory to tell the words of: nothing may leave the thread, nor end it,
// for catch_up() waits for it.
bool WorldPager::Thread::is_unchanged() const noexcept {
  try {
    return check_mapped(model.world->path, model.world->bytes.get()).ok();
  } catch (const std::exception&) {
    return false;
  }
}

void WorldPager::Thread::run() {
  while (!stop.load(std::memory_order_relaxed)) {
    if (const Clock::time_point now = Clock::now(); now - checked_at >= kCheck) {
      checked_at = now;
      if (!is_unchanged()) changed.store(true, std::memory_order_release);
    }
    follow_hands();
    std::unique_lock lock(mutex);
    wake.wait_for(lock, kNap, [&] { return stop.load(std::memory_order_relaxed); });
  }
}

// Looks again when a hand has moved, and from time to time, for what the system has taken away.
void WorldPager::Thread::follow_hands() {
  const Clock::time_point now = Clock::now();
  std::array<std::uint64_t, kMostHands> number{};
  bool wanted = false;
  for (std::size_t i = 0; i < hands.size(); ++i) {
    Told told;
    if (!hands[i].newest.take(told)) continue;
    number[i] = told.number;
    if (follow(told.frame, now, hands[i]))
      wanted = wanted || moved(hands[i]) > kStep * options.reach || now - seen_at >= kAgain;
  }
  if (wanted) {
    look();
    seen_at = now;
  }
  for (std::size_t i = 0; i < hands.size(); ++i)
    if (number[i] > 0) hands[i].looked.store(number[i], std::memory_order_release);
}

WorldPager::WorldPager(const Model& model, const Options& options) {
  if (!model.world || model.world->triangles.size() == 0) return;
  try {
    auto started = std::make_unique<Thread>(model, options);
    started->thread = std::thread([raw = started.get()] { raw->run(); });
    thread_ = std::move(started);
  } catch (const std::exception&) {
    // No memory or no thread: then ticks wait for the disk themselves.
  }
}

WorldPager::~WorldPager() {
  if (!thread_) return;
  thread_->stop.store(true, std::memory_order_relaxed);
  thread_->wake.notify_all();
  thread_->thread.join();
}

void WorldPager::hand_at(const DeviceFrame& frame, std::size_t hand) noexcept {
  assert(hand < kMostHands);
  if (!thread_) return;
  FollowedHand& followed = thread_->hands[hand];
  followed.newest.put({frame, ++followed.told});
}

void WorldPager::catch_up() {
  if (!thread_) return;
  for (const FollowedHand& hand : thread_->hands)
    while (hand.looked.load(std::memory_order_acquire) < hand.told) std::this_thread::sleep_for(kNap);
}

bool WorldPager::changed() const noexcept {
  return thread_ &&
         (thread_->changed.load(std::memory_order_acquire) || !is_whole(thread_->model.world->bytes.get()));
}

Status WorldPager::failure() const {
  if (!thread_) return {};
  const World& world = *thread_->model.world;
  Status status = check_mapped(world.path, world.bytes.get());
  // What has been changed back was changed all the same.
  return status.ok() && changed() ? changed_while_read(world.path) : status;
}

std::size_t WorldPager::held_bytes() const noexcept {
  return thread_ ? thread_->held.load(std::memory_order_relaxed) : 0;
}

}  // namespace lumbrical
