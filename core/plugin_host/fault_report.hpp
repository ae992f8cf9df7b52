// A fault in a plugin's code names the plugin before the program ends. Nothing is paid for until it happens: the handler
// finds the module from the addresses on the stack.
#pragma once
#include <core/plugin_host/call.hpp>

namespace rt::plugin_host {

/// Installs a handler of SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT, unless somebody else (a sanitizer) has one, and
/// looks at who calls exit(). What they say goes to stderr; then the program ends with exit code 5 when a plugin's
/// code was running, 6 when an output's library was being opened and 70 otherwise, or by the signal itself where core
/// files are wanted (ulimit -c).
void reportFaults();

/// What they say is a line of JSON from now on, shaped as the other diagnostics are.
void reportFaultsAsJson();

/// From now on, exit() is the program's own.
void expectExit();

/// Says that a plugin's function at `function` is its `call`, "intersect" for one. [setup]
void nameCall(const void* function, const char* call);

template <class Function> void nameCall(Function* function, const char* call) {
    nameCall(reinterpret_cast<const void*>(function), call);
}

/// While it lives, one of the [setup] calls into a plugin runs on this thread, and a fault is located where the scene asked for it.
class RunningCall {
public:
    explicit RunningCall(const Call& call);
    ~RunningCall();
    RunningCall(const RunningCall&) = delete;
    RunningCall& operator=(const RunningCall&) = delete;

private:
    const Call* before_; // a shape's call goes on after the loader's inside it
};

/// While it lives, this thread opens libraries of others to write an output: a fault is not called rt's own. libgcrypt, which
/// FFmpeg brings, aborts where it cannot read a file of the system's.
class OpeningLibrary {
public:
    explicit OpeningLibrary(const char* what); // "the film encoder", a literal
    ~OpeningLibrary();
    OpeningLibrary(const OpeningLibrary&) = delete;
    OpeningLibrary& operator=(const OpeningLibrary&) = delete;
};

} // namespace rt::plugin_host
