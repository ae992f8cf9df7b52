// The one way to run work on threads.
#pragma once
#include <cstddef>
#include <functional>

namespace rt::parallel {

/// How many threads this process may use: the CPU affinity mask and the cgroup quota, never the machine's cores.
int availableThreads();

/// Calls body(i) once for each i < count on at most `threads` threads (0: availableThreads()), in no given order.
/// The first exception is rethrown here after all running calls have ended.
void forEach(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

/// Runs both, in parallel where a thread is free; nests.
void invoke(const std::function<void()>& a, const std::function<void()>& b);

/// Runs `body` so that forEach and invoke inside it use at most `threads` threads.
void withThreads(int threads, const std::function<void()>& body);

} // namespace rt::parallel
