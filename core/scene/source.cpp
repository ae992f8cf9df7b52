#include <core/scene/source.hpp>

#include <core/scene/input_file.hpp>

namespace rt::scene {

std::shared_ptr<const Source> readSource(const std::string& path, std::uint64_t maxBytes,
                                         Diagnostics& diagnostics, const Location& namedAt,
                                         const std::string& ifTooLarge) {
    auto source = std::make_shared<Source>(Source{path, {}});
    const auto refuse = [&](Code code, const std::string& reason) {
        const std::string suggestion = code == kTooLarge ? ifTooLarge : "";
        if (namedAt.source)
            diagnostics.error(code, namedAt, quoted(path) + ": " + reason, suggestion);
        else
            diagnostics.error(code, {source}, reason, suggestion);
        return nullptr;
    };
    const auto opened = InputFile::open(path);
    if (const auto* refusal = std::get_if<FileRefusal>(&opened))
        return refuse(refusal->code, refusal->reason);
    auto text = std::get<InputFile>(opened).read(maxBytes);
    if (const auto* refusal = std::get_if<FileRefusal>(&text))
        return refuse(refusal->code, refusal->reason);
    source->text = std::move(std::get<std::string>(text));
    return source;
}

} // namespace rt::scene
