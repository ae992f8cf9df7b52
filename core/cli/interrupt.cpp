#include <core/cli/interrupt.hpp>

#include <core/cli/output_lock.hpp>

#include <csignal>

#include <unistd.h>

namespace rt::cli {

namespace {

std::atomic<bool> stop{false};
std::atomic<int> signalNumber{0};
std::atomic<int> interruptible{0};
static_assert(std::atomic<bool>::is_always_lock_free &&
              std::atomic<int>::is_always_lock_free); // used in the handler

extern "C" void onSignal(int number) {
    if (interruptible == 0 || stop.exchange(true)) {
        unlinkLocks();
        ::_exit(128 + number);
    }
    signalNumber = number;
}

} // namespace

void handleInterrupts() {
    for (const int number : {SIGINT, SIGTERM}) {
        struct sigaction action {};
        if (::sigaction(number, nullptr, &action) == 0 && action.sa_handler == SIG_IGN)
            continue; // nohup and background jobs
        action = {};
        action.sa_handler = onSignal;
        sigemptyset(&action.sa_mask);
        action.sa_flags = SA_RESTART;
        ::sigaction(number, &action, nullptr);
    }
}

Interruptible::Interruptible() { ++interruptible; }
Interruptible::~Interruptible() { --interruptible; }

const std::atomic<bool>& stopRequested() { return stop; }

int interruptExitCode() { return signalNumber == 0 ? 0 : 128 + signalNumber; }

} // namespace rt::cli
