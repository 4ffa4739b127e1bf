#include "app/interrupt.h"

#include <array>
#include <atomic>
#include <csignal>

#include "app/exit_status.h"

namespace mjdiag::app {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM};

// The first signal that came; 0: none.
std::atomic<int> wish = 0;
static_assert(std::atomic<int>::is_always_lock_free);
std::array<struct sigaction, kSignals.size()> before;

void Take(int number) {
  if (wish.exchange(number) == 0) return;
  // Once more: as if nobody listened, when this handler returns.
  std::signal(number, SIG_DFL);
  std::raise(number);
}

}  // namespace

Interrupt::Interrupt() {
  wish = 0;
  struct sigaction action {};
  action.sa_handler = Take;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], &action, &before[i]);
  }
}

Interrupt::~Interrupt() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], &before[i], nullptr);
  }
}

bool Interrupt::IsWished() { return wish != 0; }

void Interrupt::ThrowIfWished() {
  if (IsWished()) throw Interrupted{wish};
}

}  // namespace mjdiag::app
