#include <tests/cli/run.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

namespace rt::cli_tests {

namespace fs = std::filesystem;

const std::string kThreeSpheres = R"(rt: 1
image: {width: 64, height: 48}
camera:
  position: [0, -5, 1]
  look_at: [0, 0, 0.5]
  field_of_view: 50deg
background: {color: [0.2, 0.3, 0.5]}
lights:
  - point: {position: [3, -4, 5], color: [1, 1, 1]}
materials:
  red: {color: [0.9, 0.1, 0.1], diffuse: 0.8, specular: 0.1}
  mirror: {color: [1, 1, 1], diffuse: 0.1, specular: 0.8}
objects:
  - sphere: {name: left, center: [-1.2, 0, 0.5], radius: 0.5, material: red}
  - sphere: {name: middle, center: [0, 0, 0.5], radius: 0.5, material: mirror}
  - sphere: {name: right, center: [1.2, 0, 0.5], radius: 0.5, material: red}
)";

const std::string kFilm =
    std::regex_replace(kThreeSpheres, std::regex("point: \\{"), "point: {name: key, ") +
    R"(animation:
  frames: 5
  fps: 12
  tracks:
    - {target: left, rotate: {center: [0, 0, 0.5], axis: [0, 0, 1], angle: 360deg}, frames: [0, 4]}
    - {target: camera.position, move_direct: {direction: [0, 0, 1], distance: 0.4}, frames: [1, 4]}
    - {target: materials.mirror.color, keyframes: {0: [1, 1, 1], 4: [0.2, 1, 0.2]}}
    - {target: right.radius, keyframes: {0: 0.5, 4: 0.9}}
    - {target: lights.key.color, keyframes: {0: [1, 1, 1], 4: [1, 0.5, 0]}}
)";

const std::string kOldScene = R"(window 48 64
scene 0 0 0 100 100 100
camera 16 12 12 50 5 30 0 1 0 0 0 1
depth 2
sphere 60 62 24 12 1 1 1 0.5 0.5 0.5 0.4 0.4 0.4 0 0 0 0 0 0 1 30
rs 50 0.5 99 1 1 1
)";

namespace {

struct Pipe {
    int read = -1, write = -1;
};

Pipe makePipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) std::abort();
    return {ends[0], ends[1]};
}

Pipe makeTerminal() {
    const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (master < 0 || ::grantpt(master) != 0 || ::unlockpt(master) != 0) std::abort();
    const int slave = ::open(::ptsname(master), O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (slave < 0) std::abort();
    termios settings{};
    ::tcgetattr(slave, &settings);
    settings.c_oflag &= ~static_cast<tcflag_t>(OPOST); // as written, without \r before \n
    ::tcsetattr(slave, TCSANOW, &settings);
    const winsize size{24, 80, 0, 0};
    ::ioctl(slave, TIOCSWINSZ, &size);
    return {master, slave};
}

} // namespace

std::vector<std::string> words(const std::string& text) {
    std::istringstream stream(text);
    return {std::istream_iterator<std::string>(stream), {}};
}

std::vector<std::string> linesOf(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

Cli::Cli() {
    std::string name = (fs::temp_directory_path() / "rt-cli-XXXXXX").string();
    if (!::mkdtemp(name.data())) std::abort();
    folder_ = name;
    write("scene.yaml", kThreeSpheres);
}

Cli::~Cli() {
    std::error_code ignored;
    fs::permissions(folder_, fs::perms::owner_all, ignored);
    fs::remove_all(folder_, ignored);
}

void Cli::write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
}

std::string Cli::read(const std::string& name) const {
    std::ifstream file(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

bool eventually(const std::function<bool()>& holds) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!holds()) {
        if (std::chrono::steady_clock::now() > deadline) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

bool Cli::exists(const std::string& name) const { return fs::exists(folder_ / name); }

std::vector<std::string> Cli::files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
        if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), folder_).string());
    std::erase(names, "scene.yaml");
    std::sort(names.begin(), names.end());
    return names;
}

Outcome Cli::shell(const std::string& script) const {
    const std::string folder = std::filesystem::path(RT_BINARY).parent_path().string();
    return run({"-c", script},
               {.environment = {"PATH=" + folder + ":/usr/bin:/bin"}, .program = "/bin/bash"});
}

Outcome Cli::rt(const std::string& arguments, const RunOptions& options) const {
    return run(words(arguments), options);
}

Outcome Cli::run(const std::vector<std::string>& arguments, const RunOptions& options) const {
    const Pipe out = makePipe(), err = options.terminal ? makeTerminal() : makePipe();
    std::vector<std::string> environment{"PATH=/usr/bin:/bin", "HOME=" + folder_.string(),
                                         "TERM=xterm", "LC_ALL=C.UTF-8"};
    for (const char* const sanitizer : {"ASAN_OPTIONS", "TSAN_OPTIONS", "UBSAN_OPTIONS"})
        if (const char* const value = std::getenv(sanitizer))
            environment.push_back(std::string(sanitizer) + "=" + value);
    for (const std::string& variable : options.environment) {
        const std::string name = variable.substr(0, variable.find('=') + 1);
        std::erase_if(environment,
                      [&](const std::string& other) { return other.starts_with(name); });
        environment.push_back(variable);
    }
    std::vector<std::string> argv{"rt"};
    argv.insert(argv.end(), arguments.begin(), arguments.end());
    const auto pointers = [](std::vector<std::string>& strings) {
        std::vector<char*> list;
        for (std::string& string : strings) list.push_back(string.data());
        list.push_back(nullptr);
        return list;
    };
    const auto argvPointers = pointers(argv), environmentPointers = pointers(environment);

    const std::string program = options.program.empty() ? RT_BINARY : options.program;
    const auto started = std::chrono::steady_clock::now();
    const pid_t child = ::fork();
    if (child == 0) {
        const int in = ::open("/dev/null", O_RDONLY);
        const int standardOutput =
            options.standardOutput.empty()
                ? out.write
                : ::open(options.standardOutput.c_str(), O_WRONLY | O_CREAT, 0666);
        ::dup2(in, 0), ::dup2(standardOutput, 1), ::dup2(err.write, 2);
        if (options.fileSizeLimit) {
            const rlimit limit{options.fileSizeLimit, options.fileSizeLimit};
            ::setrlimit(RLIMIT_FSIZE, &limit);
        }
        if (options.memoryLimit) {
            const rlimit limit{options.memoryLimit, options.memoryLimit};
            ::setrlimit(RLIMIT_AS, &limit);
        }
        if (options.unprivileged && ::geteuid() == 0) {
            constexpr unsigned kNobody = 65534;
            if (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0) ::_exit(127);
        }
        if (::chdir(folder_.c_str()) != 0) ::_exit(127);
        ::execve(program.c_str(), argvPointers.data(), environmentPointers.data());
        ::_exit(127);
    }
    ::close(out.write), ::close(err.write);
    if (options.whileRunning) options.whileRunning(child);

    Outcome outcome;
    const auto deadline =
        std::chrono::steady_clock::now() + std::chrono::duration<double>(options.seconds);
    bool late = false;
    pollfd polled[2] = {{out.read, POLLIN, 0}, {err.read, POLLIN, 0}};
    for (int open = 2; open > 0;) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
                              deadline - std::chrono::steady_clock::now())
                              .count();
        if (left <= 0 || ::poll(polled, 2, static_cast<int>(left)) == 0) {
            late = true;
            ::kill(child, SIGKILL);
            break;
        }
        for (int i = 0; i < 2; ++i) {
            if (!polled[i].revents) continue;
            char buffer[1 << 16];
            const ssize_t size = ::read(polled[i].fd, buffer, sizeof buffer);
            if (size > 0) {
                (i == 0 ? outcome.out : outcome.err).append(buffer, static_cast<std::size_t>(size));
            } else if (size == 0 || errno != EINTR) { // EIO: the terminal's other end is closed
                polled[i].fd = -1;
                --open;
            }
        }
    }
    ::close(out.read), ::close(err.read);
    int status = 0;
    rusage usage{};
    while (::wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    outcome.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    const auto seconds = [](const timeval& t) {
        return double(t.tv_sec) + double(t.tv_usec) / 1e6;
    };
    outcome.cpuSeconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    outcome.peakBytes = static_cast<std::size_t>(usage.ru_maxrss) << 10;
    if (WIFEXITED(status)) outcome.exitCode = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
    EXPECT_FALSE(late) << "killed after " << options.seconds << " s: rt "
                       << (arguments.empty() ? "" : arguments[0]);
    return outcome;
}

} // namespace rt::cli_tests
