// The only file that includes CLI11 (5 s of compiling). CLI11 recognises words; what they mean is read afterwards, so that
// an unknown option is reported before the value of a known one.
#include <core/cli/command_line.hpp>

#include <core/cli/exit_codes.hpp>
#include <core/cli/farm_options.hpp>
#include <core/cli/film_options.hpp>
#include <core/scene/diagnostic.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <memory>

namespace rt::cli {

namespace {

constexpr std::uint32_t kMaxWhole = 0xFFFFFFFF;
constexpr std::size_t kHelpWidth = 80;
constexpr std::size_t kHelpColumn = 26; // where the text beside an option begins

const std::vector<std::string> kImageSuffixes{"png", "jpg", "jpeg", "bmp", "exr", "pfm"};
const std::vector<std::string> kOnOff{"on", "off"};
const std::vector<std::string> kShades{"full", "normals", "depth", "id", "cost"};
const std::vector<std::string> kWindowOrders{"auto", "width_height", "height_width"};
const std::vector<std::string> kEncodings{"srgb", "linear"};
const std::vector<std::string> kNewKinds{"scene", "shape", "texture", "loader"};
const std::vector<std::string> kMeshActions{"repair"};
const std::vector<std::string> kRepairs{"full", "orient", "none"};
const std::vector<std::string> kShells{"bash", "zsh", "fish"};

/// One subcommand: its CLI11 half recognises, its takers fill the options once every word is known.
class Command final : public OptionRows {
public:
    using OptionRows::flag;

    Command(CLI::App& app_, std::string examples_) : app(app_), examples(std::move(examples_)) {
        app.set_help_flag();
        flag("-h,--help", "Show this help.", help);
    }

    void flag(const char* names, const char* text, Take take) override {
        CLI::Option* const option = app.add_flag(names)->description(text);
        option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        takers_.push_back({option, [name = longName(option), take](const std::string& word) {
                               if (word != "true") throw UsageError(name + " takes no value");
                               take(word);
                           }});
    }
    void flagWithWord(const char* names, const char* value, const char* text, Take take) override {
        CLI::Option* const option = app.add_flag(names)->description(text)->option_text(value);
        option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        takers_.push_back(
            {option, [take](const std::string& word) { take(word == "true" ? "" : word); }});
    }
    void option(const char* names, const std::string& value, const char* text, Take take) override {
        CLI::Option* const option = app.add_option(names)->description(text)->type_name(value);
        option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        option->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args(false);
        takers_.push_back({option, [name = longName(option), take](const std::string& word) {
                               try {
                                   take(word);
                               } catch (const UsageError& error) {
                                   throw UsageError(name + ": " + error.what(), error.hint);
                               }
                           }});
    }
    void argument(const char* name, const char* value, const char* text, std::string& word,
                  bool required = true) override {
        CLI::Option* const option =
            app.add_option(name)->description(text)->type_name(value)->expected(1);
        takers_.push_back({option, [&word](const std::string& given) { word = given; }});
        option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        if (required) required_.push_back({option, value});
    }
    void arguments(const char* name, const char* value, const char* text,
                   std::vector<std::string>& words) override {
        CLI::Option* const option = app.add_option(name)
                                        ->description(text)
                                        ->type_name(value)
                                        ->expected(1, CLI::detail::expected_max_vector_size)
                                        ->allow_extra_args();
        takers_.push_back({option, [&words](const std::string& given) { words.push_back(given); }});
        option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
        required_.push_back({option, value});
    }

    void take() const {
        for (const Taker& taker : takers_)
            for (const std::string& word : taker.option->results()) taker.take(word);
    }
    /// Throws when an argument is missing.
    void complete() const {
        for (const auto& [option, value] : required_)
            if (option->count() == 0)
                throw UsageError(value + " is missing", "try: " + firstExample());
    }
    std::string firstExample() const {
        const std::string line = examples.substr(0, examples.find('\n'));
        return line.substr(0, line.find("  "));
    }

    CLI::App& app;
    std::string examples; // one `command  # what it does` per line
    bool help = false;

private:
    struct Taker {
        CLI::Option* option;
        Take take;
    };
    static std::string longName(const CLI::Option* option) {
        return option->get_lnames().empty() ? "-" + option->get_snames()[0]
                                            : "--" + option->get_lnames()[0];
    }

    std::vector<Taker> takers_;
    std::vector<std::pair<CLI::Option*, std::string>> required_;
};

// ---- help text ----------------------------------------------------------------------------------------------

/// `text` wrapped at kHelpWidth, every line but the first indented by `indent`.
std::string wrapped(const std::string& text, std::size_t column, std::size_t indent) {
    std::string out;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t to = std::min(text.find(' ', from), text.size());
        if (column + (to - from) > kHelpWidth && column > indent) {
            out += "\n" + std::string(indent, ' ');
            column = indent;
        }
        out += text.substr(from, to - from);
        column += to - from;
        if (to < text.size()) out += ' ', ++column;
        from = to + 1;
    }
    std::string clean; // without blanks before line ends
    for (const char c : out) {
        if (c == '\n')
            while (!clean.empty() && clean.back() == ' ') clean.pop_back();
        clean += c;
    }
    return clean;
}

std::string row(const std::string& left, const std::string& text) {
    std::string line = "  " + left;
    if (line.size() + 2 > kHelpColumn)
        line += "\n" + std::string(kHelpColumn, ' ');
    else
        line.resize(kHelpColumn, ' ');
    return line + wrapped(text, kHelpColumn, kHelpColumn) + "\n";
}

OptionDescription describe(const CLI::Option& option) {
    OptionDescription description{{}, {}, option.get_description()};
    for (const std::string& name : option.get_snames()) description.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) description.names.push_back("--" + name);
    if (option.get_expected_min() > 0 || description.names.empty())
        description.value = option.get_type_name();
    return description;
}

std::string optionRow(const CLI::Option& option) {
    const OptionDescription description = describe(option);
    std::string left = description.names[0].size() > 2 ? "    " : "";
    for (std::size_t i = 0; i < description.names.size(); ++i)
        left += (i ? ", " : "") + description.names[i];
    if (!description.value.empty()) left += " " + description.value;
    if (!option.get_option_text().empty()) left += option.get_option_text();
    return row(left, description.text);
}

std::string helpText(const CLI::App& app, const std::string& examples) {
    const bool root = app.get_parent() == nullptr;
    std::string text = wrapped(app.get_description(), 0, 0) +
                       "\n\nUsage: " + (root ? "rt COMMAND" : "rt " + app.get_name());
    const auto options = app.get_options();
    for (const CLI::Option* option : options)
        if (option->get_positional())
            text += " " + option->get_type_name() + (option->get_expected_max() > 1 ? "..." : "");
    text += " [OPTION...]\n";

    if (root) {
        text += "\nCommands:\n";
        for (const CLI::App* sub : app.get_subcommands(nullptr))
            text += row(sub->get_name(), sub->get_description());
    }
    std::string arguments;
    for (const CLI::Option* option : options)
        if (option->get_positional())
            arguments += row(option->get_type_name(), option->get_description());
    if (!arguments.empty()) text += "\nArguments:\n" + arguments;

    text += root ? "\nOptions of every command:\n" : "\nOptions:\n";
    for (const CLI::Option* option : options)
        if (!option->get_positional()) text += optionRow(*option);
    if (!root) text += "  -q, -v, --json-errors   As for every command: see rt --help.\n";
    if (root) text += "\nExit codes:\n" + std::string(kExitCodeTable);
    text += "\nExamples:\n";
    for (std::size_t from = 0; from < examples.size();) {
        const std::size_t to = examples.find('\n', from);
        text += "  " + examples.substr(from, to - from) + "\n";
        from = to + 1;
    }
    return text;
}

// ---- the subcommands ----------------------------------------------------------------------------------------

class Program {
public:
    Program() {
        app_.fallthrough();
        app_.allow_extras();
        app_.require_subcommand(0, 1);
        root_ = std::make_unique<Command>(
            app_, "rt render scene.yaml     # draws ./scene.png\n"
                  "rt check scene.yaml      # finds what is wrong with it\n"
                  "rt convert Scene.inf     # makes Scene.yaml of an old scene\n");
        root_->flag("-q,--quiet", "Print errors only.",
                    [this](const std::string&) { common.verbosity = -1; });
        root_->flag("-v,--verbose", "Say what is done.",
                    [this](const std::string&) { common.verbosity = 1; });
        root_->flag("--json-errors", "Print errors, warnings and notes as JSON, one per line.",
                    common.jsonErrors);
        root_->flag("--version", "Show the version and how it was built.", versionFlag_);

        addRender();
        addEncodeOptions(
            add("encode", "Encode the frames of a film, which `rt render` has kept.",
                "rt encode film.frames -o film.mp4            # H.264\n"
                "rt encode film.frames -o film.webm --fps 12  # VP9, slower\n"
                "rt encode frame_%04d.png -o film.mkv         # from numbered pictures\n"),
            encode_);
        addFarmOptions(
            add("farm", "Render a film or a huge picture by many processes, or by Slurm.",
                "rt farm submit film.yaml -o a.mp4 --jobs 2    # on this machine\n"
                "rt farm status a.job                          # what is done\n"
                "rt farm submit film.yaml -o b.mp4 --engine print   # for other schedulers\n"),
            farm_);
        addTaskOptions(add("task", "Run one task of a job: what `rt farm` submits.",
                           "rt task run a.job 0             # again, if need be\n"
                           "rt task run a.job 0 -v          # and say what is done\n"
                           "rt task run a.job 0 2> log      # as schedulers do\n"),
                       task_);
        addView();
        addBench();
        addCheck();
        addInfo();
        addSchema();
        addConvert();
        addMesh();
        addCompare();
        addPlugins();
        addNew();
        addExplain();
        addCompletion();
        add("version", "Show the version, how it was built and what this machine runs.",
            "rt version             # everything\n"
            "rt --version           # the same\n"
            "rt version | head -1   # the version alone\n");
        Command& helpCommand = add("help", "Show the help of rt or of one command.",
                                   "rt help           # the commands\n"
                                   "rt help render    # the options of one\n"
                                   "rt render --help  # the same\n");
        helpCommand.argument("command", "COMMAND", "The command to explain.", helpTopic_, false);
    }

    void parse(int argc, const char* const* argv, CommandLine& line);
    std::vector<CommandDescription> describeAll() const;

private:
    Command& add(const char* name, const char* text, const char* examples) {
        commands_.push_back(std::make_unique<Command>(*app_.add_subcommand(name, text), examples));
        return *commands_.back();
    }
    static void addPluginDirs(Command& command, std::vector<std::filesystem::path>& folders) {
        command.option("--plugin-dir", "DIR",
                       "Look for plugins here first; may be given more than once.",
                       [&folders](const std::string& word) { folders.push_back(word); });
    }
    static void addSceneOptions(Command& command, SceneOptions& options) {
        command.option("--set", "PATH=VALUE",
                       "Change any key of the scene, such as camera.screen.distance=2 or "
                       "objects.moon.radius=4; may be given more than once.",
                       [&options](const std::string& word) {
                           options.overrides.push_back(checkedOverride(word));
                       });
        addLimits(command, options.limits);
        command.flag("--sandbox",
                     "Read files of the scene's own folder only, whatever the scene says.",
                     options.sandbox);
        command.option(
            "--allow-read", "DIR",
            "With --sandbox: read files of this folder too; may be given more than once.",
            [&options](const std::string& word) {
                options.readableFolders.push_back(checkedFolder(word));
            });
        command.flag("--allow-missing", "Leave out objects whose file is missing.",
                     options.allowMissing);
        addPluginDirs(command, options.pluginDirs);
    }
    static void addLimits(Command& command, scene::Limits& limits) {
        const auto whole = [&command](const char* name, const char* text, std::uint32_t max,
                                      auto& limit) {
            command.option(name, "N", text, [&limit, max](const std::string& word) {
                limit = parseWhole(word, 1, max);
            });
        };
        const auto bytes = [&command](const char* name, const char* text, std::uint64_t& limit) {
            command.option(name, "SIZE", text,
                           [&limit](const std::string& word) { limit = parseBytes(word); });
        };
        whole("--limit-pixels", "Refuse larger pictures; 268435456 by default.", kMaxWhole,
              limits.pixels);
        whole("--limit-texture-pixels", "Refuse larger textures; 67108864 by default.", kMaxWhole,
              limits.texturePixels);
        whole("--limit-primitives", "Refuse scenes of more triangles, spheres and so on.",
              kMaxWhole - 1, limits.primitives);
        whole("--limit-nodes",
              "Refuse scene files of more keys and values, aliases expanded; 1000000 by default.",
              kMaxWhole, limits.nodes);
        whole("--limit-nesting", "Refuse lists and maps nested deeper; 64 by default.",
              scene::kDeepestNesting, limits.nesting);
        bytes("--limit-file",
              "Refuse larger input files, such as 64M; 8M for scenes by default, 4G for meshes.",
              limits.fileBytes);
        bytes("--limit-memory", "Use no more memory, such as 2G; what the machine has by default.",
              limits.memory);
    }
    static std::string checkedFolder(const std::string& word) {
        std::error_code ignored;
        if (!std::filesystem::is_directory(word, ignored))
            throw UsageError("must be a folder that exists (got " + scene::quoted(word) + ")");
        return word;
    }
    static std::string checkedOverride(const std::string& word) {
        const std::size_t equals = word.find('=');
        if (equals == 0 || equals == std::string::npos)
            throw UsageError("must be PATH=VALUE, such as render.depth=3 (got " +
                             scene::quoted(word) + ")");
        return word;
    }

    void addRender();
    void addView();
    void addBench();
    void addCheck();
    void addInfo();
    void addSchema();
    void addConvert();
    void addMesh();
    void addCompare();
    void addPlugins();
    void addNew();
    void addExplain();
    void addCompletion();

    const Command* chosen() const {
        for (const auto& command : commands_)
            if (command->app.parsed()) return command.get();
        return nullptr;
    }
    void refuseExtras(const Command* command) const;

    CLI::App app_{"rt draws scenes by Whitted ray tracing: fast, exact, and it tells what it did."};
    std::unique_ptr<Command> root_;
    std::vector<std::unique_ptr<Command>> commands_;
    CommonOptions common;
    bool versionFlag_ = false;
    std::string helpTopic_;
    RenderOptions render_;
    EncodeOptions encode_;
    FarmOptions farm_;
    TaskOptions task_;
    ViewOptions view_;
    BenchOptions bench_;
    CheckOptions check_;
    InfoOptions info_;
    SchemaOptions schema_;
    ConvertOptions convert_;
    MeshOptions mesh_;
    CompareOptions compare_;
    PluginsOptions plugins_;
    NewOptions new_;
    ExplainOptions explain_;
    CompletionOptions completion_;
};

/// As the scene language has it.
constexpr double kLeastError = 0.00001;

formats::ImageFormat imageFormatNamed(const std::string& word) {
    parseChoice(word, kImageSuffixes);
    return *formats::imageFormatOf("." + word);
}

std::string checkedOutput(const std::string& word) {
    if (word.empty()) throw UsageError("must not be empty");
    return word;
}

void Program::addRender() {
    Command& c = add("render", "Draw a scene or a film and write it; prints its path.",
                     "rt render scene.yaml                           # draws ./scene.png\n"
                     "rt render scene.yaml --size 320x240 -o a.jpg   # another size and format\n"
                     "rt render scene.yaml --set render.depth=1      # any key of the scene\n");
    RenderOptions& o = render_;
    c.argument("scene", "SCENE", "The scene, a YAML file.", o.scene);
    c.option("-o,--output", "FILE",
             "Write here; the suffix chooses png, jpg, bmp, exr or pfm, or mp4, avi, mkv or webm "
             "for a film; a_%04d.png numbers its frames, and - is stdout. May be given more than "
             "once. Default: ./SCENE.png, or ./SCENE.mp4 for a film.",
             [&o](const std::string& word) { o.outputs.push_back(checkedOutput(word)); });
    c.option("--format", choiceName(kImageSuffixes),
             "Format of the output whatever its suffix; png for stdout.",
             [&o](const std::string& word) { o.format = imageFormatNamed(word); });
    c.option(
        "--quality", "N", "Of a JPEG or a film, 1 to 100; 95 for a JPEG and 80 for a film.",
        [&o](const std::string& word) { o.quality = static_cast<int>(parseWhole(word, 1, 100)); });
    c.option("-s,--size", "WxH", "Size of the picture in pixels.", [&o](const std::string& word) {
        const Size size = parseSize(word);
        o.resized = true;
        o.overrides.push_back("image.width=" + std::to_string(size.width));
        o.overrides.push_back("image.height=" + std::to_string(size.height));
    });
    c.option(
        "-t,--threads", "N", "Threads to use; 0, the default, is all that the process may use.",
        [&o](const std::string& word) { o.threads = static_cast<int>(parseWhole(word, 0, 1024)); });
    addSceneOptions(c, o);
    c.option("--crop", "X0,Y0,X1,Y1", "Draw only these pixels; the picture has their size.",
             [&o](const std::string& word) { o.crop = parseRectangle(word); });
    c.option("--antialias", "none|fsaa4|grid=N|max_error=E",
             "Samples per pixel: one, 2x2 corners, NxN, or as many as the error asks for.",
             [&o](const std::string& word) {
                 o.samples = word;
                 if (word == "none" || word == "fsaa4") {
                     o.overrides.push_back("render.antialias=" + word);
                 } else if (word.starts_with("grid=")) {
                     o.overrides.push_back("render.antialias={grid: " +
                                           std::to_string(parseWhole(word.substr(5), 1, 64)) + "}");
                 } else if (word.starts_with("max_error=")) {
                     parseReal(word.substr(10), 0, 1);
                     o.overrides.push_back("render.antialias={max_error: " + word.substr(10) + "}");
                 } else {
                     parseChoice(word, {"none", "fsaa4", "grid=N", "max_error=E"});
                     throw UsageError("must be none, fsaa4, grid=4 or max_error=0.01 (got " +
                                      scene::quoted(word) + ")");
                 }
             });
    c.option("--max-error", "E",
             "As many samples as bring the root mean square error of the picture, in linear light, "
             "below E; the same as --antialias max_error=E.",
             [&o](const std::string& word) {
                 parseReal(word, kLeastError, 1);
                 o.samples = "max_error=" + word;
                 o.overrides.push_back("render.antialias={max_error: " + word + "}");
             });
    c.option("--time-budget", "TIME",
             "As many samples as fit into 10s, 500ms or 2min of tracing; reports the error, and "
             "--max-error with that number draws the same picture.",
             [&o](const std::string& word) { o.timeBudget = parseDuration(word); });
    c.option("--depth", "N", "Reflections and refractions after the first hit.",
             [&o](const std::string& word) {
                 o.overrides.push_back("render.depth=" + std::to_string(parseWhole(word, 0, 1000)));
             });
    c.flag("--preview", "A quarter of the size, one sample per pixel, one reflection.", o.preview);
    c.option("--shade", choiceName(kShades),
             "Draw what the rays meet instead of light: normals, depth, object or cost.",
             [&o](const std::string& word) {
                 o.shade = static_cast<trace::Shade>(parseChoice(word, kShades));
             });
    c.flag("--strict",
           "End with 70 if a sample is no finite number, and draw it magenta instead of black.",
           o.strict);
    c.option("--pixel", "X,Y", "With --trace: the pixel to explain.",
             [&o](const std::string& word) { o.pixel = parsePixel(word); });
    c.flag("--trace", "Print the ray tree of --pixel on stdout; writes no picture.", o.trace);
    c.option("--progress", choiceName(progressStyleNames()),
             "How progress is shown on stderr; auto is a bar on a terminal and nothing elsewhere.",
             [&o](const std::string& word) {
                 o.progress = static_cast<ProgressStyle>(parseChoice(word, progressStyleNames()));
             });
    c.flagWithWord("--stats", "[=FILE.json]",
                   "Report times, rays, tests and the octree on stderr, or as JSON in a file.",
                   [&o](const std::string& word) { o.statistics = true, o.statisticsFile = word; });
    addFilmOptions(c, o);
}

void Program::addView() {
    Command& c = add("view", "Fly through a scene in a window; H shows the keys.",
                     "rt view scene.yaml                             # W A S D and the mouse\n"
                     "rt view scene.yaml --set render.depth=2        # lighter, so faster\n"
                     "rt view scene.yaml --script keys.txt --record shown  # without a window\n");
    ViewOptions& o = view_;
    c.argument("scene", "SCENE", "The scene, a YAML file.", o.scene);
    c.option(
        "-t,--threads", "N", "Threads to use; 0, the default, is all that the process may use.",
        [&o](const std::string& word) { o.threads = static_cast<int>(parseWhole(word, 0, 1024)); });
    c.option("--fps", "N",
             "Pictures per second to keep while the camera moves, 60 by default; fewer are finer.",
             [&o](const std::string& word) { o.picturesPerSecond = parseReal(word, 1, 1000); });
    c.option("--script", "FILE", "Replay keys and mouse from a file instead of opening a window.",
             [&o](const std::string& word) { o.script = checkedOutput(word); });
    c.option(
        "--record", "DIR",
        "With --script: keep every picture shown, and shown.tsv; reports how soon pictures came.",
        [&o](const std::string& word) { o.record = checkedOutput(word); });
    c.option("--overlay", choiceName(kOnOff),
             "Rates and the resolution over the picture; by default in a window only.",
             [&o](const std::string& word) { o.overlay = parseChoice(word, kOnOff) == 0; });
    addSceneOptions(c, o);
}

void Program::addBench() {
    Command& c =
        add("bench", "Measure speed against error, and write a report with plots.",
            "rt bench scene.yaml                     # a table, and bench/report.html\n"
            "rt bench scene.yaml --panels B --rounds 3 --size 32x24   # samplings, soon\n"
            "rt bench scene.yaml --pareto --max-rmse 0.05   # the flags that do, fastest\n");
    BenchOptions& o = bench_;
    c.arguments("scenes", "SCENE", "Scenes, YAML files.", o.scenes);
    c.option("-o,--output", "DIR",
             "Write report.html, report.json, report.csv and the plots here; ./bench by default.",
             [&o](const std::string& word) { o.folder = checkedOutput(word); });
    c.option("--panels", "LETTERS", "Of A arithmetic, B sampling, C features; ABC by default.",
             [&o](const std::string& word) {
                 if (word.empty() || word.find_first_not_of("ABC") != std::string::npos)
                     throw UsageError("must be letters of ABC, such as AB (got " +
                                      scene::quoted(word) + ")");
                 o.panels = word;
             });
    c.option(
        "--rounds", "N",
        "How often each configuration is timed, in turns with the others; 11 by default.",
        [&o](const std::string& word) { o.rounds = static_cast<int>(parseWhole(word, 1, 1000)); });
    c.option("-s,--size", "WxH", "Size of the pictures; the scene's, at most 160 wide, by default.",
             [&o](const std::string& word) {
                 const Size size = parseSize(word);
                 o.resized = true;
                 o.overrides.push_back("image.width=" + std::to_string(size.width));
                 o.overrides.push_back("image.height=" + std::to_string(size.height));
             });
    c.option("--reference", "N",
             "Panel B is held against grids of NxN and one more each way; 16 by default.",
             [&o](const std::string& word) { o.reference = parseWhole(word, 2, 63); });
    c.option(
        "-t,--threads", "N", "Threads to use; 0, the default, is all that the process may use.",
        [&o](const std::string& word) { o.threads = static_cast<int>(parseWhole(word, 0, 1024)); });
    c.flag("--pareto", "Print the flags for rt render that are fastest within the limits below.",
           o.pareto);
    c.option("--max-wrong", "N", "With --pareto: wrong pixels that f64 may have; 0 by default.",
             [&o](const std::string& word) { o.maxWrong = parseWhole(word, 0, kMaxWhole); });
    c.option("--max-rmse", "E", "With --pareto: the largest RMSE in linear light.",
             [&o](const std::string& word) { o.maxRmse = parseReal(word, 0, 1); });
    c.option("--budget", "TIME", "With --pareto: the longest time per frame, such as 1s.",
             [&o](const std::string& word) { o.budget = parseDuration(word); });
    addSceneOptions(c, o);
}

void Program::addCheck() {
    Command& c = add("check", "Find what is wrong with scenes, without drawing them.",
                     "rt check scene.yaml                # every error with its place\n"
                     "rt check a.yaml b.yaml             # several at once\n"
                     "rt check scene.yaml --json-errors  # for editors and scripts\n");
    c.arguments("scenes", "SCENE", "Scenes, YAML files.", check_.scenes);
    addSceneOptions(c, check_);
}

void Program::addInfo() {
    Command& c = add("info", "Tell what a scene holds, what it loads and why, and what it costs.",
                     "rt info scene.yaml         # counts, bounds, plugins, memory\n"
                     "rt info scene.yaml --full  # the scene with every default filled in\n"
                     "rt info in.obj             # a mesh, and what has to be repaired\n");
    c.argument("scene", "SCENE", "The scene, a YAML file; or a mesh, .obj or .ply.", info_.scene);
    c.flag("--full", "Print the scene as YAML with every default filled in.", info_.full);
    c.flag("--json", "Print JSON.", info_.json);
    addSceneOptions(c, info_);
}

void Program::addSchema() {
    Command& c =
        add("schema", "Print the JSON Schema of scenes, with every plugin that is installed.",
            "rt schema > rt.schema.json       # for editors\n"
            "rt schema --plugin-dir plugins   # with your own plugins\n"
            "rt schema | grep radius          # is there such a key?\n");
    addPluginDirs(c, schema_.pluginDirs);
}

void Program::addConvert() {
    Command& c = add("convert", "Turn .inf scenes and their movie files into YAML, losing nothing.",
                     "rt convert Scene.inf                      # writes Scene.yaml beside it\n"
                     "rt convert Scene.inf -o new/scene.yaml    # elsewhere; paths are adapted\n"
                     "rt convert --check Scene.inf Other.inf    # only tells what would happen\n");
    ConvertOptions& o = convert_;
    c.arguments("files", "FILE", "Scene files (.inf).", o.files);
    c.option("-o,--output", "FILE",
             "Write here instead of beside the input; - is stdout. For one FILE only.",
             [&o](const std::string& word) { o.output = checkedOutput(word); });
    c.flag("--check", "Convert and validate, and write nothing.", o.check);
    c.option("--movie", "FILE", "The movie file, whatever the scene says. For one FILE only.",
             [&o](const std::string& word) { o.movie = checkedOutput(word); });
    c.flag("--lenient", "Read as forgivingly as the original program; each case is noted.",
           o.lenient);
    c.option("--window-order", choiceName(kWindowOrders), "Which number of `window` comes first.",
             [&o](const std::string& word) {
                 o.windowOrder =
                     static_cast<converters::WindowOrder>(parseChoice(word, kWindowOrders));
             });
    c.flag("--json-notes", "Print the notes as JSON on stdout, one per line.", o.jsonNotes);
    addPluginDirs(c, o.pluginDirs);
}

void Program::addMesh() {
    Command& c = add("mesh", "Repair a mesh file, and say of every face what became of it.",
                     "rt mesh repair in.obj -o out.obj         # prints what was repaired\n"
                     "rt mesh repair in.obj --report r.json    # face by face; writes no mesh\n"
                     "rt mesh repair in.ply -o - > out.obj     # PLY becomes OBJ\n");
    MeshOptions& o = mesh_;
    c.argument("action", "ACTION", "repair.", o.action);
    c.argument("mesh", "MESH", "The mesh: .obj or .ply, also gzipped.", o.file);
    c.option("-o,--output", "FILE", "Write the repaired mesh here, as OBJ; - is stdout.",
             [&o](const std::string& word) { o.output = checkedOutput(word); });
    c.option("--report", "FILE",
             "Write what was done as JSON: counts, and each face of the file in its order.",
             [&o](const std::string& word) { o.report = checkedOutput(word); });
    c.option("--repair", choiceName(kRepairs),
             "full, the default: drop duplicate and degenerate faces, orient the others; orient: "
             "only that; none: only join what lies together.",
             [&o](const std::string& word) { parseChoice(word, kRepairs), o.level = word; });
    addPluginDirs(c, o.pluginDirs);
}

void Program::addCompare() {
    Command& c = add("compare", "Measure how far two pictures differ, in linear light.",
                     "rt compare a.png b.png                     # exit 0 if equal, 1 if not\n"
                     "rt compare a.png b.png --tolerance 0.01    # pixels that differ by more\n"
                     "rt compare a.png b.png --diff diff.png     # where they differ\n");
    CompareOptions& o = compare_;
    c.argument("a", "A", "A picture.", o.a);
    c.argument("b", "B", "The other picture, of the same size.", o.b);
    c.option("--crop", "X0,Y0,X1,Y1", "Compare only these pixels.",
             [&o](const std::string& word) { o.crop = parseRectangle(word); });
    c.option("--mask", "FILE", "Compare only where this picture is not black.",
             [&o](const std::string& word) { o.mask = checkedOutput(word); });
    c.option("--diff", "FILE", "Write a picture of the absolute differences.",
             [&o](const std::string& word) { o.difference = checkedOutput(word); });
    c.option("--tolerance", "E",
             "The largest difference of a channel that counts as equal; 0 by default, 1 is display "
             "white.",
             [&o](const std::string& word) { o.tolerance = parseReal(word, 0, 1); });
    c.option("--encoding", choiceName(kEncodings),
             "What 8- and 16-bit samples are; as the file says by default, or else srgb.",
             [&o](const std::string& word) {
                 o.encoding = static_cast<scene::Encoding>(parseChoice(word, kEncodings));
             });
    c.flag("--json", "Print JSON.", o.json);
}

void Program::addPlugins() {
    Command& c = add("plugins", "List the plugins, or show one with its parameters and an example.",
                     "rt plugins          # all, broken ones with the reason\n"
                     "rt plugins sphere   # its parameters and an example\n"
                     "rt plugins --json   # for scripts\n");
    c.argument("name", "[NAME]", "The plugin to show.", plugins_.name, false);
    c.option("--check", "FILE",
             "Hold a plugin against the rules of plugin.h, with rays of its own.",
             [this](const std::string& word) { plugins_.check = checkedOutput(word); });
    c.flag("--json", "Print JSON.", plugins_.json);
    addPluginDirs(c, plugins_.pluginDirs);
}

void Program::addNew() {
    Command& c = add("new", "Write a first scene, or the project of a plugin that builds at once.",
                     "rt new scene first             # ./first.yaml, ready to render\n"
                     "rt new shape torus             # ./torus: source, CMakeLists.txt, scene\n"
                     "rt new loader stl --folder s   # in another folder\n");
    NewOptions& o = new_;
    c.argument("kind", "KIND", "scene, shape, texture or loader.", o.kind);
    c.argument("name", "NAME", "Of the scene's file, or of the type in scenes: a-z, 0-9 and _.",
               o.name);
    c.option("--folder", "DIR",
             "Write into this folder; a plugin's must be new or empty and is ./NAME by default.",
             [&o](const std::string& word) { o.folder = checkedOutput(word); });
}

void Program::addExplain() {
    Command& c = add("explain", "Explain an error code: what it means and what to do.",
                     "rt explain E0312        # one code\n"
                     "rt explain              # all of them\n"
                     "rt explain | grep mesh  # those about meshes\n");
    c.argument("code", "[CODE]", "The code of the message, such as E0312.", explain_.code, false);
}

void Program::addCompletion() {
    Command& c =
        add("completion", "Print the completion script of a shell.",
            "rt completion bash > ~/.local/share/bash-completion/completions/rt   # bash\n"
            "rt completion zsh > ~/.zfunc/_rt                                     # zsh\n"
            "rt completion fish > ~/.config/fish/completions/rt.fish              # fish\n");
    c.argument("shell", "SHELL", "bash, zsh or fish.", completion_.shell);
}

// ---- reading ------------------------------------------------------------------------------------------------

/// What other programs call it, what it begins with, what it nearly is; or "".
std::string optionHint(const std::string& name, const std::vector<std::string>& known) {
    static const std::vector<std::pair<std::vector<std::string>, std::string>> kElsewhere{
        {{"-W", "-H", "-w", "--width", "--height", "--resolution", "--res", "-r"}, "--size"},
        {{"--out", "--outfile", "--out-file"}, "--output"},
        {{"-j", "--jobs", "--nthreads"}, "--threads"},
        {{"--spp", "--samples", "--aa"}, "--antialias"},
        {{"-D", "--define", "-p", "--param"}, "--set"},
        {{"--window", "--cropwindow", "--region"}, "--crop"}};
    std::string hint = scene::nearest(name, known);
    for (const auto& [names, ours] : kElsewhere)
        if (std::count(names.begin(), names.end(), name) &&
            std::count(known.begin(), known.end(), ours))
            hint = ours;
    if (hint.empty() && name.size() > 3) // two dashes and two letters
        for (const std::string& option : known)
            if (option.starts_with(name)) hint = option;
    return hint.empty() ? "" : "did you mean '" + hint + "'?";
}

void Program::refuseExtras(const Command* command) const {
    const std::vector<std::string> extras = app_.remaining();
    if (extras.empty()) return;
    const std::string& word = extras.front();
    if (word.size() > 1 && word[0] == '-') {
        const std::string name = word.substr(0, word.find('=', 2));
        std::vector<std::string> names;
        for (const Command* from : {static_cast<const Command*>(root_.get()), command})
            if (from)
                for (const CLI::Option* option : std::as_const(from->app).get_options())
                    for (const std::string& known : describe(*option).names) names.push_back(known);
        if (std::find(names.begin(), names.end(), name) != names.end())
            throw UsageError(name + " belongs behind the command",
                             "try: rt " + command->app.get_name() + " " + name);
        throw UsageError("there is no option " + scene::quoted(name), optionHint(name, names));
    }
    if (command) throw UsageError(scene::quoted(word) + " is one argument too many");
    std::vector<std::string> names;
    for (const auto& known : commands_) names.push_back(known->app.get_name());
    const std::string near = scene::nearest(word, names);
    std::string hint;
    if (!near.empty())
        hint = "did you mean '" + near + "'?";
    else if (word.ends_with(".yaml") || word.ends_with(".yml"))
        hint = "to draw a scene: rt render " + word;
    else if (word.ends_with(".inf"))
        hint = "to convert a scene: rt convert " + word;
    else if (word.ends_with(".obj") || word.ends_with(".ply"))
        hint = "to look at a mesh: rt info " + word;
    throw UsageError("there is no command " + scene::quoted(word), hint);
}

void Program::parse(int argc, const char* const* argv, CommandLine& line) {
    try {
        app_.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        // All that is left to CLI11 to refuse is an option at the end of the line without its value: "--size: 1 required WxH missing".
        if (const Command* const command = chosen()) line.command = command->app.get_name();
        const std::string what = error.what();
        throw UsageError(what.substr(0, what.find(':')) + " needs a value");
    }
    const Command* const command = chosen();
    if (command) line.command = command->app.get_name();
    root_->take();
    line.common = common;
    refuseExtras(command);
    if (command) command->take();

    if (root_->help || (command && command->help)) {
        const Command& asked = command ? *command : *root_;
        line.options = HelpText{helpText(asked.app, asked.examples)};
        return;
    }
    if (versionFlag_ || line.command == "version") {
        line.options = VersionOptions{};
        return;
    }
    if (!command) throw UsageError("a command is missing", "try: rt render scene.yaml");
    command->complete();
    if (line.command == "render") {
        render_.words.assign(argv + 1, argv + argc);
        line.options = render_;
    }
    if (line.command == "encode") line.options = encode_;
    if (line.command == "farm") line.options = farm_;
    if (line.command == "task") line.options = task_;
    if (line.command == "bench") {
        if (!bench_.pareto && (bench_.maxWrong || bench_.maxRmse || bench_.budget))
            throw UsageError("--max-wrong, --max-rmse and --budget need --pareto");
        line.options = bench_;
    }
    if (line.command == "check") line.options = check_;
    if (line.command == "info") line.options = info_;
    if (line.command == "schema") line.options = schema_;
    if (line.command == "convert") line.options = convert_;
    if (line.command == "view") line.options = view_;
    if (line.command == "mesh") {
        parseChoice(mesh_.action, kMeshActions);
        line.options = mesh_;
    }
    if (line.command == "compare") line.options = compare_;
    if (line.command == "plugins") line.options = plugins_;
    if (line.command == "new") {
        parseChoice(new_.kind, kNewKinds);
        line.options = new_;
    }
    if (line.command == "explain") line.options = explain_;
    if (line.command == "completion") {
        parseChoice(completion_.shell, kShells);
        line.options = completion_;
    }
    if (line.command == "help") {
        const Command* topic = helpTopic_.empty() ? root_.get() : nullptr;
        std::vector<std::string> names;
        for (const auto& known : commands_) {
            names.push_back(known->app.get_name());
            if (names.back() == helpTopic_) topic = known.get();
        }
        if (!topic) parseChoice(helpTopic_, names); // throws
        line.options = HelpText{helpText(topic->app, topic->examples)};
    }
}

std::vector<CommandDescription> Program::describeAll() const {
    std::vector<const Command*> all{root_.get()};
    for (const auto& command : commands_) all.push_back(command.get());
    std::vector<CommandDescription> descriptions;
    for (const Command* command : all) {
        CommandDescription description{command == root_.get() ? "rt" : command->app.get_name(),
                                       command->app.get_description(),
                                       {},
                                       {}};
        for (const CLI::Option* option : command->app.get_options())
            (option->get_positional() ? description.arguments : description.options)
                .push_back(describe(*option));
        descriptions.push_back(std::move(description));
    }
    return descriptions;
}

} // namespace

const std::vector<std::string>& progressStyleNames() {
    static const std::vector<std::string> names{"auto", "bar", "plain", "none"};
    return names;
}

std::string choiceName(const std::vector<std::string>& choices) {
    std::string name;
    for (const std::string& choice : choices) name += (name.empty() ? "" : "|") + choice;
    return name;
}

void parseCommandLine(int argc, const char* const* argv, CommandLine& line) {
    Program().parse(argc, argv, line);
}

std::vector<CommandDescription> describeCommands() { return Program().describeAll(); }

} // namespace rt::cli
