// SIGINT and SIGTERM: while a picture is traced the first asks for an end, at other times it ends the program at once, and
// so does the second always.
#pragma once
#include <atomic>

namespace rt::cli {

/// Installs the handlers. Before, and outside of an Interruptible, a signal ends the program with 128 + its number.
void handleInterrupts();

/// For its lifetime a signal only raises `stop`.
class Interruptible {
public:
    Interruptible();
    ~Interruptible();
    Interruptible(const Interruptible&) = delete;
    Interruptible& operator=(const Interruptible&) = delete;
};

/// Polled by the tracer; true from the first signal on.
const std::atomic<bool>& stopRequested();
/// 130 or 143 after a signal, else 0.
int interruptExitCode();

} // namespace rt::cli
