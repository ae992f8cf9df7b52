#include <formats/window.hpp>

#include <dlfcn.h>
#include <filesystem>

namespace rt::formats {

const rt_window_module& windowModule() {
    static const rt_window_module& module = []() -> const rt_window_module& {
        const auto path =
            std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() /
            "lib/rt/rt_window.so";
        void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        if (!handle)
            throw std::runtime_error(std::string("the window module cannot be opened: ") +
                                     dlerror());
        const auto* table = static_cast<const rt_window_module*>(dlsym(handle, "rt_window_entry"));
        if (!table || table->version != RT_WINDOW_MODULE_VERSION ||
            table->struct_size != sizeof *table)
            throw std::runtime_error("the window module " + path.string() +
                                     " belongs to another build of rt");
        return *table;
    }();
    return module;
}

Window::Window(const std::string& title, std::uint32_t width, std::uint32_t height)
    : module_(windowModule()) {
    char error[512] = {};
    if (!module_.probe(error, sizeof error)) throw NoDisplay(error);
    if (!module_.open(title.c_str(), width, height, error, sizeof error))
        throw std::runtime_error(error);
}

Window::~Window() { module_.close(); }

void Window::show(const std::uint8_t* rgb, std::uint32_t width, std::uint32_t height) {
    module_.show(rgb, width, height);
}

std::optional<std::vector<rt_window_event>> Window::poll(int milliseconds) {
    std::vector<rt_window_event> events(256);
    const int count =
        module_.poll(events.data(), static_cast<std::uint32_t>(events.size()), milliseconds);
    if (count < 0) return std::nullopt;
    events.resize(static_cast<std::size_t>(count));
    return events;
}

} // namespace rt::formats
