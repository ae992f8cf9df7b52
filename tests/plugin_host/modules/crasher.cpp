// Ends the program in each way a plugin can, from each of the calls of a shape.
#include <rt/plugin.hpp>

#include <csignal>
#include <cstdlib>

namespace {

enum class Act { nothing, address, divide, illegal, abort, terminate, overflow, exit, loop };

struct Crasher {
    Act lower, intersect;
};

constexpr const char* kActs = "nothing|address|divide|illegal|abort|terminate|overflow|exit|loop";
constexpr std::array kParameters{
    rt::choice<&Crasher::lower>("lower", kActs, "nothing", "What lower does."),
    rt::choice<&Crasher::intersect>("intersect", kActs, "nothing", "What intersect does.")};

volatile int zero = 0;
volatile int* volatile nowhere = nullptr;

int recurse(int depth) {         // as deep as the stack and deeper
    if (zero != 0) return depth; // never
    volatile char page[4096];
    page[depth % 4096] = static_cast<char>(depth);
    return recurse(depth + 1) + page[0];
}

void throwSeven() { throw 7; }
void terminate() noexcept { throwSeven(); }

void act(Act what) {
    switch (what) {
    case Act::nothing:
        return;
    case Act::address:
        *nowhere = 1;
        return;
    case Act::divide:
        zero = 7 / zero; // 1 / x needs no division
        return;
    case Act::illegal:
        __builtin_trap();
    case Act::abort:
        std::abort();
    case Act::terminate:
        return terminate();
    case Act::loop:
        for (;;) zero = zero;
    case Act::overflow:
        zero = recurse(1);
        return;
    case Act::exit:
        std::exit(0);
    }
}

struct Point {
    Act what;
    rt::Box bounds() const { return {{-1, -1, -1}, {1, 1, 1}}; }
    bool intersect(const rt_ray&, rt_hit&) const {
        act(what);
        return false;
    }
};

void lower(const Crasher& crasher, rt::Geometry& out) {
    act(crasher.lower);
    out.custom(Point{crasher.intersect}, rt::Kind::surface);
}

} // namespace

RT_SHAPE_PLUGIN("crasher", "1.0.0", kParameters, lower, "Crashes.", "- crasher: {}\n")
