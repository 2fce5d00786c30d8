// See real_time.h.
#include "real_time.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace lumbrical::tool {
namespace {

constexpr std::size_t kStackTouched = std::size_t{256} << 10;

// Stack that ticks will need is mapped now rather than in a tick.
void touch_stack() {
  volatile char stack[kStackTouched];
  for (std::size_t i = 0; i < kStackTouched; i += 4096) stack[i] = 0;
  static_cast<void>(stack[0]);
}

// The last processor this process may use: the first ones usually serve interrupts.
int last_cpu() {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0 || CPU_COUNT(&allowed) < 2) return -1;
  for (int cpu = CPU_SETSIZE - 1; cpu >= 0; --cpu) {
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &allowed)) return cpu;
  }
  return -1;
}

}  // namespace

RealTime enter_real_time(int priority, Pinning pinning, std::span<const std::byte> pageable) {
  RealTime real_time;
  // All pages are read to be locked; where some are not meant to be, only those that are there already.
  const int which = MCL_CURRENT | MCL_FUTURE | (pageable.empty() ? 0 : MCL_ONFAULT);
  real_time.memory_locked = mlockall(which) == 0;
  if (real_time.memory_locked && !pageable.empty()) munlock(pageable.data(), pageable.size());
  if (!real_time.memory_locked) {
    real_time.refused.push_back(std::string("memory is not locked (") + std::strerror(errno) +
                                "): ticks may wait for pages; raise ulimit -l");
  }
  sched_param parameter{};
  parameter.sched_priority = priority;
  if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter); error == 0) {
    real_time.priority = priority;
  } else {
    real_time.refused.push_back(std::string("no real-time priority (") + std::strerror(error) +
                                "): other programs may delay ticks; raise ulimit -r");
  }
  touch_stack();
  if (pinning == Pinning::none) return real_time;
  const int cpu = last_cpu();
  if (cpu >= 0) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(cpu), &set);
    if (pthread_setaffinity_np(pthread_self(), sizeof set, &set) == 0) real_time.cpu = cpu;
  }
  if (real_time.cpu < 0) real_time.refused.push_back("not pinned: there is no second processor");
  return real_time;
}

void leave_real_time(const RealTime& real_time) {
  if (real_time.memory_locked) munlockall();
  if (real_time.priority > 0) {
    const sched_param parameter{};
    pthread_setschedparam(pthread_self(), SCHED_OTHER, &parameter);
  }
}

std::int64_t clock_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1000000000 + now.tv_nsec;
}

std::string utc_text() {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  tm parts{};
  gmtime_r(&now.tv_sec, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  std::array<char, 16> fraction{};
  std::snprintf(fraction.data(), fraction.size(), ".%09ldZ", now.tv_nsec);
  return std::string(text.data()) + fraction.data();
}

void sleep_until_ns(std::int64_t deadline) {
  const timespec until{static_cast<time_t>(deadline / 1000000000), static_cast<long>(deadline % 1000000000)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

std::uint64_t page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt) + static_cast<std::uint64_t>(usage.ru_majflt);
}

}  // namespace lumbrical::tool
