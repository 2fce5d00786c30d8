// The device's side of shared memory: commands in, angles out, between two processes of one machine. Plain
// C99 on a POSIX system (and the atomic built-ins of gcc and clang), no other dependencies.
//
// The device's process creates the region (shm_open, mode 0600, ftruncate to its size, mmap), zeros it and
// calls lumbrical_shared_init. Where one of that name is left it unlinks it first, and never truncates it: a
// session that has it mapped would be killed. Then, as often as it likes: lumbrical_shared_take, and when
// that gave a new command lumbrical_shared_answer with its cycle. A device whose commands stop (no new cycle
// for as long as it dares to hold a force) lets go by itself: nothing else will, once the other process has
// been killed.
#ifndef LUMBRICAL_SHARED_DEVICE_H
#define LUMBRICAL_SHARED_DEVICE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

#define LUMBRICAL_SHARED_MAGIC UINT64_C(0x31305645444d554c)  // "LUMDEV01"
#define LUMBRICAL_SHARED_ACTUATORS 32
#define LUMBRICAL_SHARED_ANGLES 20

// All members are eight bytes, so that no compiler pads them.
typedef struct lumbrical_shared_command {
  uint64_t session;  // another number for each connection
  uint64_t cycle;    // counts from 1; 0: there was none yet
  uint64_t active;   // 1: switched on; 0: all values are safe ones
  uint64_t actuator_count;
  double value[LUMBRICAL_SHARED_ACTUATORS];  // in the actuators' own units, within the profile's limits
  // A local model (local_model.h) of each; stiffness 0: none.
  double angle[LUMBRICAL_SHARED_ACTUATORS];      // [rad]
  double stiffness[LUMBRICAL_SHARED_ACTUATORS];  // [N m/rad]
  double radius[LUMBRICAL_SHARED_ACTUATORS];     // [rad]
} lumbrical_shared_command;

typedef struct lumbrical_shared_feedback {
  uint64_t session;    // the command's
  uint64_t cycle;      // of the newest command taken, which is acknowledged thereby
  uint64_t not_ready;  // 1: takes no forces; those that acted end, and begin anew
  uint64_t fault;
  uint64_t stop;                          // 1: an emergency stop is pressed
  uint64_t dead_man;                      // 0: there is no such switch, 1: released, 2: held
  uint64_t valid;                         // bit i: angle i was measured
  double angle[LUMBRICAL_SHARED_ANGLES];  // [rad] thumb to little, abduction and three flexions of each
} lumbrical_shared_feedback;

// Each side is written by one process only: a session holds the region's lock (flock). A side's turn is odd
// while it is being written.
typedef struct lumbrical_shared_device {
  uint64_t magic;
  uint64_t size;  // of this struct
  uint64_t command_turn;
  uint64_t command[sizeof(lumbrical_shared_command) / 8];
  uint64_t feedback_turn;
  uint64_t feedback[sizeof(lumbrical_shared_feedback) / 8];
} lumbrical_shared_device;

static inline void lumbrical_shared_write(uint64_t* turn, uint64_t* to, const void* from, size_t size) {
  const uint64_t now = __atomic_load_n(turn, __ATOMIC_RELAXED);
  size_t i;
  __atomic_store_n(turn, now | 1, __ATOMIC_RELAXED);
  for (i = 0; i < size / 8; ++i) {
    uint64_t word;
    memcpy(&word, (const char*)from + 8 * i, 8);
    __atomic_store_n(to + i, word, __ATOMIC_RELEASE);  // not before the turn
  }
  __atomic_store_n(turn, (now | 1) + 1, __ATOMIC_RELEASE);
}

// 1: `to` holds what was written last; 0: it was being written, try again later.
static inline int lumbrical_shared_read(const uint64_t* turn, const uint64_t* from, void* to, size_t size) {
  const uint64_t before = __atomic_load_n(turn, __ATOMIC_ACQUIRE);
  size_t i;
  if (before & 1) return 0;
  for (i = 0; i < size / 8; ++i) {
    const uint64_t word = __atomic_load_n(from + i, __ATOMIC_ACQUIRE);  // not after the turn
    memcpy((char*)to + 8 * i, &word, 8);
  }
  return __atomic_load_n(turn, __ATOMIC_RELAXED) == before;
}

// The region is zeros.
static inline void lumbrical_shared_init(lumbrical_shared_device* device) {
  device->size = sizeof *device;
  __atomic_store_n(&device->magic, LUMBRICAL_SHARED_MAGIC, __ATOMIC_RELEASE);
}

// 1: `command` is one that was not taken yet; `command` begins as zeros.
static inline int lumbrical_shared_take(const lumbrical_shared_device* device,
                                        lumbrical_shared_command* command) {
  lumbrical_shared_command next;
  if (!lumbrical_shared_read(&device->command_turn, device->command, &next, sizeof next)) return 0;
  if (next.cycle == 0 || (next.cycle == command->cycle && next.session == command->session)) return 0;
  *command = next;
  return 1;
}

static inline void lumbrical_shared_answer(lumbrical_shared_device* device,
                                           const lumbrical_shared_feedback* feedback) {
  lumbrical_shared_write(&device->feedback_turn, device->feedback, feedback, sizeof *feedback);
}

#ifdef __cplusplus
}
#endif
#endif
