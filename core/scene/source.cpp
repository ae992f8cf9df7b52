#include <core/scene/source.hpp>

#include <core/scene/input_file.hpp>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <unistd.h>

namespace rt::scene {
namespace {

constexpr Code kNotReadable{402}, kTooLarge{710};

} // namespace

std::shared_ptr<const Source> readSource(const std::string& path, std::uint64_t maxBytes,
                                         Diagnostics& diagnostics, const Location& namedAt) {
    auto source = std::make_shared<Source>(Source{path, {}});
    const auto refuse = [&](Code code, const std::string& reason) {
        if (namedAt.source)
            diagnostics.error(code, namedAt, quoted(path) + ": " + reason);
        else
            diagnostics.error(code, {source}, reason);
        return nullptr;
    };
    const auto opened = InputFile::open(path);
    if (const auto* refusal = std::get_if<FileRefusal>(&opened))
        return refuse(refusal->code, refusal->reason);
    const auto& file = std::get<InputFile>(opened);
    if (file.size() > maxBytes) return refuse(kTooLarge, tooLarge(maxBytes));

    std::string& text = source->text;
    std::size_t size = 0;
    for (;;) { // files of /proc say that they are empty; files may grow
        text.resize(std::max(size + 65536, static_cast<std::size_t>(file.size()) + 1));
        const ssize_t got = ::read(file.fd(), text.data() + size, text.size() - size);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0)
            return refuse(kNotReadable,
                          "cannot be read: " + std::generic_category().message(errno));
        size += static_cast<std::size_t>(got);
        if (size > maxBytes) return refuse(kTooLarge, tooLarge(maxBytes));
        if (got == 0) break;
    }
    text.resize(size);
    return source;
}

} // namespace rt::scene
