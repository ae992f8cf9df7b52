#include "ply.hpp"

#include "text_cursor.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>

namespace rt::loaders {
namespace {

enum class Type : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
constexpr std::uint32_t kBytes[] = {1, 1, 2, 2, 4, 4, 4, 8};

std::optional<Type> typeNamed(std::string_view name) {
    static constexpr std::string_view kNames[][2] = {
        {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
        {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
    for (std::size_t i = 0; i < std::size(kNames); ++i)
        if (name == kNames[i][0] || name == kNames[i][1]) return static_cast<Type>(i);
    return std::nullopt;
}

bool isInteger(Type t) { return t < Type::float32; }

struct Property {
    std::string name;
    Type type = Type::float32;
    std::optional<Type> countType; // of a list
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;

    std::optional<std::size_t> find(std::initializer_list<std::string_view> names,
                                    bool list) const {
        for (const std::string_view wanted : names)
            for (std::size_t i = 0; i < properties.size(); ++i)
                if (properties[i].name == wanted && properties[i].countType.has_value() == list)
                    return i;
        return std::nullopt;
    }
};

enum class Format : std::uint8_t { ascii, little, big };

struct Header {
    Format format = Format::ascii;
    std::vector<Element> elements;
    std::size_t size = 0; // bytes up to the data
};

/// The header's lines, which the data follow in the same bytes.
class HeaderReader {
public:
    HeaderReader(const std::string& name, std::string_view bytes) : name_(name), bytes_(bytes) {}

    Header read() {
        if (nextLine() != "ply") fail("does not begin with 'ply'");
        Header header;
        bool formatKnown = false;
        for (;;) {
            if (at_ >= bytes_.size()) fail("the header has no end_header");
            words(nextLine());
            if (words_.empty() || words_[0] == "comment" || words_[0] == "obj_info") continue;
            if (words_[0] == "end_header") break;
            if (words_[0] == "format") {
                if (words_.size() < 2) fail("'format' names no format");
                if (words_[1] == "ascii")
                    header.format = Format::ascii;
                else if (words_[1] == "binary_little_endian")
                    header.format = Format::little;
                else if (words_[1] == "binary_big_endian")
                    header.format = Format::big;
                else
                    fail("unknown format " + quoted(words_[1]));
                formatKnown = true;
            } else if (words_[0] == "element") {
                Element& e = header.elements.emplace_back();
                if (words_.size() != 3) fail("an element has a name and a count");
                e.name = words_[1];
                const auto [stop, error] =
                    std::from_chars(words_[2].data(), words_[2].data() + words_[2].size(), e.count);
                if (error != std::errc() || stop != words_[2].data() + words_[2].size())
                    fail("the count of element " + quoted(e.name) +
                         " is not a number: " + quoted(words_[2]));
            } else if (words_[0] == "property") {
                if (header.elements.empty()) fail("a property belongs to no element");
                header.elements.back().properties.push_back(property());
            } else {
                fail("unknown header line " + quoted(words_[0]));
            }
        }
        if (!formatKnown) fail("the header names no format");
        header.size = at_;
        return header;
    }

private:
    Property property() {
        const bool list = words_.size() > 1 && words_[1] == "list";
        if (words_.size() != (list ? 5u : 3u)) fail("a property has a type and a name");
        Property p;
        p.name = words_.back();
        const auto type = [&](std::string_view name) {
            const auto t = typeNamed(name);
            if (!t) fail("unknown type " + quoted(name));
            return *t;
        };
        p.type = type(words_[list ? 3 : 1]);
        if (list) {
            p.countType = type(words_[2]);
            if (!isInteger(*p.countType)) fail("the length of a list is an integer");
        }
        return p;
    }

    std::string_view nextLine() {
        ++line_;
        const std::size_t from = at_;
        // A header is short; do not search a large binary file for the end of a line.
        constexpr std::size_t kLongestLine = 1 << 16;
        while (at_ < bytes_.size() && !isLineEnd(bytes_[at_]) && at_ - from < kLongestLine) ++at_;
        const std::string_view line = bytes_.substr(from, at_ - from);
        if (at_ < bytes_.size() && bytes_[at_] != '\n' && bytes_[at_] != '\r')
            fail("is not a PLY header");
        if (at_ + 1 < bytes_.size() && bytes_[at_] == '\r' && bytes_[at_ + 1] == '\n' && crlf_)
            ++at_;
        else if (line_ == 1 && at_ + 1 < bytes_.size() && bytes_[at_] == '\r' &&
                 bytes_[at_ + 1] == '\n')
            crlf_ = true, ++at_;
        if (at_ < bytes_.size()) ++at_;
        return line;
    }

    void words(std::string_view line) {
        words_.clear();
        for (std::size_t i = 0; i < line.size();) {
            while (i < line.size() && isBlank(line[i])) ++i;
            const std::size_t from = i;
            while (i < line.size() && !isBlank(line[i])) ++i;
            if (i != from) words_.push_back(line.substr(from, i - from));
        }
    }

    [[noreturn]] void fail(const std::string& why) const {
        throw FileError(name_ + ":" + std::to_string(std::max(line_, 1)) + ":1: " + why);
    }

    const std::string& name_;
    std::string_view bytes_;
    std::size_t at_ = 0;
    int line_ = 0;
    bool crlf_ = false;
    std::vector<std::string_view> words_;
};

/// Numbers of a binary file.
class BinarySource {
public:
    BinarySource(std::string name, std::string_view bytes, bool swap)
        : name_(std::move(name)), at_(bytes.data()), end_(bytes.data() + bytes.size()),
          swap_(swap) {}

    std::uint64_t remaining() const { return static_cast<std::uint64_t>(end_ - at_); }
    std::uint64_t leastBytes(Type t) const { return kBytes[static_cast<std::size_t>(t)]; }

    double number(Type t) {
        switch (t) {
        case Type::int8:
            return take<std::int8_t>();
        case Type::uint8:
            return take<std::uint8_t>();
        case Type::int16:
            return take<std::int16_t>();
        case Type::uint16:
            return take<std::uint16_t>();
        case Type::int32:
            return take<std::int32_t>();
        case Type::uint32:
            return take<std::uint32_t>();
        case Type::float32:
            return static_cast<double>(take<float>());
        case Type::float64:
            return take<double>();
        }
        return 0;
    }
    void skip(Type t, std::uint64_t count) {
        if (count > remaining() / leastBytes(t)) cutShort();
        at_ += count * leastBytes(t);
    }
    void place(const Element& element, std::uint64_t record) {
        element_ = &element, record_ = record;
    }
    [[noreturn]] void fail(const std::string& why) const {
        throw FileError(name_ + ": " + element_->name + " " + std::to_string(record_) + ": " + why);
    }

private:
    [[noreturn]] void cutShort() const { fail("the file ends in the middle of it"); }

    template <class T> T take() {
        if (remaining() < sizeof(T)) cutShort();
        std::array<char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), at_, sizeof(T));
        at_ += sizeof(T);
        if (swap_) std::reverse(bytes.begin(), bytes.end());
        return std::bit_cast<T>(bytes);
    }

    std::string name_;
    const char *at_, *end_;
    bool swap_;
    const Element* element_ = nullptr;
    std::uint64_t record_ = 0;
};

/// Numbers of an ASCII file, separated by blanks and line ends.
class TextSource {
public:
    TextSource(const std::string& name, std::string text, std::size_t headerSize)
        : text_(name, std::move(text), false), end_(text_.at + text_.size()) {
        text_.at += headerSize;
    }

    std::uint64_t remaining() const { return static_cast<std::uint64_t>(end_ - text_.at) + 1; }
    std::uint64_t leastBytes(Type) const { return 2; } // a digit and what separates it

    double number(Type t) {
        toNumber();
        from_ = text_.at;
        const double value = text_.anyReal("the value");
        if (isInteger(t) && !(value == std::floor(value) && std::fabs(value) < 4294967296.0))
            text_.fail(from_, "is not an integer: " + word());
        return value;
    }
    void skip(Type t, std::uint64_t count) {
        for (; count != 0; --count) number(t);
    }
    void place(const Element&, std::uint64_t) {}
    [[noreturn]] void fail(const std::string& why) const {
        text_.fail(from_ ? from_ : text_.at, why);
    }

private:
    void toNumber() {
        while (isBlank(*text_.at) || *text_.at == '\n' || *text_.at == '\r') ++text_.at;
        if (text_.atEnd()) text_.fail("the file ends before the last element its header announces");
    }
    std::string word() const { return quoted({from_, static_cast<std::size_t>(text_.at - from_)}); }

    TextCursor text_;
    const char* end_;
    const char* from_ = nullptr;
};

template <class Source> class BodyReader {
public:
    BodyReader(MeshFile& mesh, const Header& header, Source& source)
        : mesh_(mesh), header_(header), source_(source) {}

    void read() {
        for (const Element& e : header_.elements)
            if (e.name == "vertex") {
                if (vertices_ != 0)
                    source_.place(e, 0), source_.fail("there are two elements 'vertex'");
                vertices_ = e.count;
            }
        for (const Element& e : header_.elements) {
            source_.place(e, 0);
            checkClaim(e);
            if (e.name == "vertex")
                vertices(e);
            else if (e.name == "face")
                faces(e);
            else if (e.name == "tristrips")
                strips(e);
            else
                skip(e);
        }
        if (mesh_.faceCount() == 0)
            throw FileError(std::string(fileName(mesh_.path)) + ": holds no face");
        for (auto* list : {&mesh_.cornerUv, &mesh_.cornerNormal})
            if (!list->empty()) list->resize(mesh_.cornerPosition.size(), kNone);
    }

private:
    /// Could the rest of the file hold what the header claims? Asked before memory is taken for it.
    void checkClaim(const Element& e) {
        std::uint64_t least = 0;
        for (const Property& p : e.properties)
            least += source_.leastBytes(p.countType.value_or(p.type));
        if (least != 0 && e.count > source_.remaining() / least)
            source_.fail("the header announces " + std::to_string(e.count) +
                         " of them, more than the file can hold");
        if (e.count >= kNone) source_.fail("the header announces more than 2^32 - 2 of them");
    }

    std::uint64_t listLength(const Property& p) {
        const double n = source_.number(*p.countType);
        if (n < 0) source_.fail("a list has a negative length");
        const auto length = static_cast<std::uint64_t>(n);
        if (length > source_.remaining() / source_.leastBytes(p.type))
            source_.fail("a list has more entries than the file can hold");
        return length;
    }

    void skipProperty(const Property& p) { source_.skip(p.type, p.countType ? listLength(p) : 1); }

    void skip(const Element& e) {
        if (e.properties.empty()) return;
        for (std::uint64_t i = 0; i < e.count; ++i) {
            source_.place(e, i);
            for (const Property& p : e.properties) skipProperty(p);
        }
        if (e.count != 0)
            mesh_.notes.push_back(std::string(fileName(mesh_.path)) + ": " +
                                  std::to_string(e.count) + " elements " + quoted(e.name) +
                                  " are not used");
    }

    double coordinate(Type t) {
        const double value = source_.number(t);
        if (!(std::fabs(value) <= kLargestCoordinate))
            source_.fail(std::isfinite(value) ? "a coordinate is larger than 1e100"
                                              : "a coordinate is not a finite number");
        return value;
    }

    void vertices(const Element& e) {
        enum Slot { x, y, z, nx, ny, nz, u, v, kSlots };
        std::array<std::optional<std::size_t>, kSlots> where{
            e.find({"x"}, false),
            e.find({"y"}, false),
            e.find({"z"}, false),
            e.find({"nx"}, false),
            e.find({"ny"}, false),
            e.find({"nz"}, false),
            e.find({"u", "s", "texture_u", "texture_s"}, false),
            e.find({"v", "t", "texture_v", "texture_t"}, false)};
        for (const Slot s : {x, y, z})
            if (!where[s]) source_.fail("has no property x, y or z");
        hasNormals_ = where[nx] && where[ny] && where[nz];
        hasUvs_ = where[u] && where[v];
        std::vector<int> slot(e.properties.size(), -1);
        for (int s = 0; s < kSlots; ++s) {
            if ((s >= nx && s <= nz && !hasNormals_) || (s >= u && !hasUvs_)) continue;
            slot[*where[static_cast<std::size_t>(s)]] = s;
        }
        mesh_.positions.reserve(e.count);
        if (hasNormals_) mesh_.normals.reserve(e.count);
        if (hasUvs_) mesh_.uvs.reserve(e.count);
        std::array<double, kSlots> value{};
        for (std::uint64_t i = 0; i < e.count; ++i) {
            source_.place(e, i);
            for (std::size_t p = 0; p < slot.size(); ++p) {
                if (slot[p] < 0)
                    skipProperty(e.properties[p]);
                else
                    value[static_cast<std::size_t>(slot[p])] = coordinate(e.properties[p].type);
            }
            mesh_.positions.push_back({value[x], value[y], value[z]});
            if (hasNormals_) mesh_.normals.push_back({value[nx], value[ny], value[nz]});
            if (hasUvs_) mesh_.uvs.push_back({value[u], value[v]});
        }
        if (e.find({"red", "diffuse_red", "r"}, false))
            mesh_.notes.push_back(std::string(fileName(mesh_.path)) +
                                  ": vertex colours are not used");
    }

    static std::string written(double value) {
        char digits[32];
        return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
    }

    std::uint32_t index(Type t) {
        const double value = source_.number(t);
        if (!(value >= 0 && value < static_cast<double>(vertices_) && value == std::floor(value)))
            source_.fail("vertex index " + written(value) + " is out of range: the file has " +
                         std::to_string(vertices_) + " vertices");
        return static_cast<std::uint32_t>(value);
    }

    void corner(std::uint32_t vertex) {
        mesh_.cornerPosition.push_back(vertex);
        if (hasNormals_) mesh_.cornerNormal.push_back(vertex);
        if (hasUvs_) mesh_.cornerUv.push_back(vertex);
    }

    void endFace() {
        if (mesh_.cornerPosition.size() >= kNone)
            source_.fail("the file has more than 2^32 - 2 corners");
        mesh_.faceStart.push_back(static_cast<std::uint32_t>(mesh_.cornerPosition.size()));
    }

    void faces(const Element& e) {
        const auto indices = e.find({"vertex_indices", "vertex_index"}, true);
        const auto wedges = e.find({"texcoord", "uv"}, true);
        if (!indices) source_.fail("has no list vertex_indices");
        mesh_.faceStart.reserve(mesh_.faceStart.size() + e.count);
        mesh_.cornerPosition.reserve(mesh_.cornerPosition.size() + 3 * e.count);
        std::vector<double> uvs;
        for (std::uint64_t i = 0; i < e.count; ++i) {
            source_.place(e, i);
            uvs.clear();
            for (std::size_t p = 0; p < e.properties.size(); ++p) {
                const Property& property = e.properties[p];
                if (p == *indices) {
                    for (std::uint64_t n = listLength(property); n != 0; --n)
                        corner(index(property.type));
                } else if (wedges && p == *wedges) {
                    for (std::uint64_t n = listLength(property); n != 0; --n)
                        uvs.push_back(coordinate(property.type));
                } else {
                    skipProperty(property);
                }
            }
            const std::size_t from = mesh_.faceStart.back(), n = mesh_.cornerPosition.size() - from;
            if (!uvs.empty()) {
                if (uvs.size() != 2 * n)
                    source_.fail("has not two texture coordinates for each corner");
                mesh_.cornerUv.resize(mesh_.cornerPosition.size(), kNone);
                for (std::size_t k = 0; k < n; ++k) {
                    mesh_.cornerUv[from + k] = static_cast<std::uint32_t>(mesh_.uvs.size());
                    mesh_.uvs.push_back({uvs[2 * k], uvs[2 * k + 1]});
                }
            }
            endFace();
        }
    }

    /// Triangle strips, -1 between them; every second triangle runs the other way.
    void strips(const Element& e) {
        const auto indices = e.find({"vertex_indices", "vertex_index"}, true);
        if (!indices) source_.fail("has no list vertex_indices");
        for (std::uint64_t i = 0; i < e.count; ++i) {
            source_.place(e, i);
            for (std::size_t p = 0; p < e.properties.size(); ++p) {
                const Property& property = e.properties[p];
                if (p != *indices) {
                    skipProperty(property);
                    continue;
                }
                std::uint32_t a = 0, b = 0;
                std::uint64_t length = 0;
                for (std::uint64_t n = listLength(property); n != 0; --n) {
                    const double value = source_.number(property.type);
                    if (value == -1) {
                        length = 0;
                        continue;
                    }
                    if (!(value >= 0 && value < static_cast<double>(vertices_) &&
                          value == std::floor(value)))
                        source_.fail("a vertex index of a strip is out of range: the file has " +
                                     std::to_string(vertices_) + " vertices");
                    const auto c = static_cast<std::uint32_t>(value);
                    if (++length >= 3) {
                        corner(length % 2 == 1 ? a : b), corner(length % 2 == 1 ? b : a), corner(c);
                        endFace();
                    }
                    a = b, b = c;
                }
            }
        }
    }

    MeshFile& mesh_;
    const Header& header_;
    Source& source_;
    std::uint64_t vertices_ = 0;
    bool hasNormals_ = false, hasUvs_ = false;
};

} // namespace

MeshFile readPly(const std::string& path, std::string bytes) {
    const std::string name(fileName(path));
    const Header header = HeaderReader(name, bytes).read();
    MeshFile mesh;
    mesh.path = path;
    mesh.runs.push_back({});
    if (header.format == Format::ascii) {
        TextSource source(name, std::move(bytes), header.size);
        BodyReader(mesh, header, source).read();
    } else {
        const bool swap =
            (header.format == Format::big) != (std::endian::native == std::endian::big);
        BinarySource source(name, std::string_view(bytes).substr(header.size), swap);
        BodyReader(mesh, header, source).read();
        if (source.remaining() != 0)
            mesh.notes.push_back(name + ": " + std::to_string(source.remaining()) +
                                 " bytes behind the last element are not used");
    }
    return mesh;
}

} // namespace rt::loaders
