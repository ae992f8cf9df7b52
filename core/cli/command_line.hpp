// The command line as plain structs: one per subcommand. Only command_line.cpp knows the parser.
#pragma once
#include <converters/inf.hpp>
#include <core/cli/frame_selection.hpp>
#include <core/cli/values.hpp>
#include <core/scene/limits.hpp>
#include <core/trace/render.hpp>
#include <formats/image_writer.hpp>
#include <formats/video.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace rt::cli {

/// Of every subcommand.
struct CommonOptions {
    int verbosity = 0; // -1: errors only; 0: warnings and notes; 1: what is done
    bool jsonErrors = false;
};

/// Of every subcommand that reads a scene.
struct SceneOptions {
    std::vector<std::string> overrides; // `path=value`
    std::vector<std::filesystem::path> pluginDirs;
    scene::Limits limits;
    std::vector<std::string> readableFolders; // beside the scene's own, with `sandbox`
    bool sandbox = false;
    bool allowMissing = false;
};

enum class ProgressStyle : std::uint8_t { automatic, bar, plain, none };
const std::vector<std::string>& progressStyleNames();

inline constexpr double kLeastFps = 0.001, kMostFps = 1000; // as animation.fps

struct RenderOptions : SceneOptions {
    std::string scene;
    std::vector<std::string> outputs; // "-": stdout
    std::optional<formats::ImageFormat> format;
    std::optional<Rectangle> crop;
    std::optional<std::array<std::uint32_t, 2>> pixel;
    trace::Shade shade = trace::Shade::full;
    ProgressStyle progress = ProgressStyle::automatic;
    std::optional<int> quality;       // of a JPEG or a film
    int threads = 0;                  // 0: all that the process may use
    bool resized = false;             // --size is given
    std::optional<double> timeBudget; // seconds
    std::string samples;              // what --antialias or --max-error asks for, or empty
    bool preview = false;
    bool strict = false;
    bool trace = false;
    bool statistics = false;
    std::string statisticsFile; // empty: a table on stderr

    std::optional<FrameSelection> frames; // none: all of a film, the first for a picture
    std::optional<formats::VideoCodec> codec;
    bool resume = false, overwrite = false;
    std::vector<std::string> words; // of the command line behind `rt`
};

struct EncodeOptions {
    std::string place; // a folder of frames, or a pattern
    std::vector<std::string> outputs;
    std::optional<FrameSelection> frames;
    std::optional<formats::VideoCodec> codec;
    std::optional<int> quality;
    std::optional<double> fps;
    std::uint64_t maxPixels = scene::Limits().pixels; // of a frame
    ProgressStyle progress = ProgressStyle::automatic;
};

enum class Engine : std::uint8_t { local, slurm, print };
const std::vector<std::string>& engineNames();

struct FarmOptions {
    std::string action;              // submit, status, resume, cancel, finish
    std::string what;                // a scene, or the directory of a job
    std::vector<std::string> render; // options for `rt render`
    std::optional<Engine> engine;
    std::size_t chunk = 0;   // frames of a task; 0: as many as take half a minute
    std::uint32_t tiles = 0; // side in pixels; 0: a film
    std::string job;         // empty: ./NAME.job
    int jobs = 1;
    int threads = 0;
};

struct TaskOptions {
    std::string action, job, index;
};

struct ViewOptions : SceneOptions {
    std::string scene;
    std::string script; // empty: a window
    std::string record; // folder; empty: nothing is kept
    int threads = 0;    // 0: all that the process may use
    double picturesPerSecond = 60;
    std::optional<bool> overlay; // none: in a window only
};

struct BenchOptions : SceneOptions {
    std::vector<std::string> scenes;
    std::string folder = "bench";
    std::string panels = "ABC";
    int rounds = 11;
    int threads = 0; // 0: all that the process may use
    std::uint32_t reference = 16;
    bool resized = false; // --size is given
    bool pareto = false;
    std::optional<std::uint32_t> maxWrong;
    std::optional<double> maxRmse, budget; // seconds
};

struct CheckOptions : SceneOptions {
    std::vector<std::string> scenes;
};

struct InfoOptions : SceneOptions {
    std::string scene;
    bool full = false;
    bool json = false;
};

struct SchemaOptions {
    std::vector<std::filesystem::path> pluginDirs;
};

struct ConvertOptions {
    std::vector<std::string> files;
    std::string output;
    std::string movie;
    std::vector<std::filesystem::path> pluginDirs;
    converters::WindowOrder windowOrder = converters::WindowOrder::automatic;
    bool check = false;
    bool lenient = false;
    bool jsonNotes = false;
};

struct MeshOptions {
    std::string action; // "repair"
    std::string file;
    std::string output; // "-": stdout; empty: only the report is wanted
    std::string report; // likewise
    std::string level = "full";
    std::vector<std::filesystem::path> pluginDirs;
};

struct CompareOptions {
    std::string a, b;
    std::optional<Rectangle> crop;
    std::string mask, difference;            // files, or empty
    std::optional<scene::Encoding> encoding; // of 8- and 16-bit samples; none: as the file says
    double tolerance = 0;
    bool json = false;
};

struct PluginsOptions {
    std::string name;
    std::string check; // a module's file, or empty
    std::vector<std::filesystem::path> pluginDirs;
    bool json = false;
};

struct NewOptions {
    std::string kind; // "scene", "shape", "texture" or "loader"
    std::string name;
    std::string folder; // empty: . for a scene, else ./name
};

struct ExplainOptions {
    std::string code; // empty: list all
};

struct CompletionOptions {
    std::string shell;
};

struct VersionOptions {};

/// Text that the command line itself asked for: help.
struct HelpText {
    std::string text;
};

struct CommandLine {
    CommonOptions common;
    std::string command; // "render"; empty: none
    std::variant<HelpText, RenderOptions, EncodeOptions, FarmOptions, TaskOptions, ViewOptions,
                 BenchOptions, CheckOptions, InfoOptions, SchemaOptions, ConvertOptions,
                 MeshOptions, CompareOptions, PluginsOptions, NewOptions, ExplainOptions,
                 CompletionOptions, VersionOptions>
        options;
};

/// Fills `line` as far as it gets, so that an error can be said as `line.common` asks. Throws UsageError.
void parseCommandLine(int argc, const char* const* argv, CommandLine& line);

/// What completion scripts are made of.
struct OptionDescription {
    std::vector<std::string> names; // "-o", "--output"; empty for an argument
    std::string value;              // "FILE", "DIR", "none|fsaa4|grid=N", …; empty for a flag
    std::string text;
};
struct CommandDescription {
    std::string name, text;
    std::vector<OptionDescription> options, arguments;
};
/// The program itself first, under the name "rt", then its subcommands.
std::vector<CommandDescription> describeCommands();

} // namespace rt::cli
