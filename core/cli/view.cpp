// rt view: fly through a scene, in a window or replayed from a script.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/load_scene.hpp>
#include <core/cli/output.hpp>
#include <core/film/frame.hpp>
#include <core/image/quantize.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/scene/source.hpp>
#include <core/view/script.hpp>
#include <core/view/viewer.hpp>
#include <formats/window.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <system_error>

namespace rt::cli {

namespace {

constexpr std::uint64_t kLargestScript = 1 << 20;

class WindowDisplay final : public view::Display {
public:
    WindowDisplay(const std::string& title, const scene::Image& image)
        : window_(title, image.width, image.height) {}

    void show(const view::Picture& picture, const view::Detail&) override {
        window_.show(picture.rgb.data(), picture.width, picture.height);
    }
    std::optional<std::vector<view::Event>> poll(int milliseconds, bool) override {
        const auto events = window_.poll(milliseconds);
        if (!events) return std::nullopt;
        std::vector<view::Event> translated;
        for (const rt_window_event& e : *events)
            translated.push_back(
                {static_cast<view::Event::Kind>(e.kind - RT_WINDOW_KEY), e.key, e.x, e.y});
        return translated;
    }
    void annotate(view::Picture& picture, const std::vector<std::string>& lines) override {
        annotateWithModule(picture, lines);
    }

    static void annotateWithModule(view::Picture& picture, const std::vector<std::string>& lines) {
        std::vector<const char*> texts;
        for (const std::string& line : lines) texts.push_back(line.c_str());
        formats::windowModule().annotate(picture.rgb.data(), picture.width, picture.height,
                                         texts.data(), static_cast<std::uint32_t>(texts.size()));
    }

private:
    formats::Window window_;
};

/// The linear picture whose encoding is this one, to the bit.
image::Framebuffer decoded(const view::Picture& picture, scene::Encoding encoding) {
    image::Framebuffer frame(picture.width, picture.height);
    const auto value = [&](std::uint8_t code) {
        return encoding == scene::Encoding::srgb ? image::linearFromSrgb8(code) : code / 255.0;
    };
    for (std::size_t i = 0; i < frame.pixels.size(); ++i)
        frame.pixels[i] = {value(picture.rgb[3 * i]), value(picture.rgb[3 * i + 1]),
                           value(picture.rgb[3 * i + 2])};
    return frame;
}

void writePng(const std::string& path, const view::Picture& picture, scene::Encoding encoding) {
    formats::writeFileAtomically(path, formats::encodeImage(decoded(picture, encoding),
                                                            formats::ImageFormat::png,
                                                            {.transfer = encoding}));
}

std::string fourDigits(std::size_t n) {
    std::string text = std::to_string(n);
    return text.size() < 4 ? std::string(4 - text.size(), '0') + text : text;
}

/// The scene file and the files it names, and when they last changed.
class WatchedFiles {
public:
    void watch(const std::string& scenePath, const scene::Description& description) {
        times_.clear();
        add(scenePath);
        const auto addAll = [&](const scene::Instance& instance) {
            for (const scene::Value& value : instance.values)
                if (const auto* text = std::get_if<std::string>(&value.data);
                    text && std::filesystem::path(*text).is_absolute())
                    add(*text);
        };
        for (const scene::Texture& texture : description.textures) addAll(texture.instance);
        for (const scene::Object& object : description.objects) addAll(object.shape);
    }
    /// Once for each change.
    bool changed() {
        bool any = false;
        for (auto& [path, time] : times_)
            if (const auto now = timeOf(path); now != time) time = now, any = true;
        return any;
    }

private:
    void add(const std::string& path) { times_.emplace_back(path, timeOf(path)); }
    static std::filesystem::file_time_type timeOf(const std::string& path) {
        std::error_code missing; // while an editor replaces it
        return std::filesystem::last_write_time(path, missing);
    }
    std::vector<std::pair<std::string, std::filesystem::file_time_type>> times_;
};

std::vector<std::string> firstLines(const scene::Diagnostics& diagnostics) {
    std::vector<std::string> lines;
    for (const scene::Diagnostic& diagnostic : diagnostics.all()) {
        const std::string text = scene::format(diagnostic, false);
        lines.push_back(text.substr(0, text.find('\n')));
    }
    return lines;
}

std::shared_ptr<const view::Stage> staged(scene::Description description, world::World world,
                                          int threads) {
    auto stage = std::make_shared<view::Stage>();
    stage->description = std::move(description);
    stage->world = std::move(world);
    const scene::Render& render = stage->description.render;
    stage->octree =
        octree::Octree::build(stage->world.primitives, {.maxObjects = render.octreeMaxObjects,
                                                        .minSize = render.octreeMinSize,
                                                        .threads = threads});
    return stage;
}

/// `catalog` becomes the one that the stage's description refers to.
std::shared_ptr<const view::Stage> loadStage(const ViewOptions& options,
                                             std::unique_ptr<plugin_host::Catalog>& catalog,
                                             scene::Diagnostics& diagnostics) {
    auto fresh =
        std::make_unique<plugin_host::Catalog>(plugin_host::searchPath(options.pluginDirs));
    auto loaded = loadScene(options.scene, options, *fresh, diagnostics);
    if (!loaded) return nullptr;
    auto world = plugin_host::lower(loaded->description, *fresh, diagnostics,
                                    {.allowMissing = options.allowMissing,
                                     .limits = options.limits,
                                     .threads = options.threads});
    if (!world) return nullptr;
    catalog = std::move(fresh);
    return staged(std::move(loaded->description), std::move(*world), options.threads);
}

/// How soon pictures followed events.
class Latencies {
public:
    void add(const view::ScriptDisplay::Shown& shown) {
        if (shown.firstSinceEvent) all_.push_back({shown.secondsSinceEvent, shown.detail});
    }
    /// One line; empty without events that changed the picture.
    std::string report() const {
        if (all_.empty()) return {};
        auto bySeconds = all_, bySize = all_;
        std::sort(bySeconds.begin(), bySeconds.end(),
                  [](const One& a, const One& b) { return a.seconds < b.seconds; });
        std::sort(bySize.begin(), bySize.end(),
                  [](const One& a, const One& b) { return a.detail.width < b.detail.width; });
        const double median = bySeconds[all_.size() / 2].seconds;
        const view::Detail& size = bySize[all_.size() / 2].detail;
        return std::to_string(all_.size()) + " events changed the picture, after " +
               fixed(median * 1000) + " ms (median; at most " +
               fixed(bySeconds.back().seconds * 1000) + " ms): " + fixed(1 / median) +
               " pictures/s of " + std::to_string(size.width) + "x" + std::to_string(size.height) +
               "\n";
    }

private:
    struct One {
        double seconds;
        view::Detail detail;
    };
    static std::string fixed(double value) {
        char text[64];
        return {text,
                std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, 1).ptr};
    }
    std::vector<One> all_;
};

/// DIR/0001.png … and DIR/shown.tsv: file, is it final, milliseconds since the last event, is it the first that
/// differs since, size as traced. Written when nothing is under way that it would slow down.
class Recorder {
public:
    Recorder(std::string folder, scene::Encoding encoding)
        : folder_(std::move(folder)), encoding_(encoding) {}

    void operator()(const view::ScriptDisplay::Shown& shown) {
        if (folder_.empty()) return;
        latencies_.add(shown);
        const std::string name = fourDigits(count_ + waiting_.size() + 1) + ".png";
        const view::Detail& detail = shown.detail;
        char milliseconds[32] = "-";
        if (std::isfinite(shown.secondsSinceEvent))
            *std::to_chars(milliseconds, milliseconds + 31, shown.secondsSinceEvent * 1000,
                           std::chars_format::fixed, 2)
                 .ptr = 0;
        table_ += name + '\t' + (detail.final ? "final" : "coarse") + '\t' + milliseconds + '\t' +
                  (shown.firstSinceEvent ? "first" : "-") + '\t' + std::to_string(detail.width) +
                  'x' + std::to_string(detail.height) + '\n';
        waiting_.push_back(shown.picture);
        constexpr std::size_t kMostBytes = std::size_t{256} << 20;
        if (detail.final || waiting_.size() * shown.picture.rgb.size() > kMostBytes) write();
    }
    void finish(const Console& console) {
        if (folder_.empty()) return;
        write();
        const auto* bytes = reinterpret_cast<const std::byte*>(table_.data());
        formats::writeFileAtomically(folder_ + "/shown.tsv", {bytes, bytes + table_.size()});
        console.table(latencies_.report());
    }

private:
    void write() {
        for (const view::Picture& picture : waiting_)
            writePng(folder_ + '/' + fourDigits(++count_) + ".png", picture, encoding_);
        waiting_.clear();
    }

    std::string folder_;
    scene::Encoding encoding_;
    std::vector<view::Picture> waiting_;
    std::size_t count_ = 0; // written
    std::string table_;
    Latencies latencies_;
};

} // namespace

int view(const ViewOptions& options, Console& console) {
    if (!options.record.empty() && options.script.empty())
        throw UsageError("--record needs --script", "such as --script keys.txt --record shown");
    scene::Diagnostics diagnostics;
    const auto finish = [&] {
        console.report(diagnostics);
        return diagnostics.exitCode();
    };
    std::optional<std::vector<view::Command>> script;
    if (!options.script.empty()) {
        const auto source = scene::readSource(options.script, kLargestScript, diagnostics);
        if (!source || !(script = view::parseScript(source, diagnostics))) return finish();
    }
    std::unique_ptr<plugin_host::Catalog> catalog;
    auto rest = loadStage(options, catalog, diagnostics);
    if (!rest) return finish();
    console.report(diagnostics);
    const scene::Encoding encoding = rest->description.image.encoding;
    const std::string stem = std::filesystem::path(options.scene).stem();

    WatchedFiles files;
    files.watch(options.scene, rest->description);
    view::Services services;
    services.changed = [&] { return files.changed(); };
    services.reload = [&]() -> view::Reload {
        scene::Diagnostics found;
        auto stage = loadStage(options, catalog, found);
        console.report(found);
        if (!stage) return {nullptr, firstLines(found)};
        files.watch(options.scene, stage->description);
        rest = stage;
        return {std::move(stage), {}};
    };
    services.frame = [&](std::uint32_t number) -> std::shared_ptr<const view::Stage> {
        scene::Diagnostics found;
        const auto lower = [&](const scene::Description& still, scene::Diagnostics& problems) {
            return plugin_host::lower(
                still, *catalog, problems,
                {.allowMissing = options.allowMissing, .limits = options.limits});
        };
        auto frame = film::frameAt(rest->description, rest->world, number, lower, found);
        console.report(found);
        return frame
                   ? staged(std::move(frame->description), std::move(frame->world), options.threads)
                   : nullptr;
    };
    services.print = [&](const std::string& text) { console.result(text); };
    services.savePng = [&](const view::Picture& picture) {
        for (std::size_t n = 1;; ++n) {
            const std::string path = stem + "-view-" + fourDigits(n) + ".png";
            if (std::filesystem::exists(path)) continue;
            writePng(path, picture, encoding);
            return console.result(path + "\n");
        }
    };

    const view::ViewOptions settings{.threads = options.threads,
                                     .overlay = options.overlay.value_or(!script),
                                     .frameSeconds = 1 / options.picturesPerSecond};
    if (script) {
        if (!options.record.empty()) std::filesystem::create_directories(options.record);
        Recorder recorder(options.record, encoding);
        view::ScriptDisplay display(std::move(*script), std::ref(recorder),
                                    WindowDisplay::annotateWithModule);
        view::run(rest, display, services, settings);
        recorder.finish(console);
        return kExitOk;
    }
    try {
        WindowDisplay display("rt view - " + options.scene, rest->description.image);
        view::run(rest, display, services, settings);
    } catch (const formats::NoDisplay& error) {
        console.fail("view", kExitNoDisplay, error.what(),
                     "run it on a desktop, over ssh -X, or with --script FILE --record DIR");
        return kExitNoDisplay;
    }
    return kExitOk;
}

} // namespace rt::cli
