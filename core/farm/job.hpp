// A job directory on a shared file system: what a worker needs to do one task, and what has been done. All state is in
// its files, none in a scheduler:
//
//   job.json            the command, the folder it was given in, the settings that frames depend on, the tasks
//   out/task_0007/      frames or a tile of task 7, with a manifest (formats/frame_store.hpp)
//   log/task_0007.log   what its processes said; .events: when they began and how they ended
//   cancelled           is there when nothing is to be begun any more
#pragma once
#include <core/scene/diagnostic.hpp>
#include <formats/frame_store.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rt::farm {

struct Task {
    std::vector<std::uint32_t> frames;
    std::optional<std::array<std::uint32_t, 4>> tile; // x0, y0, x1, y1 of the one frame
};

struct Job {
    std::string folder;              // absolute
    std::vector<std::string> words;  // behind `rt`: render SCENE …
    std::string workingFolder;       // absolute; what `words` name is relative to it
    formats::Settings settings;      // of the frames
    std::string frameSuffix;         // ".png"
    std::vector<std::uint32_t> size; // width and height of the whole picture
    int threads = 0;                 // of a task; 0: what the scheduler or the machine allows
    std::vector<Task> tasks;

    /// Where a task's frames are; a tile is frame 0 of its place.
    formats::FramePlace placeOf(std::size_t task) const;
    std::string fileOf(std::size_t task, const char* suffix) const; // in log/
    /// What a task leaves in its place, by number.
    std::vector<std::uint32_t> resultsOf(std::size_t task) const;
    bool hasTiles() const { return !tasks.empty() && tasks.front().tile.has_value(); }
};

/// Writes a new job directory. Errors: E0611 it exists; E0605 it cannot be written.
bool create(const Job& job, scene::Diagnostics& diagnostics);
/// Error E0408: no job directory, or of another version.
std::optional<Job> read(const std::string& folder, scene::Diagnostics& diagnostics);

/// Every result of the task is there with the right checksum.
bool isDone(const Job& job, std::size_t task);
std::vector<std::uint32_t> missingTasks(const Job& job);

void noteStart(const Job& job, std::size_t task);
void noteEnd(const Job& job, std::size_t task, int exitCode);

/// One process that did a task, or tried to.
struct Attempt {
    std::string host, process;
    double start = 0, seconds = 0; // of the epoch; 0 before it has ended
    std::optional<int> exitCode;   // none: it runs, or was killed
};
/// In the order in which they began.
std::vector<Attempt> attemptsAt(const Job& job, std::size_t task);

bool isCancelled(const Job& job);
void setCancelled(const Job& job, bool cancelled);

/// Frames in chunks of `chunk`, rising.
std::vector<Task> inChunks(const std::vector<std::uint32_t>& frames, std::size_t chunk);
/// One frame in tiles of at most `side` by `side` pixels, row by row.
std::vector<Task> inTiles(std::uint32_t frame, std::uint32_t width, std::uint32_t height,
                          std::uint32_t side);

} // namespace rt::farm
