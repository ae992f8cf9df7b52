// Who runs the tasks of a job: processes of this machine, or Slurm.
#pragma once
#include <core/farm/job.hpp>

#include <atomic>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace rt::farm {

/// `task` and how it ended; 128 + the signal where one ended it.
using TaskEnded = std::function<void(std::uint32_t task, int exitCode)>;

/// Is it worth to repeat a task that ended so? Signals and exit 75 are; what the scene is to blame for is not.
bool isTransient(int exitCode);

inline constexpr std::size_t kMostAttempts = 3; // of one task in one submission

/// Runs `rt task run` for each task, `parallel` at a time, up to kMostAttempts times each, until `stop` or the job is cancelled:
/// they then get SIGTERM. What they say goes to their logs.
void runLocally(const Job& job, std::span<const std::uint32_t> tasks, int parallel,
                const std::atomic<bool>& stop, const TaskEnded& ended);

/// "/usr/bin/rt task run DIR 7", for a shell.
std::string taskCommand(const Job& job, std::uint32_t task);
std::string finishCommand(const Job& job);

/// The most tasks that one job array may have here. Throws std::runtime_error where Slurm does not answer.
std::size_t slurmArrayLimit();
/// Submits the tasks as one array, and `rt farm finish` behind it; notes the ids in DIR/slurm. Throws std::runtime_error.
void submitToSlurm(const Job& job, std::span<const std::uint32_t> tasks);
/// Cancels whatever of the job Slurm still has. Throws std::runtime_error.
void cancelInSlurm(const Job& job);
/// Was the job ever given to Slurm?
bool isInSlurm(const Job& job);

} // namespace rt::farm
