#include <core/cli/farm_options.hpp>

namespace rt::cli {
namespace {

constexpr std::uint32_t kMostTasks = 1'000'000, kMostProcesses = 1024, kMostSide = 16384;

} // namespace

const std::vector<std::string>& engineNames() {
    static const std::vector<std::string> names{"local", "slurm", "print"};
    return names;
}

void addFarmOptions(OptionRows& rows, FarmOptions& options) {
    rows.argument("action", "ACTION", "submit, status, resume, cancel or finish.", options.action);
    rows.argument("what", "WHAT", "The scene to submit, or the directory of a job.", options.what);
    // Those of `rt render`, which reads them again.
    const auto forward = [&](const char* names, const char* longName, const char* value,
                             const char* text) {
        rows.option(names, value, text, [&options, longName](const std::string& word) {
            options.render.push_back(longName);
            options.render.push_back(word);
        });
    };
    forward("-o,--output", "--output", "FILE", "The film or picture, as for rt render.");
    forward("-s,--size", "--size", "WxH", "Size of the picture in pixels.");
    forward("--set", "--set", "PATH=VALUE", "Change any key of the scene.");
    forward("--frames", "--frames", "LIST", "Images of a film, such as 10-20,30 or 10-200:5.");
    forward("--codec", "--codec", "NAME", "Of a film, as for rt render.");
    forward("--quality", "--quality", "N", "Of a JPEG or a film, 1 to 100.");
    forward("--plugin-dir", "--plugin-dir", "DIR", "Look for plugins here first.");
    rows.flag("--allow-missing", "Leave out objects whose file is missing.",
              [&options](const std::string&) { options.render.push_back("--allow-missing"); });
    rows.option("-t,--threads", "N",
                "Threads of each task; by default what Slurm allots, or all of the machine's "
                "shared by the tasks that run at once.",
                [&options](const std::string& word) {
                    options.threads = static_cast<int>(parseWhole(word, 1, 1024));
                });
    rows.option("--engine", choiceName(engineNames()),
                "Who runs the tasks: processes of this machine, the default; a Slurm job array; or "
                "whoever reads the printed command lines. Resuming stays with Slurm.",
                [&options](const std::string& word) {
                    options.engine = static_cast<Engine>(parseChoice(word, engineNames()));
                });
    rows.option("--chunk", "N",
                "Frames of a task; by default as many as take 30 s, tried on one frame.",
                [&options](const std::string& word) {
                    options.chunk = word == "auto" ? 0 : parseWhole(word, 1, kMostTasks);
                });
    rows.flagWithWord("--tiles", "[=SIDE]",
                      "One picture in tiles of SIDE by SIDE pixels, 256 by default.",
                      [&options](const std::string& word) {
                          constexpr std::uint32_t kSide = 256;
                          try {
                              options.tiles = word.empty() ? kSide : parseWhole(word, 8, kMostSide);
                          } catch (const UsageError& error) {
                              throw UsageError(std::string("--tiles: ") + error.what());
                          }
                      });
    rows.option("--job", "DIR",
                "The directory of the job, on a disk that all nodes share; by default "
                "./NAME.job.",
                [&options](const std::string& word) { options.job = word; });
    rows.option("-j,--jobs", "N", "Tasks that this machine runs at once; 1 by default.",
                [&options](const std::string& word) {
                    options.jobs = static_cast<int>(parseWhole(word, 1, kMostProcesses));
                });
}

void addTaskOptions(OptionRows& rows, TaskOptions& options) {
    rows.argument("action", "ACTION", "run.", options.action);
    rows.argument("job", "DIR", "The directory of a job.", options.job);
    rows.argument("index", "INDEX", "The number of a task, from 0.", options.index);
}

} // namespace rt::cli
