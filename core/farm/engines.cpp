#include <core/farm/engines.hpp>

#include <formats/atomic_file.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace rt::farm {
namespace {

namespace fs = std::filesystem;

constexpr int kTransient = 75;

std::string program() { return fs::read_symlink("/proc/self/exe").string(); }

std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

/// Starts a program; `output` becomes its stdout and stderr.
pid_t start(std::vector<std::string> words, int output) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const pid_t child = ::fork();
    if (child != 0) return child;
    ::dup2(output, STDOUT_FILENO);
    ::dup2(output, STDERR_FILENO);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
}

int exitCodeOf(int status) {
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

/// What a program prints, without the last newline. Throws std::runtime_error where it fails.
std::string answerOf(const std::vector<std::string>& words) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::strerror(errno));
    const pid_t child = start(words, ends[1]);
    ::close(ends[1]);
    std::string answer;
    char buffer[4096];
    for (ssize_t n; (n = ::read(ends[0], buffer, sizeof buffer)) != 0;) {
        if (n > 0) answer.append(buffer, static_cast<std::size_t>(n));
        if (n < 0 && errno != EINTR) break;
    }
    ::close(ends[0]);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    while (!answer.empty() && answer.back() == '\n') answer.pop_back();
    if (exitCodeOf(status) == 127) throw std::runtime_error(words[0] + " is not installed here");
    if (exitCodeOf(status) != 0) throw std::runtime_error(words[0] + " failed: " + answer);
    return answer;
}

std::string idsFile(const Job& job) { return job.folder + "/slurm"; }

std::string arrayOf(std::span<const std::uint32_t> tasks) {
    std::string text;
    for (std::size_t i = 0; i < tasks.size();) {
        std::size_t end = i;
        while (end + 1 < tasks.size() && tasks[end + 1] == tasks[end] + 1) ++end;
        text += (text.empty() ? "" : ",") + std::to_string(tasks[i]);
        if (end > i) text += "-" + std::to_string(tasks[end]);
        i = end + 1;
    }
    return text;
}

void writeScript(const std::string& path, const std::string& text) {
    formats::writeFileAtomically(path, std::as_bytes(std::span(text)));
    fs::permissions(path, fs::perms::owner_exec, fs::perm_options::add);
}

} // namespace

bool isTransient(int exitCode) { return exitCode == kTransient || exitCode > 128; }

std::string taskCommand(const Job& job, std::uint32_t task) {
    return quoted(program()) + " task run " + quoted(job.folder) + " " + std::to_string(task);
}

std::string finishCommand(const Job& job) {
    return quoted(program()) + " farm finish " + quoted(job.folder);
}

void runLocally(const Job& job, std::span<const std::uint32_t> tasks, int parallel,
                const std::atomic<bool>& stop, const TaskEnded& ended) {
    constexpr auto kPoll = std::chrono::milliseconds(20); // tasks take seconds
    std::deque<std::uint32_t> waiting(tasks.begin(), tasks.end());
    std::map<pid_t, std::uint32_t> running;
    std::map<std::uint32_t, std::size_t> attempts;
    bool ending = false;
    while (!running.empty() || (!waiting.empty() && !ending)) {
        if (!ending && (stop || isCancelled(job))) {
            ending = true;
            for (const auto& [child, task] : running) ::kill(child, SIGTERM);
        }
        while (!ending && !waiting.empty() && running.size() < static_cast<std::size_t>(parallel)) {
            const std::uint32_t task = waiting.front();
            waiting.pop_front();
            ++attempts[task];
            const int log = ::open(job.fileOf(task, ".log").c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
            const pid_t child =
                start({program(), "task", "run", job.folder, std::to_string(task)}, log);
            ::close(log);
            if (child < 0) throw std::runtime_error(std::strerror(errno));
            running.emplace(child, task);
        }
        int status = 0;
        const pid_t child = ::waitpid(-1, &status, WNOHANG);
        const auto found = running.find(child);
        if (found == running.end()) {
            std::this_thread::sleep_for(kPoll);
            continue;
        }
        const std::uint32_t task = found->second;
        running.erase(found);
        const int code = exitCodeOf(status);
        if (isTransient(code) && attempts[task] < kMostAttempts) waiting.push_back(task);
        ended(task, code);
    }
}

std::size_t slurmArrayLimit() {
    const std::string answer = answerOf({"scontrol", "show", "config"});
    std::smatch match;
    if (!std::regex_search(answer, match, std::regex("MaxArraySize\\s*=\\s*(\\d+)")))
        throw std::runtime_error("scontrol does not say MaxArraySize");
    return std::stoul(match[1]);
}

void submitToSlurm(const Job& job, std::span<const std::uint32_t> tasks) {
    // A task that a signal ended is transient, which clusters with RequeueExit=75 begin again; others wait for the finish
    // pass. The last attempt ends otherwise, or a disk that stays full would keep the array for ever.
    const std::string transient = std::to_string(kTransient);
    const std::string script = job.folder + "/task.sh", finish = job.folder + "/finish.sh";
    writeScript(script,
                "#!/bin/sh\n" + quoted(program()) + " task run " + quoted(job.folder) +
                    " \"$SLURM_ARRAY_TASK_ID\"\ncode=$?\n[ $code -gt 128 ] && code=" + transient +
                    "\n[ $code -eq " + transient + " ] && [ \"${SLURM_RESTART_COUNT:-0}\" -ge " +
                    std::to_string(kMostAttempts - 1) + " ] && code=1\nexit $code\n");
    writeScript(finish, "#!/bin/sh\nexec " + finishCommand(job) + "\n");
    std::vector<std::string> submit{"sbatch",
                                    "--parsable",
                                    "--requeue",
                                    "--open-mode=append",
                                    "--job-name=rt",
                                    "--array=" + arrayOf(tasks),
                                    "--chdir=" + job.workingFolder,
                                    "--output=" + job.folder + "/log/slurm_%a.log"};
    if (job.threads) submit.push_back("--cpus-per-task=" + std::to_string(job.threads));
    submit.push_back(script);
    const std::string array = answerOf(submit);
    const std::string last =
        answerOf({"sbatch", "--parsable", "--requeue", "--open-mode=append", "--job-name=rt-finish",
                  "--dependency=afterany:" + array, "--chdir=" + job.workingFolder,
                  "--output=" + job.folder + "/log/finish.log", finish});
    std::ofstream(idsFile(job), std::ios::app) << array << '\n' << last << '\n';
}

void cancelInSlurm(const Job& job) {
    std::ifstream file(idsFile(job));
    for (std::string id; std::getline(file, id);) answerOf({"scancel", "--quiet", id});
}

bool isInSlurm(const Job& job) { return fs::exists(idsFile(job)); }

} // namespace rt::farm
