#include <core/scene/load_failure.hpp>

#include <cerrno>
#include <cstring>
#include <new>

namespace rt::scene {

std::string loadFailure(const char* said, const std::string& readable) {
    if (said == nullptr) throw std::bad_alloc(); // no memory even for the words
    std::string words = said;
    if (words == "out of memory" || words.ends_with(std::strerror(ENOMEM)) ||
        words.ends_with("cannot create shared object descriptor") ||
        (!readable.empty() && words.starts_with(readable + ": cannot open shared object file")))
        throw std::bad_alloc();
    return words;
}

} // namespace rt::scene
