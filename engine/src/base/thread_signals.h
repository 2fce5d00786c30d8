// Which signals reach a thread.
#pragma once

#include <signal.h>
#include <time.h>

namespace lumbrical {

/// Of the calling thread: signals are other threads' affair, since a handler that waits for this one must not
/// run on it. But for those that a fault of its own raises.
inline void leave_signals_to_others() noexcept {
  sigset_t signals;
  sigfillset(&signals);
  for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS}) sigdelset(&signals, own);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

/// While it lives a file that would become longer than the process may write (RLIMIT_FSIZE) is an error of
/// that write of this thread, and not the end of a program that does not know SIGXFSZ.
class NoFileSizeSignal {
 public:
  NoFileSizeSignal() noexcept {
    sigemptyset(&own_);
    sigaddset(&own_, SIGXFSZ);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGXFSZ) == 1;
    pthread_sigmask(SIG_BLOCK, &own_, &before_);
  }
  NoFileSizeSignal(const NoFileSizeSignal&) = delete;
  NoFileSizeSignal& operator=(const NoFileSizeSignal&) = delete;
  ~NoFileSizeSignal() {
    const timespec now{};
    if (!was_pending_) sigtimedwait(&own_, nullptr, &now);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

 private:
  sigset_t own_{}, before_{};
  bool was_pending_ = false;
};

}  // namespace lumbrical
