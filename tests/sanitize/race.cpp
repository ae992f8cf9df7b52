// Tasks that count together without a word between them: ThreadSanitizer must see that.
#include <core/parallel/parallel.hpp>

#include <chrono>
#include <cstdio>
#include <thread>

int main() {
    int count = 0;
    rt::parallel::forEach(64, 4, [&](std::size_t) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1)); // so that no thread takes all
        ++count;
    });
    std::printf("%d\n", count);
}
