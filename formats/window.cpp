#include <formats/window.hpp>

#include <formats/module_file.hpp>

namespace rt::formats {

const rt_window_module& windowModule() {
    static const rt_window_module& module = []() -> const rt_window_module& {
        constexpr const char *kFile = "rt_window.so", *kWhat = "the window module";
        const auto* table =
            static_cast<const rt_window_module*>(openModule(kFile, "rt_window_entry", kWhat));
        if (table->version != RT_WINDOW_MODULE_VERSION || table->struct_size != sizeof *table)
            refuseForeignModule(kFile, kWhat);
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
