// What this machine could deliver to one thread, measured.
#pragma once

namespace rt::bench {

struct Machine {
    double l2Bandwidth, memoryBandwidth; // bytes per second, read in a row
};

Machine measureMachine();

} // namespace rt::bench
