// What validation asks about plugin types. core/plugin_host answers, opening a module the first time its type is named.
#pragma once
#include <rt/plugin.h>

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rt::scene {

enum class TypeKind : std::uint8_t { shape, texture, loader };

struct TypeRows {
    std::string_view name;
    std::span<const rt_param> rows;
};

/// Why a type cannot be used: no such module, or one that was refused and for what reason. A full sentence.
struct TypeRefusal {
    std::string reason;
};

class TypeCatalog {
public:
    virtual ~TypeCatalog() = default;
    virtual std::variant<TypeRows, TypeRefusal> find(TypeKind kind, std::string_view name) = 0;
    /// Names of all modules on the search path, by file name, without opening any.
    virtual std::vector<std::string> names(TypeKind kind) = 0;
    /// The loader for a file suffix ("obj" -> "openmesh"), or "".
    virtual std::string loaderFor(std::string_view lowerCaseSuffix) = 0;
};

} // namespace rt::scene
