// See lumbrical/real_time.h.
#include "lumbrical/real_time.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <time.h>

#include <cassert>
#include <cerrno>
#include <cstring>

#include "base/steady_clock.h"
#include "loop/scheduling.h"

namespace lumbrical {
namespace {

constexpr std::size_t kStackTouched = std::size_t{256} << 10;

// Stack that ticks will need is mapped now rather than in a tick.
void touch_stack() {
  volatile char stack[kStackTouched];
  for (std::size_t i = 0; i < kStackTouched; i += 4096) stack[i] = 0;
  static_cast<void>(stack[0]);
}

std::vector<int> allowed_cpus() {
  std::vector<int> cpus;
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &allowed)) cpus.push_back(cpu);
  }
  return cpus;
}

}  // namespace

bool stay_on(std::span<const int> cpus) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int cpu : cpus) CPU_SET(static_cast<std::size_t>(cpu), &set);
  return pthread_setaffinity_np(pthread_self(), sizeof set, &set) == 0;
}

int take_priority(int priority) {
  sched_param parameter{};
  parameter.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
}

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
  if (const int error = take_priority(priority); error == 0) {
    real_time.priority = priority;
  } else {
    real_time.refused.push_back(std::string("no real-time priority (") + std::strerror(error) +
                                "): other programs may delay ticks; raise ulimit -r");
  }
  touch_stack();
  if (pinning == Pinning::none) return real_time;
  real_time.cpus = allowed_cpus();
  // The last one: the first ones usually serve interrupts.
  if (real_time.cpus.size() > 1 && stay_on(std::span(real_time.cpus).last(1)))
    real_time.cpu = real_time.cpus.back();
  if (real_time.cpu < 0) real_time.refused.push_back("not pinned: there is no second processor");
  return real_time;
}

void leave_real_time(const RealTime& real_time) {
  if (real_time.memory_locked) munlockall();
  if (real_time.priority > 0) {
    const sched_param parameter{};
    pthread_setschedparam(pthread_self(), SCHED_OTHER, &parameter);
  }
  if (real_time.cpu >= 0) stay_on(real_time.cpus);
}

std::int64_t clock_ns() { return steady_ns(); }

void sleep_until_ns(std::int64_t deadline) {
  const timespec until{static_cast<time_t>(deadline / 1000000000), static_cast<long>(deadline % 1000000000)};
  while (clock_nanosleep(kSteadyClock, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

Pace start_pace(double rate) {
  assert(rate > 0);
  return {rate, clock_ns()};
}

std::int64_t period_of(const Pace& pace) { return static_cast<std::int64_t>(1e9 / pace.rate); }

std::int64_t moment_of(const Pace& pace, std::uint64_t tick) {
  return pace.first + static_cast<std::int64_t>(static_cast<double>(tick) * 1e9 / pace.rate);
}

void forgive_late(std::uint64_t tick, std::int64_t end, Pace& pace) {
  const std::int64_t moment = moment_of(pace, tick), period = period_of(pace);
  if (end > moment + 2 * period) pace.first += end - (moment + period);
}

}  // namespace lumbrical
