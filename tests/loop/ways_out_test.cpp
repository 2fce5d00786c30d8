// What ends a process, and that forces fade before. Each death is died in a child.
#include "lumbrical/ways_out.h"
#include "files.h"
#include "fork.h"
#include "lumbrical/device_guard.h"
#include "lumbrical/mesh.h"
#include "lumbrical/shapes.h"
#include "lumbrical/world.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace lumbrical {
namespace {

struct Death {
  int signal = 0;     ///< that the child died of; 0: of none
  std::string wrote;  ///< by its last act
};

int last_words = -1;

void say_so() {
  const ssize_t count = write(last_words, "faded", 5);
  static_cast<void>(count);
}

Death die_by(const std::function<void()>& way) {
  std::array<int, 2> ends{};
  EXPECT_EQ(pipe(ends.data()), 0);
  const pid_t child = test::fork_alone();
  if (child == 0) {
    last_words = ends[1];
    before_dying(say_so);
    way();
    _exit(0);
  }
  close(ends[1]);
  Death death;
  std::array<char, 64> text{};
  for (ssize_t count = 0; (count = read(ends[0], text.data(), text.size())) > 0;)
    death.wrote.append(text.data(), static_cast<std::size_t>(count));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  death.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  return death;
}

void expect_faded(const std::function<void()>& way, int signal, const char* what) {
  const Death death = die_by(way);
  EXPECT_EQ(death.signal, signal) << what;
  EXPECT_EQ(death.wrote, "faded") << what << ": once, and before the end";
}

TEST(WaysOut, EverySignalThatEndsAProcessIsPrecededByTheLastAct) {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP, SIGXCPU, SIGALRM,
                           SIGVTALRM, SIGPROF, SIGIO, SIGPWR, SIGSTKFLT}) {
    expect_faded([signal] { raise(signal); }, signal, strsignal(signal));
  }
}

int rings = 0;

// A profiler's timer, a crash reporter, say.
TEST(WaysOut, WhatAProcessDoesWithItsSignalsIsItsOwnAgainAndItsTimersAreAllTheWhile) {
  const auto ring = [](int) { ++rings; };
  const Death death = die_by([ring] {
    before_dying(nullptr);
    for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGALRM, SIGVTALRM, SIGPROF, SIGIO})
      std::signal(signal, ring);
    std::signal(SIGVTALRM, SIG_IGN);
    before_dying(say_so);
    for (const int signal : {SIGALRM, SIGVTALRM, SIGPROF, SIGIO}) raise(signal);
    if (rings != 3) raise(SIGKILL);
    before_dying(say_so);
    before_dying(nullptr);
    for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGALRM, SIGVTALRM, SIGPROF, SIGIO}) raise(signal);
    if (rings != 9) raise(SIGKILL);
  });
  EXPECT_EQ(death.signal, 0) << strsignal(death.signal);
  EXPECT_EQ(death.wrote, "");
}

TEST(WaysOut, UncaughtExceptionsOfAnyThreadAreToo) {
  expect_faded([] { std::thread([] { throw std::bad_alloc(); }).join(); }, SIGABRT, "bad_alloc of a thread");
  const auto careless = [](int code) {
    if (code != 0) throw std::runtime_error("out");
  };
  expect_faded([careless]() noexcept { careless(1); }, SIGABRT, "exception where none may be");
}

// Goes down until the stack is gone.
[[gnu::noinline]] std::uint64_t descend(std::uint64_t depth) {
  volatile std::uint64_t block[512] = {};
  block[depth % 512] = depth;
  return depth == ~0ull ? 0 : descend(depth + 1) + block[(depth + 1) % 512];
}

TEST(WaysOut, AStackThatHasRunOverIsToo) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizers have a stack of their own for this";
#endif
  expect_faded([] { _exit(static_cast<int>(descend(0))); }, SIGSEGV, "stack");
}

TEST(WaysOut, ASecondThreadThatCrashesDoesNotCutTheLastActShort) {
  expect_faded(
      [] {
        static std::atomic<bool> fading{false};
        before_dying([] {
          fading = true;
          const timespec pause{0, 300000000};
          nanosleep(&pause, nullptr);
          say_so();
        });
        std::thread first([] { raise(SIGSEGV); });
        while (!fading) std::this_thread::yield();
        raise(SIGFPE);
        first.join();
      },
      SIGSEGV, "two threads");
}

TEST(WaysOut, WhatAsksForAnEndOnlyAsksTheFirstTimeAndEndsAfterTheLastActOnceImpatient) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    const Death polite = die_by([signal] {
      std::signal(SIGHUP, SIG_DFL);
      const StopSignals signals;
      if (stop_requested()) raise(SIGKILL);
      raise(signal);
      raise(signal);
      if (!stop_requested()) raise(SIGKILL);
      _exit(0);
    });
    EXPECT_EQ(polite.signal, 0) << strsignal(signal);
    EXPECT_EQ(polite.wrote, "");
  }
  expect_faded(
      [] {
        const StopSignals signals;
        raise(SIGINT);
        std::this_thread::sleep_for(std::chrono::milliseconds(1050));
        raise(SIGINT);
      },
      SIGINT, "twice, with time between");
}

TEST(WaysOut, AWorldFileThatIsCutWhileMappedReadsAsZerosAndIsToldSo) {
  const std::string path = (test::fresh_folder() / "sheet.world").string();
  WorldWriter writer;
  ASSERT_TRUE(writer.open(path, {}).ok());
  ASSERT_TRUE(writer.add_object({"sheet", make_plane(1, 60)}).ok());
  ASSERT_TRUE(writer.finish().ok());
  const Death death = die_by([&path] {
    mend_bus_errors(replace_lost_page);
    std::shared_ptr<const World> world;
    if (!open_world(path, world).ok() || any_page_lost()) raise(SIGKILL);
    std::filesystem::resize_file(path, 4096);
    unsigned sum = 0;
    for (std::size_t i = 4096; i < world->byte_count; ++i)
      sum += static_cast<unsigned>(world->bytes.get()[i]);
    if (sum != 0 || !any_page_lost()) raise(SIGKILL);
  });
  EXPECT_EQ(death.signal, 0);
  EXPECT_EQ(death.wrote, "") << "no way out, but a mishap";
}

// Says that it stands guard, and ends.
const std::vector<std::string> kBriefGuard = {"/bin/sh", "-c", "printf r >&0"};

TEST(WaysOut, AGuardThatEndsBeforeItStandsGuardIsNone) {
  DeviceGuard guard;
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(guard.start({"/bin/true"}).message(),
              "no guard: /bin/true: ended before it stood guard, and may have said why");
  }
  EXPECT_EQ(guard.start({"/nowhere"}).message(), "no guard: /nowhere: No such file or directory");
  EXPECT_TRUE(guard.start(kBriefGuard).ok());
  guard.dismiss();
}

TEST(WaysOut, DismissingAGuardThatIsGoneIsNone) {
  const Death death = die_by([] {
    std::signal(SIGPIPE, SIG_DFL);
    DeviceGuard guard;
    if (!guard.start(kBriefGuard).ok()) raise(SIGKILL);
    siginfo_t gone{};
    waitid(P_ALL, 0, &gone, WEXITED | WNOWAIT);
    guard.dismiss();
  });
  EXPECT_EQ(death.signal, 0) << strsignal(death.signal);
}

TEST(WaysOut, ATerminalThatHangsUpIsNoReasonUnderNohup) {
  const Death death = die_by([] {
    std::signal(SIGHUP, SIG_IGN);
    const StopSignals signals;
    raise(SIGHUP);
    if (stop_requested()) raise(SIGKILL);
  });
  EXPECT_EQ(death.signal, 0);
}

}  // namespace
}  // namespace lumbrical
