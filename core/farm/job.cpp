#include <core/farm/job.hpp>

#include <formats/atomic_file.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include <unistd.h>

namespace rt::farm {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr scene::Code kNoJob{408}, kWriteFailed{605}, kExists{611};
constexpr int kVersion = 1;

scene::Location whole(const std::string& path) {
    return {std::make_shared<scene::Source>(scene::Source{path, {}}), 0, 0};
}

std::string fourDigits(std::size_t number) {
    std::string text = std::to_string(number);
    return text.size() < 4 ? std::string(4 - text.size(), '0') + text : text;
}

Json toJson(const Job& job) {
    Json tasks = Json::array();
    for (const Task& task : job.tasks) {
        Json entry{{"frames", task.frames}};
        if (task.tile) entry["tile"] = *task.tile;
        tasks.push_back(std::move(entry));
    }
    Json settings = Json::array();
    for (const auto& [field, value] : job.settings) settings.push_back({field, value});
    return {{"rt_job", kVersion},
            {"words", job.words},
            {"working_folder", job.workingFolder},
            {"frame_suffix", job.frameSuffix},
            {"size", job.size},
            {"threads", job.threads},
            {"tasks", std::move(tasks)},
            {"settings", std::move(settings)}};
}

Job fromJson(const Json& json) {
    Job job;
    json.at("words").get_to(job.words);
    json.at("working_folder").get_to(job.workingFolder);
    json.at("frame_suffix").get_to(job.frameSuffix);
    json.at("size").get_to(job.size);
    json.at("threads").get_to(job.threads);
    for (const Json& entry : json.at("tasks")) {
        Task& task = job.tasks.emplace_back();
        entry.at("frames").get_to(task.frames);
        if (entry.contains("tile")) task.tile = entry["tile"].get<std::array<std::uint32_t, 4>>();
    }
    for (const Json& pair : json.at("settings"))
        job.settings.emplace_back(pair.at(0).get<std::string>(), pair.at(1).get<std::string>());
    return job;
}

double now() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

/// A worker that cannot note what it does still does it.
void appendEvent(const Job& job, std::size_t task, const std::string& line) {
    std::ofstream(job.fileOf(task, ".events"), std::ios::app) << line << '\n';
}

/// This process: its node and number.
std::string self() {
    char host[256] = {};
    ::gethostname(host, sizeof host - 1);
    const char* const node = std::getenv("SLURMD_NODENAME");
    return std::string(node ? node : host) + ' ' + std::to_string(::getpid());
}

} // namespace

formats::FramePlace Job::placeOf(std::size_t task) const {
    formats::FramePlace place{.folder = folder + "/out/task_" + fourDigits(task),
                              .after = frameSuffix};
    if (tasks.at(task).tile) place.before = "tile_", place.after = ".f64";
    return place;
}

std::string Job::fileOf(std::size_t task, const char* suffix) const {
    return folder + "/log/task_" + fourDigits(task) + suffix;
}

std::vector<std::uint32_t> Job::resultsOf(std::size_t task) const {
    return tasks.at(task).tile ? std::vector<std::uint32_t>{0} : tasks.at(task).frames;
}

bool create(const Job& job, scene::Diagnostics& diagnostics) {
    const std::string file = job.folder + "/job.json";
    if (fs::exists(file)) {
        diagnostics.error(kExists, whole(job.folder), "is a job already",
                          "to go on with it: rt farm resume " + job.folder);
        return false;
    }
    try {
        fs::create_directories(job.folder + "/out");
        fs::create_directories(job.folder + "/log");
        const std::string text = toJson(job).dump(1) + "\n";
        formats::writeFileAtomically(file, std::as_bytes(std::span(text)));
        return true;
    } catch (const std::system_error& failure) {
        diagnostics.error(kWriteFailed, whole(job.folder),
                          "cannot be written: " + failure.code().message());
        return false;
    }
}

std::optional<Job> read(const std::string& folder, scene::Diagnostics& diagnostics) {
    std::ifstream file(folder + "/job.json");
    try {
        const Json json = Json::parse(file);
        if (json.at("rt_job") == kVersion) {
            Job job = fromJson(json);
            job.folder = fs::canonical(folder).string();
            return job;
        }
    } catch (const nlohmann::json::exception&) {
    }
    diagnostics.error(kNoJob, whole(folder), "is no job directory of this version of rt",
                      "rt farm submit makes one");
    return {};
}

bool isDone(const Job& job, std::size_t task) {
    scene::Diagnostics ignored; // no manifest: nothing is done
    const auto store = formats::FrameStore::read(job.placeOf(task), ignored);
    return store && std::ranges::all_of(job.resultsOf(task),
                                        [&](std::uint32_t frame) { return store->isDone(frame); });
}

std::vector<std::uint32_t> missingTasks(const Job& job) {
    std::vector<std::uint32_t> missing;
    for (std::size_t task = 0; task < job.tasks.size(); ++task)
        if (!isDone(job, task)) missing.push_back(static_cast<std::uint32_t>(task));
    return missing;
}

void noteStart(const Job& job, std::size_t task) {
    std::ostringstream line;
    line << std::fixed << "start " << now() << ' ' << self();
    appendEvent(job, task, line.str());
}

void noteEnd(const Job& job, std::size_t task, int exitCode) {
    std::ostringstream line;
    line << std::fixed << "end " << now() << ' ' << self() << ' ' << exitCode;
    appendEvent(job, task, line.str());
}

std::vector<Attempt> attemptsAt(const Job& job, std::size_t task) {
    std::vector<Attempt> attempts;
    std::ifstream file(job.fileOf(task, ".events"));
    for (std::string text; std::getline(file, text);) {
        std::istringstream line(text);
        std::string word, host, process;
        double time = 0;
        if (!(line >> word >> time >> host >> process)) continue; // torn by a kill
        if (word == "start") {
            attempts.push_back({host, process, time});
            continue;
        }
        const auto ended = std::ranges::find_if(attempts, [&](const Attempt& attempt) {
            return !attempt.exitCode && attempt.host == host && attempt.process == process;
        });
        int code = 0;
        if (word != "end" || ended == attempts.end() || !(line >> code)) continue;
        ended->exitCode = code;
        ended->seconds = time - ended->start;
    }
    return attempts;
}

bool isCancelled(const Job& job) { return fs::exists(job.folder + "/cancelled"); }

void setCancelled(const Job& job, bool cancelled) {
    const std::string file = job.folder + "/cancelled";
    if (cancelled)
        formats::writeFileAtomically(file, {});
    else
        fs::remove(file);
}

std::vector<Task> inChunks(const std::vector<std::uint32_t>& frames, std::size_t chunk) {
    std::vector<Task> tasks;
    for (std::size_t i = 0; i < frames.size(); i += chunk) {
        const auto first = frames.begin() + static_cast<std::ptrdiff_t>(i);
        const auto count = static_cast<std::ptrdiff_t>(std::min(chunk, frames.size() - i));
        tasks.push_back({std::vector(first, first + count), {}});
    }
    return tasks;
}

std::vector<Task> inTiles(std::uint32_t frame, std::uint32_t width, std::uint32_t height,
                          std::uint32_t side) {
    std::vector<Task> tasks;
    for (std::uint32_t y = 0; y < height; y += side)
        for (std::uint32_t x = 0; x < width; x += side)
            tasks.push_back(
                {{frame}, std::array{x, y, std::min(x + side, width), std::min(y + side, height)}});
    return tasks;
}

} // namespace rt::farm
