// Runs the real `rt` as a user would: its own folder, separate stdout and stderr, a deadline.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace rt::cli_tests {

struct Outcome {
    int exitCode = -1; // -1: ended by a signal or the deadline
    int signal = 0;
    std::string out, err;
    double seconds = 0;        // wall
    double cpuSeconds = 0;     // of all its threads
    std::size_t peakBytes = 0; // resident
};

struct RunOptions {
    std::vector<std::string> environment; // "NAME=value", added to a fixed small environment
    std::string program;                  // instead of rt
    bool terminal = false;                // stderr is a pseudo-terminal of 80 columns
    std::string standardOutput;           // a file or device instead of the pipe
    bool unprivileged = false;            // as nobody, if the tests run as root
    unsigned long fileSizeLimit = 0;      // bytes of any file that it writes; 0: none
    unsigned long memoryLimit = 0;        // bytes of address space; 0: none
    double seconds = 60;                  // then it is killed, and the test fails
    std::function<void(int processId)> whileRunning; // called once, right after the start
};

/// A folder of one test, the current folder of what it runs; holds `scene.yaml`, the three spheres.
class Cli : public testing::Test {
protected:
    Cli();
    ~Cli() override;

    Outcome run(const std::vector<std::string>& arguments, const RunOptions& options = {}) const;
    /// Words separated by blanks; no quoting.
    Outcome rt(const std::string& arguments, const RunOptions& options = {}) const;
    /// A script of bash that finds `rt` in its PATH.
    Outcome shell(const std::string& script) const;

    void write(const std::string& name, const std::string& text) const;
    std::string read(const std::string& name) const;
    bool exists(const std::string& name) const;
    /// Names of all files below the folder, sorted, but for scene.yaml.
    std::vector<std::string> files() const;

    std::filesystem::path folder_;
};

/// Three spheres, a light, 64x48: the smallest scene of the speed bars.
extern const std::string kThreeSpheres;
/// Five images of them in which objects, a light, a material, a radius and the camera change.
extern const std::string kFilm;
/// A small .inf scene, 64x48: one sphere, one light.
extern const std::string kOldScene;

/// Asks until it holds; the deadline bounds a broken program, not a slow machine.
bool eventually(const std::function<bool()>& holds);

std::vector<std::string> words(const std::string& text);
std::vector<std::string> linesOf(const std::string& text);

} // namespace rt::cli_tests
