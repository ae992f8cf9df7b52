// Makes the n-th system call of the code under test fail: failing_calls.cpp stands in front of the C library's functions.
#pragma once

namespace rt {

enum class Failure { none, errorNumber, shortWrite };

/// While alive, counts open, write, read, fsync, fchmod, rename and close on this thread, and fails the n-th (from 1).
class FailingCalls {
public:
    FailingCalls(Failure failure, int errorNumber, int nth);
    FailingCalls(const FailingCalls&) = delete;
    FailingCalls& operator=(const FailingCalls&) = delete;
    ~FailingCalls();
    int calls() const;
};

} // namespace rt
