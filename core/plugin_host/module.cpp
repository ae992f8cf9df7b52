#include <core/plugin_host/module.hpp>

#include <core/plugin_host/fault_report.hpp>
#include <core/plugin_host/stamp.hpp>
#include <core/scene/load_failure.hpp>
#include <core/scene/validate.hpp>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <set>

namespace rt::plugin_host {
namespace {

namespace fs = std::filesystem;

class FileDescriptor {
public:
    explicit FileDescriptor(int fd) : fd_(fd) {}
    ~FileDescriptor() {
        if (fd_ >= 0) close(fd_);
    }
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    int get() const { return fd_; }

private:
    int fd_;
};

bool isInside(const fs::path& canonical, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), canonical.begin(), canonical.end()).first ==
           folder.end();
}

/// Root, whoever runs rt, and whoever owns the running program: those could change what rt does
/// anyway.
bool isTrustedOwner(uid_t owner) {
    if (owner == 0 || owner == geteuid()) return true;
    struct stat program {};
    return stat("/proc/self/exe", &program) == 0 && program.st_uid == owner;
}

/// Groups that users have to themselves are called like them and share their number, so a file that
/// such a group can write is as safe as its owner.
bool othersMayWrite(const struct stat& status) {
    if ((status.st_mode & S_IWOTH) != 0) return true;
    return (status.st_mode & S_IWGRP) != 0 && status.st_gid != 0 &&
           status.st_gid != status.st_uid && status.st_gid != getegid();
}

std::string whyUnsafe(int fd, const fs::path& folder) {
    struct stat status {};
    if (fstat(fd, &status) != 0) return "it cannot be read";
    if (!S_ISREG(status.st_mode)) return "it is not a regular file";
    if (!isTrustedOwner(status.st_uid))
        return "it belongs to another user (uid " + std::to_string(status.st_uid) + ")";
    if (othersMayWrite(status)) return "other users may write it; chmod go-w it";
    if (stat(folder.c_str(), &status) != 0) return "its folder cannot be read";
    if (!isTrustedOwner(status.st_uid))
        return "its folder belongs to another user (uid " + std::to_string(status.st_uid) + ")";
    if (othersMayWrite(status) && (status.st_mode & S_ISVTX) == 0)
        return "other users may write its folder; chmod go-w " + folder.string();
    return {};
}

bool isSnakeCase(std::string_view name) {
    return !name.empty() && name[0] >= 'a' && name[0] <= 'z' &&
           std::all_of(name.begin(), name.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
           });
}

bool hasRows(std::uint32_t count, const rt_param* rows) { return count == 0 || rows != nullptr; }

/// What only the opened module can tell.
std::string whyUnusable(const rt_module& module, std::string_view stem) {
    if (module.name == nullptr || module.version == nullptr || module.doc == nullptr ||
        module.example == nullptr)
        return "it does not say its name, version, doc and example";
    if (module.name != stem)
        return "its file name says '" + std::string(stem) + "' and it calls itself '" +
               module.name + "'";
    if ((module.shape != nullptr) + (module.texture != nullptr) + (module.loader != nullptr) != 1)
        return "it must offer exactly one of a shape, a texture and a loader";
    constexpr const char* incomplete = "its rt_plugin_entry is incomplete";
    if (const rt_shape* shape = module.shape) {
        if (!RT_HAS(shape, rt_shape, lower) || !hasRows(shape->param_count, shape->params) ||
            shape->lower == nullptr)
            return incomplete;
        return whyRowsAreWrong(shape->params, shape->param_count, true);
    }
    if (const rt_texture_type* texture = module.texture) {
        if (!RT_HAS(texture, rt_texture_type, resolution) ||
            !hasRows(texture->param_count, texture->params) || texture->create == nullptr ||
            texture->evaluate == nullptr || texture->destroy == nullptr)
            return incomplete;
        return whyRowsAreWrong(texture->params, texture->param_count, false);
    }
    const rt_loader* loader = module.loader;
    if (!RT_HAS(loader, rt_loader, repair) || !hasRows(loader->param_count, loader->params) ||
        loader->load == nullptr || loader->extensions == nullptr)
        return incomplete;
    return whyRowsAreWrong(loader->params, loader->param_count, false);
}

void nameCalls(const rt_module& module) {
    if (module.shape != nullptr) nameCall(module.shape->lower, "lower");
    if (module.loader != nullptr) {
        nameCall(module.loader->load, "load");
        nameCall(module.loader->repair, "repair");
    }
    if (module.texture == nullptr) return;
    nameCall(module.texture->create, "create");
    nameCall(module.texture->evaluate, "evaluate");
    nameCall(module.texture->destroy, "destroy");
}

} // namespace

bool isTypeName(std::string_view name) { return name.size() <= 64 && isSnakeCase(name); }

std::string_view stemOf(std::string_view fileName) {
    return fileName.ends_with(kModuleSuffix)
               ? fileName.substr(0, fileName.size() - kModuleSuffix.size())
               : std::string_view();
}

std::string whyRowsAreWrong(const rt_param* rows, std::uint32_t count, bool mayLoad) {
    constexpr std::uint32_t kMostRows = 1000; // beyond any plugin, far below what would cost time
    if (count > kMostRows) return "it claims to have " + std::to_string(count) + " parameters";
    std::set<std::string_view> names;
    for (std::uint32_t i = 0; i < count; ++i) {
        const rt_param& row = rows[i];
        if (row.name == nullptr || !isSnakeCase(row.name))
            return "the name of its parameter " + std::to_string(i + 1) + " is not snake_case";
        const std::string which = std::string("its parameter '") + row.name + "'";
        if (!names.insert(row.name).second) return which + " exists twice";
        if (row.type < RT_BOOL || row.type > RT_INTEGER_LISTS)
            return which + " has an unknown type";
        if (row.unit > RT_UNIT_LINEAR_RGB) return which + " has an unknown unit";
        if (row.doc == nullptr) return which + " has no doc";
        if (!(row.min <= row.max)) return which + " has limits that no number meets"; // a NaN too
        if ((row.type == RT_CHOICE) != (row.choices != nullptr))
            return which + " has choices without being a choice, or none";
        if ((row.flags & RT_LOADS) != 0 && (row.type != RT_FILE || !mayLoad))
            return which + " cannot be loaded";
        if (row.fallback == nullptr) continue;
        const auto value = scene::defaultValue(row);
        if (const auto* why = std::get_if<std::string>(&value))
            return which + " has a default that " + *why;
    }
    return {};
}

std::variant<const rt_module*, std::string> openModule(const fs::path& path,
                                                       const std::vector<fs::path>& trusted) {
    const std::string fileName = path.filename().string();
    const std::string_view stem = stemOf(fileName);
    if (!isTypeName(stem)) return "the name of a type is [a-z][a-z0-9_]*, at most 64 characters";

    std::error_code error;
    const fs::path real = fs::canonical(path, error);
    if (error == std::errc::not_enough_memory) throw std::bad_alloc(); // of no fault of the module
    if (error) return "it cannot be read (" + error.message() + ")";
    if (std::none_of(trusted.begin(), trusted.end(),
                     [&](const fs::path& folder) { return isInside(real, folder); }))
        return "it is a link that leaves the plugin folders, to " + real.string();
    const FileDescriptor file(open(real.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
    if (file.get() < 0) return std::string("it cannot be read (") + std::strerror(errno) + ")";
    if (std::string why = whyUnsafe(file.get(), real.parent_path()); !why.empty()) return why;

    const auto stamp = readStamp(file.get());
    if (const auto* why = std::get_if<std::string>(&stamp)) return *why;
    if (std::string why = whyIncompatible(std::get<Stamp>(stamp)); !why.empty()) return why;

    // RTLD_NOW: a missing symbol fails here by name, not in the middle of a frame. RTLD_LOCAL:
    // plugins never see each other.
    void* library = dlopen(real.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
        return "it cannot be opened (" + scene::loadFailure(dlerror(), real.string()) + ")";
    std::string why;
    const auto* module = static_cast<const rt_module*>(dlsym(library, "rt_plugin_entry"));
    Dl_info info{};
    if (module == nullptr || dladdr(module, &info) == 0 || info.dli_fname == nullptr ||
        !fs::equivalent(info.dli_fname, real, error))
        why = "it borrows rt_plugin_entry from another library instead of defining it";
    else
        why = whyUnusable(*module, stem);
    if (!why.empty()) {
        dlclose(library); // `why` holds copies: the module's text goes away here
        return why;
    }
    nameCalls(*module);
    return module; // its callbacks stay valid for ever
}

} // namespace rt::plugin_host
