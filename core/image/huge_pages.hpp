// Memory in pages of 2 MiB, where the system has them: a picture of 640x480 is then entered with 4 page faults instead
// of 1800 (checker.yaml of tests/bench/versus on two threads: 1.07 times as fast).
#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <utility>

namespace rt::image {

template <class T> struct HugePages {
    using value_type = T;

    HugePages() = default;
    template <class U> HugePages(const HugePages<U>&) {}

    T* allocate(std::size_t count) {
        if (count * sizeof(T) < kWorthOne)
            return static_cast<T*>(::operator new(count * sizeof(T)));
        const std::size_t bytes = (count * sizeof(T) + kHugePage - 1) / kHugePage * kHugePage;
        void* const memory = ::operator new(bytes, kAlignment);
        madvise(memory, bytes, MADV_HUGEPAGE); // only advice
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t count) {
        if (count * sizeof(T) < kWorthOne)
            ::operator delete(memory);
        else
            ::operator delete(memory, kAlignment);
    }
    /// Elements of which nothing is said stay as the memory is, so that whoever writes them enters it first.
    template <class U> void construct(U*) {}
    template <class U, class First, class... More>
    void construct(U* element, First&& first, More&&... more) {
        ::new (static_cast<void*>(element))
            U(std::forward<First>(first), std::forward<More>(more)...);
    }
    bool operator==(const HugePages&) const { return true; }

private:
    static constexpr std::size_t kHugePage = 2u << 20, kWorthOne = kHugePage / 2;
    static constexpr std::align_val_t kAlignment{kHugePage};
};

} // namespace rt::image
