#include <core/parallel/parallel.hpp>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>

#include <sched.h>
#include <signal.h>
#ifdef RT_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace rt::parallel {
namespace {

int affinityThreads() {
    // The mask grows until the kernel's own fits; machines with more than 1024 CPUs exist.
    for (int cpus = 1024; cpus <= (1 << 20); cpus *= 2) {
        std::vector<cpu_set_t> mask(static_cast<std::size_t>(cpus) / 1024);
        const std::size_t bytes = mask.size() * sizeof(cpu_set_t);
        if (sched_getaffinity(0, bytes, mask.data()) == 0)
            return std::max(1, CPU_COUNT_S(bytes, mask.data()));
    }
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

std::optional<double> leadingNumber(std::string_view& text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{}) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return value;
}

std::string firstLine(const std::string& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    return line;
}

/// CPUs' worth of time that one cgroup directory grants; nothing when it sets no limit.
std::optional<double> cgroupQuota(const std::string& v2, const std::string& v1) {
    const std::string line = firstLine(v2 + "/cpu.max"); // "max 100000" or "150000 100000"
    std::string_view rest = line;
    if (const auto quota = leadingNumber(rest))
        if (const auto period = leadingNumber(rest); period && *period > 0) return *quota / *period;
    const std::string quotaLine = firstLine(v1 + "/cpu.cfs_quota_us");
    const std::string periodLine = firstLine(v1 + "/cpu.cfs_period_us");
    std::string_view quotaText = quotaLine, periodText = periodLine;
    const auto quota = leadingNumber(quotaText), period = leadingNumber(periodText);
    if (quota && period && *quota > 0 && *period > 0) return *quota / *period;
    return std::nullopt;
}

/// The tightest quota on the way from this process's cgroup to the root.
std::optional<double> tightestQuota() {
    std::optional<double> tightest;
    const auto consider = [&](std::string path) {
        for (;;) {
            const auto quota = cgroupQuota("/sys/fs/cgroup" + path, "/sys/fs/cgroup/cpu" + path);
            if (quota && (!tightest || *quota < *tightest)) tightest = quota;
            const auto slash = path.rfind('/');
            if (slash == std::string::npos) return;
            path.resize(slash);
        }
    };
    std::ifstream file("/proc/self/cgroup"); // lines "hierarchy:controllers:path"
    for (std::string line; std::getline(file, line);)
        if (const auto colon = line.find(":/"); colon != std::string::npos)
            consider(line.substr(colon + 1));
    consider("");
    return tightest;
}

/// True on threads that run inside an arena made here: nested calls stay in it.
thread_local bool insideArena = false;

class Inside {
public:
    Inside() { insideArena = true; }
    ~Inside() { insideArena = before_; }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;

private:
    bool before_ = insideArena;
};

/// Tells ThreadSanitizer, which does not see into oneTBB, that what came before give() is seen after take().
class Handover {
public:
#ifdef RT_THREAD_SANITIZER
    void give() { __tsan_release(this); }
    void take() { __tsan_acquire(this); }
#else
    void give() {}
    void take() {}
#endif
};

/// Around what runs tasks: they see what the caller did before, and the caller what they did.
class Tasks {
public:
    Tasks() { begun_.give(); }
    ~Tasks() { ended_.take(); }
    Tasks(const Tasks&) = delete;
    Tasks& operator=(const Tasks&) = delete;

    /// Around one task.
    class Task {
    public:
        explicit Task(Tasks& tasks) : tasks_(tasks) { tasks_.begun_.take(); }
        ~Task() { tasks_.ended_.give(); }
        Task(const Task&) = delete;
        Task& operator=(const Task&) = delete;

    private:
        Tasks& tasks_;
        const Inside inside_;
    };

private:
    Handover begun_, ended_;
};

/// Gives each worker a stack for signal handlers, so that the overflow of its own can be reported.
class HandlerStacks : public tbb::task_scheduler_observer {
public:
    explicit HandlerStacks(tbb::task_arena& arena) : task_scheduler_observer(arena) { observe(); }
    ~HandlerStacks() override { observe(false); }

    void on_scheduler_entry(bool isWorker) override {
        // Untouched until it is needed.
        alignas(16) thread_local std::array<char, std::size_t{1} << 16> memory;
        thread_local bool given = false;
        if (!isWorker || given) return;
        stack_t stack{};
        stack.ss_sp = memory.data();
        stack.ss_size = memory.size();
        given = sigaltstack(&stack, nullptr) == 0;
    }
};

} // namespace

int availableThreads() {
    static const int threads = [] {
        const int allowed = affinityThreads();
        const auto quota = tightestQuota();
        // A quota of 1.5 CPUs is one thread: two would be stopped for a quarter of each period.
        return quota ? std::clamp(static_cast<int>(std::min(*quota, 1e6)), 1, allowed) : allowed;
    }();
    return threads;
}

void withThreads(int threads, const std::function<void()>& body) {
    const int count = threads > 0 ? threads : availableThreads();
    // TBB starts no more workers than the machine has cores unless told.
    auto workers = std::make_unique<tbb::global_control>(
        tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
    tbb::task_arena arena(count);
    try {
        arena.initialize(); // here, since an observer that fails to do it cannot be destroyed
    } catch (const std::bad_alloc&) {
        (void)workers.release(); // its destructor would wait for what was not made
        throw;
    }
    const HandlerStacks stacks(arena);
    arena.execute([&] {
        const Inside inside;
        body();
    });
}

void forEach(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
    if (threads == 0 && insideArena) {
        Tasks tasks;
        tbb::parallel_for(
            std::size_t{0}, count,
            [&](std::size_t i) {
                const Tasks::Task task(tasks);
                body(i);
            },
            tbb::simple_partitioner{});
        return;
    }
    if (threads == 1 || (threads == 0 && availableThreads() == 1)) {
        for (std::size_t i = 0; i < count; ++i) body(i);
        return;
    }
    withThreads(threads, [&] { forEach(count, 0, body); });
}

void invoke(const std::function<void()>& a, const std::function<void()>& b) {
    if (!insideArena) return withThreads(0, [&] { invoke(a, b); });
    Tasks tasks;
    tbb::parallel_invoke(
        [&] {
            const Tasks::Task task(tasks);
            a();
        },
        [&] {
            const Tasks::Task task(tasks);
            b();
        });
}

} // namespace rt::parallel
