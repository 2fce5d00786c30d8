// The other end of lumbrical/shared_memory_wire.h: a device without inertia, whose fingers close and open
// once a second. A real one would write the values to its motors. C99 and Linux, nothing else of Lumbrical.
//   shared_device /NAME SECONDS
#define _GNU_SOURCE
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "lumbrical/shared_device.h"

// It goes on while the machine is asleep, so that the watchdog has run out when it wakes.
static double now(void) {
  struct timespec time;
  clock_gettime(CLOCK_BOOTTIME, &time);
  return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

int main(int argc, char** argv) {
  const struct timespec pause = {0, 100000};
  const double start = now(), watchdog = 0.1;  // [s]
  if (argc != 3) return fprintf(stderr, "shared_device /NAME SECONDS\n"), 2;
  shm_unlink(argv[1]);
  const int file = shm_open(argv[1], O_RDWR | O_CREAT | O_EXCL, 0600);
  if (file < 0 || ftruncate(file, sizeof(lumbrical_shared_device)) != 0) return perror(argv[1]), 1;
  lumbrical_shared_device* const device =
      mmap(NULL, sizeof *device, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (device == MAP_FAILED) return perror(argv[1]), 1;
  lumbrical_shared_init(device);

  lumbrical_shared_command command = {0};
  double came = start, largest = 0, motor[LUMBRICAL_SHARED_ACTUATORS] = {0};
  while (now() < start + atof(argv[2])) {
    if (lumbrical_shared_take(device, &command)) {
      lumbrical_shared_feedback feedback = {0};
      came = now();
      for (unsigned i = 0; i < LUMBRICAL_SHARED_ACTUATORS; ++i) {
        motor[i] = command.active ? command.value[i] : 0;
        largest = fmax(largest, fabs(motor[i]));
      }
      for (unsigned finger = 0; finger < 5; ++finger) {
        for (unsigned joint = 1; joint < 4; ++joint) {
          feedback.angle[4 * finger + joint] = 0.4 - 0.4 * cos(6.28 * (came - start));
          feedback.valid |= UINT64_C(1) << (4 * finger + joint);
        }
      }
      feedback.session = command.session;
      feedback.cycle = command.cycle;
      lumbrical_shared_answer(device, &feedback);
    } else if (now() > came + watchdog) {  // no one is there any more
      for (unsigned i = 0; i < LUMBRICAL_SHARED_ACTUATORS; ++i) motor[i] = 0;
    }
    nanosleep(&pause, NULL);
  }
  printf("largest command %.3f\n", largest);
  shm_unlink(argv[1]);
  return 0;
}
