#include <core/plugin_host/fault_report.hpp>

#include <core/plugin_host/module.hpp>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <dlfcn.h>
#include <link.h>
#include <sys/resource.h>
#include <unistd.h>
#include <unwind.h>

namespace rt::plugin_host {
namespace {

constexpr int kExitPlugin = 5, kExitOutput = 6, kExitInternal = 70; // as in core/cli/exit_codes.hpp

struct NamedCall {
    std::atomic<const void*> function;
    const char* call;
};
std::array<NamedCall, 256> namedCalls; // custom shapes of more modules than this stay unnamed
std::atomic<std::size_t> namedCallCount{0};

constinit thread_local std::atomic<const Call*> runningCall{
    nullptr}; // loaders may run side by side
constinit thread_local std::atomic<const char*> openingLibrary{nullptr};
std::atomic<bool> exitExpected{false}, saysJson{false};
std::atomic<pid_t> reportingThread{0};

// ---- everything below runs in a signal handler: no allocation, no lock, no library that may hold one ----------------

/// A line for stderr, built in place; what does not fit is cut.
class Line {
public:
    /// As it is; for what JSON itself is made of.
    Line& raw(std::string_view text) {
        for (const char c : text) put(c);
        return *this;
    }
    Line& operator<<(std::string_view text) {
        for (const char c : text) { // file names may hold control characters
            if (saysJson && (c == '"' || c == '\\')) put('\\');
            put(static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c);
        }
        return *this;
    }
    Line& operator<<(std::uint64_t number) {
        char digits[20];
        std::size_t first = sizeof digits;
        do digits[--first] = static_cast<char>('0' + number % 10);
        while ((number /= 10) != 0);
        return *this << std::string_view(digits + first, sizeof digits - first);
    }
    Line& hexadecimal(std::uint64_t number) {
        char digits[16];
        std::size_t first = sizeof digits;
        do digits[--first] = "0123456789abcdef"[number & 15];
        while ((number >>= 4) != 0);
        return *this << "0x" << std::string_view(digits + first, sizeof digits - first);
    }
    void print() {
        text_[size_++] = '\n';
        for (std::size_t from = 0; from < size_;) {
            const ssize_t written = write(STDERR_FILENO, text_.data() + from, size_ - from);
            if (written <= 0) return;
            from += static_cast<std::size_t>(written);
        }
    }

private:
    void put(char c) {
        if (size_ + 1 < text_.size()) text_[size_++] = c;
    }

    std::array<char, 16384> text_; // three paths and more
    std::size_t size_ = 0;
};

/// A frame of a plugin's code.
struct PluginFrame {
    std::string_view file; // the module's path; empty: none
    std::uint64_t offset = 0;
};

/// The plugin's frames on this stack: the innermost is where it went wrong, the outermost is what rt had called.
struct StackWalk {
    PluginFrame innermost;
    const void* calledFunction = nullptr;
    std::size_t frames = 0;
};

_Unwind_Reason_Code visitFrame(_Unwind_Context* context, void* data) {
    constexpr std::size_t kMostFrames = std::size_t{1} << 22; // more than any stack holds
    StackWalk& walk = *static_cast<StackWalk*>(data);
    if (++walk.frames > kMostFrames) return _URC_END_OF_STACK;
    int beforeInstruction = 0;
    auto at = _Unwind_GetIPInfo(context, &beforeInstruction);
    if (at == 0) return _URC_NO_REASON;
    if (!beforeInstruction) --at; // a return address may lie in the next function
    dl_find_object found{};
    if (_dl_find_object(reinterpret_cast<void*>(at), &found) != 0) return _URC_NO_REASON;
    const std::string_view file = found.dlfo_link_map->l_name;
    if (!file.ends_with(kModuleSuffix)) return _URC_NO_REASON;
    if (walk.innermost.file.empty())
        walk.innermost = {file, at - static_cast<std::uint64_t>(found.dlfo_link_map->l_addr)};
    walk.calledFunction = _Unwind_FindEnclosingFunction(reinterpret_cast<void*>(at));
    return _URC_NO_REASON;
}

std::string_view nameOf(const void* function) {
    const std::size_t count = namedCallCount;
    for (std::size_t i = 0; i < count; ++i)
        if (namedCalls[i].function == function) return namedCalls[i].call;
    return {};
}

std::string_view describe(int signalNumber) {
    switch (signalNumber) {
    case SIGSEGV:
        return "a segmentation fault (SIGSEGV)";
    case SIGBUS:
        return "a bus error (SIGBUS)";
    case SIGFPE:
        return "a wrong integer operation, such as a division by 0 (SIGFPE)";
    case SIGILL:
        return "an illegal instruction (SIGILL)";
    case SIGABRT:
        return "a call of abort (SIGABRT)";
    default:
        return "a call of exit";
    }
}

/// "scene.yaml:3:5: error[E0533]: shape 'torus': … in its lower, at torus.rtplugin.so+0x1234". The exit code.
int report(int signalNumber, const StackWalk& walk, bool stackIsReadable) {
    Line line;
    const Call* const call = runningCall;
    const bool inPlugin = !walk.innermost.file.empty() || (call != nullptr && !stackIsReadable);
    if (!inPlugin) {
        // Whoever ended the program like this, it was not a plugin.
        const char* const library = openingLibrary;
        if (library != nullptr)
            line.raw(saysJson ? "{\"severity\":\"error\",\"code\":\"E0606\",\"message\":\""
                              : "rt: error[E0606]: ")
                << library << " cannot be opened: a library of it ended in "
                << describe(signalNumber) << "; nothing is written";
        else
            line.raw(saysJson ? "{\"severity\":\"error\",\"exit\":70,\"message\":\""
                              : "rt: error: ")
                << "internal error: " << describe(signalNumber) << "; please report it";
        line.raw(saysJson ? "\"}" : "").print();
        return library != nullptr ? kExitOutput : kExitInternal;
    }
    const bool isLocated = call != nullptr && call->location.source != nullptr;
    if (isLocated && saysJson)
        (((line.raw("{\"file\":\"") << call->location.source->path).raw("\",\"line\":")
          << std::uint64_t{call->location.line})
             .raw(",\"column\":")
         << std::uint64_t{call->location.column})
            .raw(",");
    else if (isLocated)
        line << call->location.source->path << ":" << std::uint64_t{call->location.line} << ":"
             << std::uint64_t{call->location.column} << ": error[E0533]: ";
    else
        line.raw(saysJson ? "{" : "rt: error[E0533]: ");
    if (saysJson) line.raw("\"severity\":\"error\",\"code\":\"E0533\",\"message\":\"");
    const std::string_view path = walk.innermost.file;
    const std::string_view file = path.substr(path.rfind('/') + 1);
    if (call != nullptr)
        line << call->subject;
    else
        line << "plugin '" << stemOf(file) << "'";
    line << ": its code ended in " << describe(signalNumber);
    if (const std::string_view name = nameOf(walk.calledFunction); !name.empty())
        line << " in its function " << name;
    if (!file.empty()) {
        line << ", at " << file << "+";
        line.hexadecimal(walk.innermost.offset);
        line << " (addr2line -Cfe " << path << " ";
        line.hexadecimal(walk.innermost.offset) << ")";
    }
    line << "; nothing is written";
    line.raw(saysJson ? "\"}" : "").print();
    return kExitPlugin;
}

bool coreIsWanted() {
    rlimit limit{};
    return getrlimit(RLIMIT_CORE, &limit) == 0 && limit.rlim_cur != 0;
}

extern "C" void onFault(int number) {
    pid_t nobody = 0;
    if (!reportingThread.compare_exchange_strong(nobody, gettid())) {
        if (nobody != gettid())
            for (;;) pause(); // one report is enough
        // The fault is in the report: the stack is damaged.
        _exit(report(number, {}, false));
    }
    StackWalk walk;
    _Unwind_Backtrace(visitFrame, &walk);
    const int exitCode = report(number, walk, true);
    if (coreIsWanted()) {
        std::signal(number, SIG_DFL);
        raise(number); // delivered on return, where the fault happened
        return;
    }
    _exit(exitCode);
}

void onExit() {
    if (exitExpected) return;
    StackWalk walk;
    _Unwind_Backtrace(visitFrame, &walk);
    _exit(report(0, walk, true));
}

alignas(16) std::array<char, std::size_t{1} << 16> handlerStack; // for the main thread's overflow

} // namespace

void reportFaults() {
    stack_t stack{};
    stack.ss_sp = handlerStack.data();
    stack.ss_size = handlerStack.size();
    sigaltstack(&stack, nullptr);
    // The first walk opens what later ones need.
    StackWalk walk;
    _Unwind_Backtrace(visitFrame, &walk);
    for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
        struct sigaction action {};
        if (sigaction(number, nullptr, &action) == 0 && action.sa_handler != SIG_DFL) continue;
        action = {};
        action.sa_handler = onFault;
        sigemptyset(&action.sa_mask);
        action.sa_flags = SA_ONSTACK | SA_NODEFER;
        sigaction(number, &action, nullptr);
    }
    std::atexit(onExit);
}

void expectExit() { exitExpected = true; }

void reportFaultsAsJson() { saysJson = true; }

void nameCall(const void* function, const char* call) {
    if (function == nullptr || !nameOf(function).empty()) return;
    const std::size_t at = namedCallCount;
    if (at == namedCalls.size()) return;
    namedCalls[at].call = call;
    namedCalls[at].function = function;
    namedCallCount = at + 1;
}

RunningCall::RunningCall(const Call& call) : before_(runningCall.exchange(&call)) {}
RunningCall::~RunningCall() { runningCall = before_; }

OpeningLibrary::OpeningLibrary(const char* what) { openingLibrary = what; }
OpeningLibrary::~OpeningLibrary() { openingLibrary = nullptr; }

} // namespace rt::plugin_host
