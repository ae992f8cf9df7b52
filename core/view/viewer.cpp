#include <core/view/viewer.hpp>

#include <core/geometry/bounds.hpp>
#include <core/geometry/surface.hpp>
#include <core/image/quantize.hpp>
#include <core/parallel/parallel.hpp>
#include <core/trace/camera.hpp>
#include <core/trace/render.hpp>
#include <core/view/fly_camera.hpp>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <future>
#include <optional>
#include <span>

namespace rt::view {

namespace {

using Clock = std::chrono::steady_clock;
using numeric::Radians;
using numeric::Vec3;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr double kTurn = 3 * numeric::kRadiansPerDegree;
constexpr int kIdlePoll = 20, kBusyPoll = 1; // milliseconds between looks at the keyboard
constexpr double kWatchSeconds = 0.25;

// X11 key symbols that OpenCV passes on.
constexpr int kEscape = 27, kLeft = 0xff51, kUp = 0xff52, kRight = 0xff53, kDown = 0xff54;

std::string number(double x, int digits) {
    char buffer[64];
    return {
        buffer,
        std::to_chars(buffer, buffer + sizeof buffer, x, std::chars_format::general, digits).ptr};
}

std::string vector(const Vec3& v) {
    return "[" + number(v.x, 6) + ", " + number(v.y, 6) + ", " + number(v.z, 6) + "]";
}

/// What a frame shows at the size of the picture: each of its pixels as a block.
Picture displayed(const image::Framebuffer& frame, const scene::Image& image, int threads) {
    Picture picture{image.width, image.height,
                    std::vector<std::uint8_t>(std::size_t(image.width) * image.height * 3)};
    static_assert(sizeof(numeric::LinearRgb) == 3 * sizeof(double));
    const auto encode = [&](std::size_t row, std::uint8_t* codes) {
        const std::span<const double> light{&frame.pixels[row * frame.width].r,
                                            frame.width * std::size_t{3}};
        image.encoding == scene::Encoding::srgb ? image::toSrgb8(light, codes)
                                                : image::toLinear8(light, codes);
    };
    // Row y of the picture shows row y * frame.height / image.height; the first that shows one makes it.
    parallel::forEach(frame.height, threads, [&](std::size_t row) {
        const auto firstOf = [&](std::size_t r) {
            return (r * image.height + frame.height - 1) / frame.height;
        };
        std::uint8_t* const begin = &picture.rgb[firstOf(row) * image.width * 3];
        if (frame.width == image.width) {
            encode(row, begin);
        } else {
            std::vector<std::uint8_t> codes(frame.width * std::size_t{3});
            encode(row, codes.data());
            std::uint8_t* to = begin;
            for (std::size_t column = 0, x = 0; column < frame.width; ++column)
                for (; x * frame.width < (column + 1) * image.width; ++x)
                    to = std::copy_n(&codes[3 * column], 3, to);
        }
        for (std::size_t y = firstOf(row) + 1; y < firstOf(row + 1); ++y)
            std::copy_n(begin, image.width * std::size_t{3}, &picture.rgb[y * image.width * 3]);
    });
    return picture;
}

/// Levels of a picture, coarse to fine: eighths of the size, then the scene's own antialiasing.
struct Level {
    static constexpr std::uint32_t kFinest = 8;
    std::uint32_t eighths = 1;
    bool full = false; // the scene's own settings: what `rt render` would write

    std::uint32_t of(std::uint32_t side) const { return (side * eighths + kFinest - 1) / kFinest; }
    std::string name(const scene::Image& image) const {
        if (full) return "final";
        return std::to_string(of(image.width)) + "x" + std::to_string(of(image.height));
    }
};

class Viewer {
public:
    Viewer(std::shared_ptr<const Stage> stage, Display& display, const Services& services,
           const ViewOptions& options)
        : stage_(std::move(stage)), display_(display), services_(services), options_(options),
          fly_(stage_->description.camera) {
        speed_ = defaultSpeed();
    }

    void run() {
        restart();
        while (!quit_) {
            if (rendering_.valid()) {
                if (rendering_.wait_for(std::chrono::milliseconds(0)) == std::future_status::ready)
                    finishRender();
            } else if (pending_) {
                startRender();
            } else if (playing_) {
                playFrame();
            }
            const bool idle = !rendering_.valid() && !pending_ && !playing_;
            const auto events = display_.poll(idle ? kIdlePoll : kBusyPoll, idle);
            if (!events) break;
            for (const Event& event : *events) handle(event);
            watch();
        }
        abandon();
    }

private:
    struct Rendered {
        Picture picture;
        bool complete;
        double seconds;
        double rays;
    };

    // ---- rendering -----------------------------------------------------------------------------------

    /// The camera, scene or mode changed: what is being rendered is out of date.
    void restart() {
        abandon();
        pending_ = level(startEighths());
    }

    /// The finest size that the last pictures say can be traced and shown in time.
    std::uint32_t startEighths() const {
        if (secondsPerPixel_ == 0) return 1;
        const double budget = options_.frameSeconds - secondsToShow_;
        std::uint32_t eighths = Level::kFinest;
        while (eighths > 1 && secondsPerPixel_ * pixels({eighths}) > budget) --eighths;
        return eighths;
    }
    /// The full size is the final picture where the scene asks for one sample a pixel.
    Level level(std::uint32_t eighths) const {
        const scene::Render& render = stage_->description.render;
        const bool plain = std::holds_alternative<scene::AntialiasNone>(render.antialias);
        return {eighths, eighths == Level::kFinest && plain && !render.smooth};
    }
    Level finer(const Level& at) const {
        return at.eighths < Level::kFinest ? level(std::min(2 * at.eighths, Level::kFinest))
                                           : Level{Level::kFinest, true};
    }
    double pixels(const Level& at) const {
        const auto& image = stage_->description.image;
        return double(at.of(image.width)) * at.of(image.height);
    }

    void abandon() {
        stop_ = true;
        if (rendering_.valid()) rendering_.get();
        stop_ = false;
    }

    scene::Description descriptionAt(const Level& at) const {
        scene::Description description = stage_->description;
        if (moved_) description.camera = fly_.camera();
        if (!at.full) {
            description.image.width = at.of(description.image.width);
            description.image.height = at.of(description.image.height);
            description.render.antialias = scene::AntialiasNone{};
            description.render.smooth = false;
        }
        return description;
    }

    void startRender() {
        level_ = *pending_;
        pending_.reset();
        rendering_ = std::async(std::launch::async, [this, stage = stage_,
                                                     description = descriptionAt(level_),
                                                     shade = shade_] {
            const auto begin = Clock::now();
            trace::Options options;
            options.threads = options_.threads;
            options.shade = shade;
            options.stop = &stop_;
            trace::Result result = trace::render(stage->octree, stage->world, description, options);
            trace::scaleForDisplay(result.frame, shade);
            const auto& counts = result.counts;
            Rendered rendered;
            rendered.complete = result.complete;
            if (result.complete)
                rendered.picture =
                    displayed(result.frame, stage->description.image, options_.threads);
            rendered.seconds = secondsSince(begin);
            rendered.rays =
                double(counts.primary + counts.reflected + counts.refracted + counts.shadow);
            return rendered;
        });
    }

    void finishRender() {
        const Rendered done = rendering_.get();
        if (!done.complete) return;
        if (!level_.full || level(Level::kFinest).full)
            secondsPerPixel_ = done.seconds / pixels(level_);
        megaraysPerSecond_ = done.rays / done.seconds / 1e6;
        const auto now = Clock::now();
        framesPerSecond_ = 1 / std::chrono::duration<double>(now - lastShown_).count();
        lastShown_ = now;
        shown_ = std::move(done.picture);
        if (!level_.full && !playing_) pending_ = finer(level_);
        present();
    }

    /// Shows the last picture with what is to be said.
    void present() {
        const auto start = Clock::now();
        const auto& image = stage_->description.image;
        const Detail detail{level_.of(image.width), level_.of(image.height),
                            level_.full && !rendering_.valid() && !pending_};
        std::vector<std::string> lines;
        if (options_.overlay)
            lines.push_back(number(framesPerSecond_, 3) + " fps  " + level_.name(image) + "  " +
                            number(megaraysPerSecond_, 3) + " Mrays/s" +
                            (frame_ ? "  frame " + std::to_string(*frame_) : ""));
        if (help_) lines.insert(lines.end(), helpLines().begin(), helpLines().end());
        lines.insert(lines.end(), errors_.begin(), errors_.end());
        if (lines.empty()) {
            display_.show(shown_, detail);
        } else {
            Picture annotated = shown_;
            display_.annotate(annotated, lines);
            display_.show(annotated, detail);
        }
        if (!detail.final) secondsToShow_ = secondsSince(start); // a replay saves the final ones
    }

    // ---- input ---------------------------------------------------------------------------------------

    void handle(const Event& event) {
        switch (event.kind) {
        case Event::Kind::key:
            return handleKey(event.key);
        case Event::Kind::press:
            pressed_ = dragged_ = event;
            return;
        case Event::Kind::release:
            if (pressed_ && pressed_->x == event.x && pressed_->y == event.y)
                describe(event.x, event.y);
            pressed_.reset();
            return;
        case Event::Kind::move:
            if (!pressed_) return;
            look(event);
            return;
        case Event::Kind::wheel:
            return fly([&](double step) { fly_.move(0, event.y * step, 0); });
        }
    }

    /// Dragging by the height of the picture turns by its vertical field of view.
    void look(const Event& event) {
        const auto& camera = fly_.camera();
        const double perPixel =
            camera.screenHeight / (camera.screenDistance * stage_->description.image.height);
        const double yaw = (event.x - dragged_->x) * perPixel,
                     pitch = (event.y - dragged_->y) * perPixel;
        dragged_ = event;
        if (yaw != 0 || pitch != 0)
            fly([&](double) { fly_.turn(Radians{yaw}, Radians{pitch}, Radians{0}); });
    }

    template <class Change> void fly(Change change) {
        change(speed_);
        moved_ = true;
        restart();
    }

    void handleKey(int key) {
        const auto turn = [&](double yaw, double pitch, double roll) {
            fly([&](double) {
                fly_.turn(Radians{yaw * kTurn}, Radians{pitch * kTurn}, Radians{roll * kTurn});
            });
        };
        const auto move = [&](double right, double forward, double up) {
            fly([&](double step) { fly_.move(right * step, forward * step, up * step); });
        };
        switch (key) {
        case 'w':
            return move(0, 1, 0);
        case 's':
            return move(0, -1, 0);
        case 'a':
            return move(-1, 0, 0);
        case 'd':
            return move(1, 0, 0);
        case 'r':
            return move(0, 0, 1);
        case 'f':
            return move(0, 0, -1);
        case 'q':
            return turn(0, 0, -1);
        case 'e':
            return turn(0, 0, 1);
        case 'j':
        case kLeft:
            return turn(1, 0, 0);
        case 'l':
        case kRight:
            return turn(-1, 0, 0);
        case 'i':
        case kUp:
            return turn(0, 1, 0);
        case 'k':
        case kDown:
            return turn(0, -1, 0);
        case '+':
        case '=':
            speed_ *= 1.5;
            return;
        case '-':
            speed_ /= 1.5;
            return;
        case '1':
        case '2':
        case '3':
        case '4':
        case '5':
            shade_ = static_cast<trace::Shade>(key - '1');
            return restart();
        case ' ':
            playing_ = !playing_ && hasFrames();
            if (!playing_) return restart();
            playStart_ = Clock::now() - framesAsTime(frame_.value_or(0));
            return;
        case ',':
            return stepFrame(-1);
        case '.':
            return stepFrame(+1);
        case 'p':
            return services_.savePng(shown_);
        case 'c':
            return services_.print(moved_ ? fly_.yaml()
                                          : FlyCamera(stage_->description.camera).yaml());
        case 'h':
            help_ = !help_;
            return present();
        case kEscape:
            quit_ = true;
            return;
        default:
            return;
        }
    }

    bool hasFrames() const {
        return stage_->description.animation && stage_->description.animation->frames > 1;
    }

    Clock::duration framesAsTime(double frames) const {
        const double seconds = frames / stage_->description.animation->fps;
        return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    }

    void stepFrame(int step) {
        if (!hasFrames()) return;
        const std::uint32_t frames = stage_->description.animation->frames;
        playing_ = false;
        showFrame((frame_.value_or(0) + frames + static_cast<std::uint32_t>(step)) % frames);
    }

    /// The frame whose time has come; those that came and went while the last was drawn are left out.
    void playFrame() {
        const auto& animation = *stage_->description.animation;
        const auto due = static_cast<std::uint64_t>(secondsSince(playStart_) * animation.fps);
        const auto next = static_cast<std::uint32_t>(due % animation.frames);
        if (next != frame_) showFrame(next);
    }

    void showFrame(std::uint32_t number) {
        abandon();
        if (auto stage = services_.frame(number)) {
            stage_ = std::move(stage);
            frame_ = number;
        } else {
            playing_ = false; // what is wrong was said
        }
        restart();
    }

    /// A hundredth of the scene's diagonal a key.
    double defaultSpeed() const {
        const numeric::Box3d box = geometry::boundsOf(stage_->world.primitives);
        return box.empty() ? 1 : numeric::length(box.diagonal()) / 100;
    }

    /// What stands at a pixel: name, material, distance from the eye, uv.
    void describe(int x, int y) {
        const scene::Description description = descriptionAt({Level::kFinest, true});
        const auto& image = description.image;
        if (x < 0 || y < 0 || x >= int(image.width) || y >= int(image.height)) return;
        const trace::Camera camera(description.camera, image.width, image.height,
                                   description.render.nearPlane);
        const geometry::Ray ray = camera.through(x + 0.5, y + 0.5);
        const geometry::Hit hit = stage_->octree.closest(ray);
        if (!hit) return services_.print("background\n");
        const geometry::Surface surface = geometry::surfaceAt(stage_->world.primitives, ray, hit);
        const numeric::Vec2 uv = geometry::uvOf(surface);
        services_.print(
            stage_->world.objectNames[static_cast<std::size_t>(surface.object)] + ": material " +
            stage_->world.materialNames[static_cast<std::size_t>(surface.material)] +
            ", distance " + number(numeric::length(surface.position - camera.eye()), 6) +
            ", position " + vector(surface.position) + ", uv [" + number(uv.x, 6) + ", " +
            number(uv.y, 6) + "]\n");
    }

    // ---- the scene's files ---------------------------------------------------------------------------

    void watch() {
        if (secondsSince(lastWatch_) < kWatchSeconds) return;
        lastWatch_ = Clock::now();
        if (!services_.changed()) return;
        Reload fresh = services_.reload();
        errors_ = fresh.errors;
        if (!fresh.stage) return present(); // the last good picture stays
        abandon();
        stage_ = std::move(fresh.stage);
        if (!moved_) fly_ = FlyCamera(stage_->description.camera);
        frame_.reset();
        playing_ = playing_ && hasFrames();
        restart();
    }

    std::shared_ptr<const Stage> stage_;
    Display& display_;
    const Services& services_;
    const ViewOptions options_;

    FlyCamera fly_;
    bool moved_ = false; // until then the scene's own camera is used, to the bit
    double speed_ = 1;   // world units a key
    trace::Shade shade_ = trace::Shade::full;
    std::optional<std::uint32_t> frame_;
    Clock::time_point playStart_; // when frame 0 was due
    bool playing_ = false, help_ = false, quit_ = false;
    std::optional<Event> pressed_, dragged_;

    std::future<Rendered> rendering_;
    std::atomic<bool> stop_{false};
    std::optional<Level> pending_; // to be rendered next
    Level level_;                  // being rendered, or shown
    Picture shown_;
    std::vector<std::string> errors_;
    double secondsPerPixel_ = 0, secondsToShow_ = 0; // of the last picture
    double framesPerSecond_ = 0, megaraysPerSecond_ = 0;
    Clock::time_point lastShown_ = Clock::now(), lastWatch_ = Clock::now();
};

} // namespace

void run(std::shared_ptr<const Stage> stage, Display& display, const Services& services,
         const ViewOptions& options) {
    Viewer(std::move(stage), display, services, options).run();
}

const std::vector<std::string>& helpLines() {
    static const std::vector<std::string> lines = {
        "W S  forward, back        A D  left, right       R F  up, down",
        "I K  look up, down        J L  look left, right  Q E  roll",
        "+ -  faster, slower       drag looks around, wheel moves, click names",
        "1 2 3 4 5  full, normals, depth, id, cost",
        "space  play               , .  one frame back, on",
        "P  save PNG   C  print camera   H  this help   Esc  quit",
    };
    return lines;
}

} // namespace rt::view
