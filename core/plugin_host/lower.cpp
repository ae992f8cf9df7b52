#include <core/plugin_host/lower.hpp>

#include <core/plugin_host/call.hpp>
#include <core/plugin_host/confined.hpp>
#include <core/plugin_host/fault_report.hpp>
#include <core/plugin_host/sink.hpp>
#include <core/plugin_host/values.hpp>
#include <core/scene/input_file.hpp>
#include <core/scene/validate.hpp>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <new>

namespace rt::plugin_host {
namespace {

namespace fs = std::filesystem;

constexpr scene::Code kNotConfined{409};

std::string inQuotes(const std::string& text) { return "'" + text + "'"; }

/// Why `path` is no readable regular file of at most `maxBytes`, with the code that says so; nothing if it is one.
std::optional<std::pair<scene::Code, std::string>> whyUnreadable(const std::string& path,
                                                                 std::uint64_t maxBytes) {
    const auto file = scene::InputFile::open(path);
    if (const auto* refusal = std::get_if<scene::FileRefusal>(&file))
        return std::pair(refusal->code, inQuotes(path) + ": " + refusal->reason);
    if (std::get<scene::InputFile>(file).size() > maxBytes)
        return std::pair(kFileTooLarge, inQuotes(path) + ": is larger than " +
                                            std::to_string(maxBytes) +
                                            " bytes, the limit of input files");
    return {};
}

/// "did you mean 'dragon.obj'?", from the files beside a missing one.
std::string suggestionFor(const fs::path& missing) {
    constexpr std::size_t kMostNames = 10000; // a folder with more is not worth the wait
    const auto names = scene::namesIn(missing.parent_path().string(), kMostNames);
    const std::string name = scene::nearest(missing.filename().string(), names);
    return name.empty() ? "" : "did you mean " + inQuotes(name) + "?";
}

} // namespace

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
            for (std::size_t i = 0; i < description_.objects.size(); ++i)
                makeObject(static_cast<geometry::ObjectId>(i), description_.objects[i]);
        } catch (const std::bad_alloc&) {
            diagnostics_.error(kNoMemory, {}, "there is not enough memory for the scene");
        }
        if (diagnostics_.errorCount() != errorsBefore) return {};
        return std::move(world_);
    }

private:
    enum class Files { present, missing, refused };

    // ---- what a plugin may ask of its host ----------------------------------------------------------------

    static Call& callOf(const rt_host* host) {
        return *reinterpret_cast<Call*>(
            const_cast<rt_host*>(host)); // each call is made as a non-const Call
    }

    static rt_status fail(const rt_host* host, std::int32_t parameter, const char* message) {
        Call& call = callOf(host);
        const std::string why = message != nullptr ? message : "it gave no reason";
        if (parameter >= 0 && static_cast<std::size_t>(parameter) < call.rows.size()) {
            const auto i = static_cast<std::size_t>(parameter);
            call.diagnostics->error(call.rows[i].type == RT_FILE ? call.fileCode : kValueRefused,
                                    (*call.values)[i].location,
                                    call.subject + ", " + call.rows[i].name + ": " + why);
            call.failed = true;
        } else {
            call.refuse(call.otherCode, why);
        }
        return RT_FAILED;
    }

    static rt_status exceeds(const rt_host* host, std::int32_t parameter, const char* message) {
        Call& call = callOf(host);
        const auto i = static_cast<std::size_t>(parameter);
        const bool named = parameter >= 0 && i < call.rows.size();
        call.diagnostics->error(kPluginLimit, named ? (*call.values)[i].location : call.location,
                                call.subject +
                                    (named ? std::string(", ") + call.rows[i].name : "") + ": " +
                                    (message != nullptr ? message : "it gave no reason"));
        call.failed = true;
        return RT_FAILED;
    }

    static void note(const rt_host* host, const char* message) {
        Call& call = callOf(host);
        call.diagnostics->note(call.location, call.subject + ": " + message);
    }

    static rt_status load(const rt_host* host, std::int32_t file, std::uint32_t kind,
                          rt_sink* sink) {
        Call& call = callOf(host);
        try {
            return call.lowering->loadFile(call, file, kind, sink);
        } catch (const std::bad_alloc&) {
            return RT_OUT_OF_MEMORY;
        }
    }

    // ---- calls --------------------------------------------------------------------------------------------

    Call callFor(const char* kind, const scene::Instance& instance, std::span<const rt_param> rows,
                 scene::Code fileCode, scene::Code otherCode) {
        Call call{};
        call.host.struct_size = sizeof(rt_host);
        call.host.abi_minor = RT_ABI_MINOR;
        call.host.fail = &fail;
        call.host.note = &note;
        call.host.load = &load;
        call.host.max_texels = options_.limits.texturePixels;
        call.host.exceeds = &exceeds;
        call.lowering = this;
        call.diagnostics = &diagnostics_;
        call.subject = std::string(kind) + " " + inQuotes(instance.type);
        call.rows = rows;
        call.values = &instance.values;
        call.location = instance.location;
        call.fileCode = fileCode;
        call.otherCode = otherCode;
        return call;
    }

    /// Runs a plugin's function and sees to it that a failure has a reason. True: it succeeded.
    template <class Function> bool run(Call& call, Function&& function) {
        rt_status status = RT_FAILED;
        const RunningCall running(call);
        try {
            status = function();
        } catch (const std::exception& e) {
            call.refuse(kPluginThrew,
                        std::string("it threw an exception across the plugin boundary: ") +
                            e.what());
        } catch (...) {
            call.refuse(kPluginThrew, "it threw an exception across the plugin boundary");
        }
        if (call.failed) return false;
        if (status == RT_OUT_OF_MEMORY)
            call.refuse(kNoMemory, "there is not enough memory for it");
        else if (status != RT_OK)
            call.refuse(call.otherCode, "it failed and gave no reason");
        return !call.failed;
    }

    /// The module of a type that validation has accepted, or nothing with a diagnostic.
    const rt_module* moduleOf(scene::TypeKind kind, const std::string& type,
                              const scene::Location& location) {
        const auto found = catalog_.find(kind, type);
        if (const auto* refusal = std::get_if<scene::TypeRefusal>(&found)) {
            diagnostics_.error(kPluginType, location, refusal->reason);
            return nullptr;
        }
        return catalog_.open(type).module;
    }

    /// Looks at every file among the values before the plugin does.
    Files checkFiles(std::span<const rt_param> rows, const std::vector<scene::Value>& values,
                     bool mayMiss, const std::string& leftOut) {
        Files result = Files::present;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const std::string& path = rows[i].type == RT_FILE ? pathOf(values[i]) : std::string();
            if (path.empty()) continue;
            if (options_.files) options_.files->insert(path);
            const auto why = whyUnreadable(path, mostBytes());
            if (!why) continue;
            if (why->first == kNoSuchFile && mayMiss) {
                diagnostics_.warning(values[i].location, why->second + "; " + leftOut);
                if (result == Files::present) result = Files::missing;
            } else {
                diagnostics_.error(why->first, values[i].location, why->second,
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
                                               texture.instance.location)) {
            const rt_texture_type& type = *module->texture;
            std::vector<std::shared_ptr<const material::Texture>> needed;
            for (std::size_t k = 0; k < type.param_count; ++k)
                if (const auto* index = std::get_if<std::int64_t>(&texture.instance.values[k].data);
                    index != nullptr && type.params[k].type == RT_TEXTURE) {
                    makeTexture(static_cast<std::size_t>(*index));
                    needed.push_back(world_.textures[static_cast<std::size_t>(*index)]);
                }
            if (std::find(needed.begin(), needed.end(), nullptr) == needed.end()) {
                world_.textures[i] = createTexture(type, texture.instance, std::move(needed));
                textures_[i] = world_.textures[i].get();
            }
        }
        progress_[i] = Progress::done;
    }

    std::shared_ptr<const material::Texture>
    createTexture(const rt_texture_type& type, const scene::Instance& instance,
                  std::vector<std::shared_ptr<const material::Texture>> needed) {
        const std::span rows(type.params, type.param_count);
        if (checkFiles(rows, instance.values, false, "") != Files::present) return nullptr;
        Call call = callFor("texture", instance, rows, kImageFile, kPluginFailed);
        const ValueArray values(rows, instance.values, textures_);
        auto texture = std::make_unique<material::Texture>(material::Texture{&type, nullptr});
        if (!run(call, [&] { return type.create(&call.host, values.data(), &texture->state); }))
            return nullptr;
        // `needed` lives as long as the texture that evaluates it.
        return {texture.release(), [needed = std::move(needed)](const material::Texture* t) {
                    t->type->destroy(t->state);
                    delete t;
                }};
    }

    /// The image that a mesh's material file names, made once per file.
    const material::Texture* imageTexture(Call& call, const std::string& path) {
        if (const auto known = images_.find(path); known != images_.end()) return known->second;
        const material::Texture*& made = images_[path] = nullptr;
        if (options_.files) options_.files->insert(path);
        if (const auto why = whyUnreadable(path, mostBytes())) {
            if (why->first == kNoSuchFile && options_.allowMissing) {
                diagnostics_.warning(call.location, why->second + "; its material goes without it");
            } else {
                diagnostics_.error(why->first, call.location, call.subject + ": " + why->second,
                                   suggestionFor(path));
                call.failed = true;
            }
            return nullptr;
        }
        const rt_module* module = moduleOf(scene::TypeKind::texture, "image", call.location);
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
        auto texture = createTexture(*module->texture, instance, {});
        if (texture == nullptr) return call.failed = true, nullptr;
        world_.textures.push_back(std::move(texture));
        return made = world_.textures.back().get();
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

    /// White and matt; for objects that name no material and whose file has none either.
    geometry::MaterialId defaultMaterial() {
        if (!defaultMaterial_) {
            defaultMaterial_ =
                geometry::MaterialId{static_cast<std::uint32_t>(world_.materials.size())};
            material::Material matt;
            matt.diffuse = numeric::LinearRgb::grey(1);
            world_.materials.push_back(matt);
            world_.materialNames.push_back("default");
        }
        return *defaultMaterial_;
    }

    // ---- objects ------------------------------------------------------------------------------------------

    void makeObject(geometry::ObjectId id, const scene::Object& object) {
        world_.objectNames.push_back(object.name);
        world_.objectFromWorld.push_back(object.worldFromObject.inverse());
        const rt_module* module =
            moduleOf(scene::TypeKind::shape, object.shape.type, object.shape.location);
        if (module == nullptr) return;
        const std::span rows(module->shape->params, module->shape->param_count);
        if (checkFiles(rows, object.shape.values, options_.allowMissing,
                       "object " + inQuotes(object.name) + " is left out") != Files::present)
            return;
        Call call = callFor("shape", object.shape, rows, kMeshFile, kPluginFailed);
        call.object = &object;
        const auto back = world_.objectFromWorld.back();
        if (!numeric::isFinite(back.translation) || !numeric::isFinite(back.linear[0]) ||
            !numeric::isFinite(back.linear[1]) || !numeric::isFinite(back.linear[2]))
            return call.refuse(kValueRefused, "its transform flattens it to nothing");
        Sink::Target target;
        target.world = &world_;
        target.object = id;
        target.fileMaterials = !object.material;
        target.material =
            object.material ? geometry::MaterialId{*object.material} : defaultMaterial();
        target.worldFromObject = object.worldFromObject;
        target.maxPrimitives = options_.limits.primitives;
        target.imageTexture = [this](Call& asking, const char* path) {
            return imageTexture(asking, path);
        };
        Sink sink(std::move(target), call);
        sink_ = &sink;
        const ValueArray values(rows, object.shape.values, textures_);
        const std::uint32_t before = world_.primitives.count();
        if (run(call,
                [&] { return module->shape->lower(&call.host, values.data(), sink.table()); }) &&
            world_.primitives.count() == before)
            diagnostics_.warning(object.location,
                                 "object " + inQuotes(object.name) + " has no geometry");
        sink_ = nullptr;
    }

    rt_status loadFile(Call& shapeCall, std::int32_t file, std::uint32_t kind, rt_sink* table) {
        const scene::Object* object = shapeCall.object;
        const auto refuse = [&](const char* why) {
            return shapeCall.refuse(kPluginFailed, why), RT_FAILED;
        };
        if (object == nullptr) return refuse("only a shape may load files");
        if (file < 0 || static_cast<std::size_t>(file) >= shapeCall.rows.size() ||
            (shapeCall.rows[static_cast<std::size_t>(file)].flags & RT_LOADS) == 0)
            return refuse("it asked to load a parameter that is no file to load");
        if (kind != RT_SURFACE && kind != RT_SOLID)
            return refuse("it asked to load a file as neither surface nor solid");
        const scene::Value& path = (*shapeCall.values)[static_cast<std::size_t>(file)];
        if (pathOf(path).empty() || !object->loader || table != sink_->table())
            return refuse("it asked to load a file that is absent");
        const rt_module* module =
            moduleOf(scene::TypeKind::loader, object->loader->type, object->loader->location);
        if (module == nullptr) return shapeCall.failed = true, RT_FAILED;
        const std::span rows(module->loader->params, module->loader->param_count);
        Call call = callFor("loader", *object->loader, rows, kMeshFile, kMeshFile);
        call.location = path.location;
        if (checkFiles(rows, object->loader->values, false, "") != Files::present)
            return shapeCall.failed = true, RT_FAILED;
        const ValueArray values(rows, object->loader->values, textures_);
        Call* const before = sink_->answerTo(&call);
        const bool done = run(call, [&] {
            return module->loader->load(&call.host, pathOf(path).c_str(), kind, values.data(),
                                        table);
        });
        sink_->answerTo(before);
        if (!done) shapeCall.failed = true;
        return done ? RT_OK : RT_FAILED;
    }

    friend struct Call;
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
    Sink* sink_ = nullptr; // of the object that is being lowered
};

std::optional<world::World> lower(const scene::Description& description, Catalog& catalog,
                                  scene::Diagnostics& diagnostics, const LowerOptions& options) {
    std::optional<world::World> world;
    if (!runConfined(catalog.folders(),
                     [&] { world = Lowering(description, catalog, diagnostics, options).run(); }))
        diagnostics.error(
            kNotConfined, {},
            "--sandbox needs a kernel with Landlock (Linux 5.13), and this one has none");
    return world;
}

} // namespace rt::plugin_host
