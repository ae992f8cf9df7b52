// What the tests of faults share: a scene that is drawn at once, the whole study or its short form, a failing call.
#pragma once
#include <tests/cli/run.hpp>
#include <tests/sanitized.hpp>

#include <cstdlib>
#include <string>

namespace rt::faults {

/// RT_FAULTS_FULL=1 runs every case; else `some` of them are chosen evenly.
inline bool isFull() { return std::getenv("RT_FAULTS_FULL") != nullptr; }

class Faults : public cli_tests::Cli {
protected:
    /// Runs with the n-th call of a kind failing, counted from the opening of a file whose name ends in `after`, or from the start.
    /// `struck`: there was an n-th call.
    struct Struck {
        cli_tests::Outcome outcome;
        bool struck;
    };
    Struck runFailing(const std::string& arguments, const std::string& call, long n, int error,
                      const std::string& after = "") const {
        cli_tests::RunOptions options;
        const auto mark = folder_ / "struck";
        options.environment = {
            "LD_PRELOAD=" RT_FAIL_CALLS,    "FAIL_CALL=" + call,
            "FAIL_AT=" + std::to_string(n), "FAIL_ERRNO=" + std::to_string(error),
            "FAIL_MARK=" + mark.string(),   "FAIL_AFTER=" + after};
        Struck result{rt(arguments, options), false};
        result.struck = std::filesystem::remove(mark);
        return result;
    }
};

} // namespace rt::faults
