#include <core/plugin_host/lower.hpp>

#include <core/parallel/parallel.hpp>
#include <core/plugin_host/confined.hpp>
#include <core/plugin_host/readable.hpp>
#include <core/plugin_host/run_call.hpp>
#include <core/plugin_host/sink.hpp>
#include <core/plugin_host/values.hpp>
#include <core/scene/input_file.hpp>
#include <core/scene/validate.hpp>
#include <core/world/append.hpp>

#include <algorithm>
#include <deque>
#include <map>
#include <mutex>
#include <new>
#include <set>

namespace rt::plugin_host {
namespace {

std::string inQuotes(const std::string& text) { return "'" + text + "'"; }

} // namespace

/// Where an object's geometry goes, and what is said of it.
struct Destination {
    world::World& world;
    scene::Diagnostics& diagnostics;
};

class Lowering;

/// One object; one use.
class ObjectLowering {
public:
    ObjectLowering(Lowering& scene, const scene::Object& object, const Destination& to,
                   std::unique_lock<std::mutex>* setupLock)
        : scene_(scene), object_(object), to_(to), setupLock_(setupLock) {}

    void run(geometry::ObjectId id);

private:
    static rt_status load(const rt_host* host, std::int32_t file, std::uint32_t kind,
                          rt_sink* sink);
    rt_status loadFile(Call& shapeCall, std::int32_t file, std::uint32_t kind, rt_sink* table);

    Lowering& scene_;
    const scene::Object& object_;
    const Destination to_;
    std::unique_lock<std::mutex>*
        setupLock_; // held but while the loader works; none: no other thread is in a plugin
    Sink* sink_ = nullptr;
    std::set<std::string> refusedImages_; // each is complained of once
};

/// Takes a description to a world; one use.
class Lowering {
public:
    Lowering(const scene::Description& description, Catalog& catalog,
             scene::Diagnostics& diagnostics, const LowerOptions& options)
        : description_(description), catalog_(catalog), diagnostics_(diagnostics),
          options_(options) {}

    std::optional<world::World> run() {
        const std::size_t errorsBefore = diagnostics_.errorCount();
        try {
            makeTextures();
            makeMaterials();
            makeObjects();
        } catch (const std::bad_alloc&) {
            diagnostics_.error(kNoMemory, {}, "there is not enough memory for the scene");
        }
        if (diagnostics_.errorCount() != errorsBefore) return {};
        return std::move(world_);
    }

private:
    enum class Files { present, missing, refused };

    /// The module of a type that validation has accepted, or nothing with a diagnostic.
    const rt_module* moduleOf(scene::TypeKind kind, const std::string& type,
                              const scene::Location& location, scene::Diagnostics& diagnostics) {
        const auto found = catalog_.find(kind, type);
        if (const auto* refusal = std::get_if<scene::TypeRefusal>(&found)) {
            diagnostics.error(kPluginType, location, refusal->reason);
            return nullptr;
        }
        return catalog_.open(type).module;
    }

    /// Looks at every file among the values before the plugin does.
    Files checkFiles(std::span<const rt_param> rows, const std::vector<scene::Value>& values,
                     bool mayMiss, const std::string& leftOut, scene::Diagnostics& diagnostics) {
        Files result = Files::present;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const std::string& path = rows[i].type == RT_FILE ? pathOf(values[i]) : std::string();
            if (path.empty()) continue;
            if (options_.files) options_.files->insert(path);
            const auto why = whyUnreadable(path, mostBytes());
            if (!why) continue;
            if (why->first == kNoSuchFile && mayMiss) {
                diagnostics.warning(values[i].location, why->second + "; " + leftOut);
                if (result == Files::present) result = Files::missing;
            } else {
                diagnostics.error(why->first, values[i].location, why->second,
                                  why->first == kNoSuchFile ? suggestionFor(path) : "");
                result = Files::refused;
            }
        }
        return result;
    }

    std::uint64_t mostBytes() const {
        return options_.limits.fileBytes != 0 ? options_.limits.fileBytes : scene::kMaxMeshBytes;
    }

    // ---- textures -----------------------------------------------------------------------------------------

    void makeTextures() {
        const std::size_t count = description_.textures.size();
        world_.textures.resize(count);
        textures_.assign(count, nullptr);
        progress_.assign(count, Progress::waiting);
        for (std::size_t i = 0; i < count; ++i) makeTexture(i);
    }

    /// Depth first, since a texture may evaluate others.
    void makeTexture(std::size_t i) {
        if (progress_[i] == Progress::done) return;
        const scene::Texture& texture = description_.textures[i];
        if (progress_[i] == Progress::begun) {
            diagnostics_.error(kTextureCycle, texture.instance.location,
                               "texture " + inQuotes(texture.name) + " needs itself");
            return;
        }
        progress_[i] = Progress::begun;
        if (const rt_module* module = moduleOf(scene::TypeKind::texture, texture.instance.type,
                                               texture.instance.location, diagnostics_)) {
            const rt_texture_type& type = *module->texture;
            std::vector<std::shared_ptr<const material::Texture>> needed;
            for (std::size_t k = 0; k < type.param_count; ++k)
                if (const auto* index = std::get_if<std::int64_t>(&texture.instance.values[k].data);
                    index != nullptr && type.params[k].type == RT_TEXTURE) {
                    makeTexture(static_cast<std::size_t>(*index));
                    needed.push_back(world_.textures[static_cast<std::size_t>(*index)]);
                }
            if (std::find(needed.begin(), needed.end(), nullptr) == needed.end()) {
                world_.textures[i] =
                    createTexture(type, texture.instance, std::move(needed), diagnostics_);
                textures_[i] = world_.textures[i].get();
            }
        }
        progress_[i] = Progress::done;
    }

    std::shared_ptr<const material::Texture>
    createTexture(const rt_texture_type& type, const scene::Instance& instance,
                  std::vector<std::shared_ptr<const material::Texture>> needed,
                  scene::Diagnostics& diagnostics) {
        const std::span rows(type.params, type.param_count);
        if (checkFiles(rows, instance.values, false, "", diagnostics) != Files::present)
            return nullptr;
        Call call = callFor("texture", instance, rows, kImageFile, kPluginFailed, options_.limits,
                            diagnostics);
        const ValueArray values(rows, instance.values, textures_);
        auto texture = std::make_unique<material::Texture>(material::Texture{&type, nullptr});
        if (!plugin_host::run(
                call, [&] { return type.create(&call.host, values.data(), &texture->state); }))
            return nullptr;
        // `needed` lives as long as the texture that evaluates it.
        return {texture.release(), [needed = std::move(needed)](const material::Texture* t) {
                    t->type->destroy(t->state);
                    delete t;
                }};
    }

    /// The image that a mesh's material file names, made once per file. Nothing after a complaint; `refused` are the paths
    /// that the object has had one of.
    const material::Texture* imageTexture(Call& call, const std::string& path,
                                          std::set<std::string>& refused) {
        if (const auto known = images_.find(path); known != images_.end()) return known->second;
        if (!refused.insert(path).second) return nullptr;
        if (options_.files) options_.files->insert(path);
        if (const auto why = whyUnreadable(path, mostBytes())) {
            if (why->first == kNoSuchFile && options_.allowMissing) {
                call.diagnostics->warning(call.location,
                                          why->second + "; its material goes without it");
            } else {
                call.diagnostics->error(why->first, call.location,
                                        call.subject + ": " + why->second, suggestionFor(path));
                call.failed = true;
            }
            return nullptr;
        }
        const rt_module* module =
            moduleOf(scene::TypeKind::texture, "image", call.location, *call.diagnostics);
        if (module == nullptr) return call.failed = true, nullptr;
        const std::span rows(module->texture->params, module->texture->param_count);
        scene::Instance instance{"image", {}, call.location, rows};
        for (const rt_param& row : rows) {
            const bool isFile = std::string_view(row.name) == "file";
            scene::Value value{path, call.location};
            if (!isFile) {
                const auto fallback = scene::defaultValue(row);
                if (const auto* why = std::get_if<std::string>(&fallback)) {
                    call.refuse(kPluginType,
                                std::string("texture 'image', ") + row.name + ": " + *why);
                    return nullptr;
                }
                value.data = std::get<scene::Value>(fallback).data;
            }
            instance.values.push_back(std::move(value));
        }
        auto texture = createTexture(*module->texture, instance, {}, *call.diagnostics);
        if (texture == nullptr) return call.failed = true, nullptr;
        world_.textures.push_back(std::move(texture));
        return images_[path] = world_.textures.back().get();
    }

    // ---- materials ----------------------------------------------------------------------------------------

    void makeMaterials() {
        for (const scene::Material& from : description_.materials) {
            material::Material to;
            to.color = from.color;
            if (from.colorTexture) to.colorTexture = textures_[*from.colorTexture];
            to.diffuse = from.diffuse;
            to.specular = from.specular;
            to.transmission = from.transmission;
            to.environment = from.environment;
            to.shininess = from.shininess;
            to.ior = from.ior;
            world_.materials.push_back(to);
            world_.materialNames.push_back(from.name);
        }
    }

    // ---- objects ------------------------------------------------------------------------------------------

    void makeObjects() {
        for (const scene::Object& object : description_.objects) {
            world_.objectNames.push_back(object.name);
            world_.objectFromWorld.push_back(object.worldFromObject.inverse());
            // White and matt; for objects that name no material and whose file has none either.
            if (!object.material && !defaultMaterial_) {
                defaultMaterial_ = static_cast<geometry::MaterialId>(world_.materials.size());
                material::Material matt;
                matt.diffuse = numeric::LinearRgb::grey(1);
                world_.materials.push_back(matt);
                world_.materialNames.push_back("default");
            }
        }
        std::vector<std::size_t>
            waiting; // objects whose loaders may work at the same time, last first
        for (std::size_t i = description_.objects.size(); i-- > 0;)
            if (loadsConcurrently(description_.objects[i])) waiting.push_back(i);
        const int threads = options_.threads == 0 ? parallel::availableThreads() : options_.threads;
        // Threads that were there before the sandbox are not held to it.
        if (waiting.size() < 2 || threads < 2 || scene::readingIsConfined()) waiting.clear();
        std::deque<Loaded> loaded;
        for (std::size_t i = 0; i < description_.objects.size(); ++i) {
            if (loaded.empty() && !waiting.empty() && waiting.back() == i)
                loaded = loadTogether(waiting, threads);
            if (!loaded.empty() && loaded.front().object == i) {
                diagnostics_.add(loaded.front().diagnostics);
                if (const auto why =
                        world::append(world_, std::move(loaded.front().world),
                                      loaded.front().sharedMaterials, options_.limits.primitives))
                    diagnostics_.error(kTooManyPrimitives, description_.objects[i].location, *why);
                loaded.pop_front();
            } else {
                ObjectLowering(*this, description_.objects[i], {world_, diagnostics_}, nullptr)
                    .run(static_cast<geometry::ObjectId>(i));
            }
        }
    }

    bool loadsConcurrently(const scene::Object& object) {
        if (!object.loader) return false;
        const rt_module* module = catalog_.open(object.loader->type).module;
        return module != nullptr && module->loader != nullptr &&
               RT_HAS(module->loader, rt_loader, traits) &&
               (module->loader->traits & RT_LOADS_CONCURRENTLY) != 0;
    }

    /// An object in a world of its own, to be appended in its turn.
    struct Loaded {
        std::size_t object;
        world::World world;
        scene::Diagnostics diagnostics;
        std::size_t sharedMaterials; // that the world had from the start
    };

    /// Takes objects from the end of `waiting`: as many as keep the threads busy, and not all at once, since each is held twice
    /// while it is appended.
    std::deque<Loaded> loadTogether(std::vector<std::size_t>& waiting, int threads) {
        constexpr std::size_t kPerThread = 4;
        std::deque<Loaded> loaded;
        while (!waiting.empty() && loaded.size() < kPerThread * static_cast<std::size_t>(threads)) {
            Loaded& one = loaded.emplace_back();
            one.object = waiting.back(), waiting.pop_back();
            one.world.materials = world_.materials;
            one.world.materialNames = world_.materialNames;
            one.sharedMaterials = world_.materials.size();
        }
        // Plugins are called by one thread at a time, but for the loaders at work.
        parallel::forEach(loaded.size(), threads, [&](std::size_t k) {
            std::unique_lock<std::mutex> lock(setup_);
            ObjectLowering(*this, description_.objects[loaded[k].object],
                           {loaded[k].world, loaded[k].diagnostics}, &lock)
                .run(static_cast<geometry::ObjectId>(loaded[k].object));
        });
        return loaded;
    }

    friend class ObjectLowering;
    enum class Progress { waiting, begun, done };

    const scene::Description& description_;
    Catalog& catalog_;
    scene::Diagnostics& diagnostics_;
    const LowerOptions options_;
    world::World world_;
    std::vector<const rt_texture*> textures_; // by index in the description
    std::vector<Progress> progress_;
    std::map<std::string, const material::Texture*> images_; // by path
    std::optional<geometry::MaterialId> defaultMaterial_;
    std::mutex setup_;
};

void ObjectLowering::run(geometry::ObjectId id) {
    using Files = Lowering::Files;
    const rt_module* module = scene_.moduleOf(scene::TypeKind::shape, object_.shape.type,
                                              object_.shape.location, to_.diagnostics);
    if (module == nullptr) return;
    const std::span rows(module->shape->params, module->shape->param_count);
    if (scene_.checkFiles(rows, object_.shape.values, scene_.options_.allowMissing,
                          "object " + inQuotes(object_.name) + " is left out",
                          to_.diagnostics) != Files::present)
        return;
    Call call = callFor("shape", object_.shape, rows, kMeshFile, kPluginFailed,
                        scene_.options_.limits, to_.diagnostics);
    call.lowering = this;
    call.host.load = &load;
    const auto& back = scene_.world_.objectFromWorld[static_cast<std::size_t>(id)];
    if (!numeric::isFinite(back.translation) || !numeric::isFinite(back.linear[0]) ||
        !numeric::isFinite(back.linear[1]) || !numeric::isFinite(back.linear[2]))
        return call.refuse(kValueRefused, "its transform flattens it to nothing");
    Sink::Target target;
    target.world = &to_.world;
    target.object = id;
    target.fileMaterials = !object_.material;
    target.material =
        object_.material ? geometry::MaterialId{*object_.material} : *scene_.defaultMaterial_;
    target.maxPrimitives = scene_.options_.limits.primitives;
    target.worldFromObject = object_.worldFromObject;
    target.imageTexture = [this](Call& asking, const char* path) {
        const bool loading = setupLock_ != nullptr && !setupLock_->owns_lock();
        if (loading) setupLock_->lock();
        const auto* texture = scene_.imageTexture(asking, path, refusedImages_);
        if (loading) setupLock_->unlock();
        return texture;
    };
    Sink sink(std::move(target), call);
    sink_ = &sink;
    const ValueArray values(rows, object_.shape.values, scene_.textures_);
    const std::uint32_t before = to_.world.primitives.count();
    if (plugin_host::run(
            call, [&] { return module->shape->lower(&call.host, values.data(), sink.table()); }) &&
        to_.world.primitives.count() == before)
        to_.diagnostics.warning(object_.location,
                                "object " + inQuotes(object_.name) + " has no geometry");
}

rt_status ObjectLowering::load(const rt_host* host, std::int32_t file, std::uint32_t kind,
                               rt_sink* sink) {
    Call& call = callOf(host);
    try {
        return call.lowering->loadFile(call, file, kind, sink);
    } catch (const std::bad_alloc&) {
        return RT_OUT_OF_MEMORY;
    }
}

rt_status ObjectLowering::loadFile(Call& shapeCall, std::int32_t file, std::uint32_t kind,
                                   rt_sink* table) {
    const auto refuse = [&](const char* why) {
        return shapeCall.refuse(kPluginFailed, why), RT_FAILED;
    };
    if (file < 0 || static_cast<std::size_t>(file) >= shapeCall.rows.size() ||
        (shapeCall.rows[static_cast<std::size_t>(file)].flags & RT_LOADS) == 0)
        return refuse("it asked to load a parameter that is no file to load");
    if (kind != RT_SURFACE && kind != RT_SOLID)
        return refuse("it asked to load a file as neither surface nor solid");
    const scene::Value& path = (*shapeCall.values)[static_cast<std::size_t>(file)];
    if (pathOf(path).empty() || !object_.loader || table != sink_->table())
        return refuse("it asked to load a file that is absent");
    const scene::Instance& instance = *object_.loader;
    const rt_module* module =
        scene_.moduleOf(scene::TypeKind::loader, instance.type, instance.location, to_.diagnostics);
    if (module == nullptr) return shapeCall.failed = true, RT_FAILED;
    const std::span rows(module->loader->params, module->loader->param_count);
    Call call = callFor("loader", instance, rows, kMeshFile, kMeshFile, scene_.options_.limits,
                        to_.diagnostics);
    call.location = path.location;
    if (scene_.checkFiles(rows, instance.values, false, "", to_.diagnostics) !=
        Lowering::Files::present)
        return shapeCall.failed = true, RT_FAILED;
    const ValueArray values(rows, instance.values, scene_.textures_);
    Call* const before = sink_->answerTo(&call);
    if (setupLock_ != nullptr) setupLock_->unlock();
    const bool done = plugin_host::run(call, [&] {
        return module->loader->load(&call.host, pathOf(path).c_str(), kind, values.data(), table);
    });
    if (setupLock_ != nullptr) setupLock_->lock();
    sink_->answerTo(before);
    if (!done) shapeCall.failed = true;
    return done ? RT_OK : RT_FAILED;
}

std::optional<world::World> lower(const scene::Description& description, Catalog& catalog,
                                  scene::Diagnostics& diagnostics, const LowerOptions& options) {
    std::optional<world::World> world;
    if (!runConfined(catalog.folders(),
                     [&] { world = Lowering(description, catalog, diagnostics, options).run(); }))
        diagnostics.error(kNotConfined, {}, kNeedsLandlock);
    return world;
}

} // namespace rt::plugin_host
