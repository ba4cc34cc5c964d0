// SPDX-License-Identifier: BSD-3-Clause
// SIGINT and SIGTERM shut the contexts down. The handler only posts to a semaphore; a thread that
// waits for it does the rest.
#include <semaphore.h>
#include <signal.h>

#include <atomic>
#include <cerrno>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "rclcpp/utilities.hpp"

namespace rclcpp {

namespace {
/// A signal handler has no argument: what it touches must be global.
struct Signals {
  sem_t arrived{};
  std::atomic_bool stop{false};
  std::atomic_bool got_signal{false};
  std::mutex mutex;
  std::thread thread;
  bool installed{false};
  bool interrupt{false};
  bool terminate{false};
  struct sigaction old_interrupt {};
  struct sigaction old_terminate {};

  Signals() { sem_init(&arrived, 0, 0); }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  ~Signals() {
    uninstall();
    sem_destroy(&arrived);
  }
  bool uninstall();
};

Signals& signals() {
  static Signals instance;
  return instance;
}
std::atomic<Signals*> active{nullptr};

void on_signal(int number) {
  const int kept_errno = errno;
  if (auto* const state = active.load()) {
    const auto& old = number == SIGINT ? state->old_interrupt : state->old_terminate;
    if ((old.sa_flags & SA_SIGINFO) == 0 && old.sa_handler != SIG_DFL &&
        old.sa_handler != SIG_IGN && old.sa_handler != nullptr) {
      old.sa_handler(number);
    }
    state->got_signal = true;
    sem_post(&state->arrived);
  }
  errno = kept_errno;
}

void wait_for_signals(Signals& state) {
  while (true) {
    if (sem_wait(&state.arrived) != 0) continue;
    if (state.got_signal.exchange(false)) {
      const auto context = contexts::get_global_default_context();
      if (context->get_init_options().shutdown_on_signal) context->shutdown("signal handler");
    }
    if (state.stop) return;
  }
}

void take_over(int number, struct sigaction& old) {
  struct sigaction action {};
  sigemptyset(&action.sa_mask);
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  if (sigaction(number, &action, &old) != 0) {
    throw std::runtime_error("cannot handle signal " + std::to_string(number));
  }
}

bool Signals::uninstall() {
  {
    const std::lock_guard<std::mutex> lock(mutex);
    // Called from a shutdown callback on the thread itself, it cannot wait for its own end.
    if (!installed || thread.get_id() == std::this_thread::get_id()) return false;
    if (interrupt) sigaction(SIGINT, &old_interrupt, nullptr);
    if (terminate) sigaction(SIGTERM, &old_terminate, nullptr);
    interrupt = terminate = installed = false;
    active = nullptr;
  }
  stop = true;
  sem_post(&arrived);
  thread.join();
  stop = false;
  return true;
}
}  // namespace

bool install_signal_handlers(SignalHandlerOptions wanted) {
  if (wanted == SignalHandlerOptions::None) return false;
  contexts::get_global_default_context();  // made first, so that it is destroyed last
  auto& state = signals();
  const std::lock_guard<std::mutex> lock(state.mutex);
  if (state.installed) return false;
  state.thread = std::thread([&state] { wait_for_signals(state); });
  state.installed = true;
  active = &state;
  if (wanted != SignalHandlerOptions::SigTerm) {
    take_over(SIGINT, state.old_interrupt);
    state.interrupt = true;
  }
  if (wanted != SignalHandlerOptions::SigInt) {
    take_over(SIGTERM, state.old_terminate);
    state.terminate = true;
  }
  return true;
}

bool signal_handlers_installed() {
  auto& state = signals();
  const std::lock_guard<std::mutex> lock(state.mutex);
  return state.installed;
}

bool uninstall_signal_handlers() {
  return signals().uninstall();
}

}  // namespace rclcpp
