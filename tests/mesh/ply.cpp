// PLY in its three formats, with what other programs write into it, and headers that lie.
#include "meshes.hpp"

#include <plugins/loaders/ply.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace rt::loaders {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::messageOf;

enum class Order { little, big };

class Bytes {
public:
    explicit Bytes(Order order) : order_(order) {}
    template <class T> Bytes& put(T value) {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof(T));
        if ((order_ == Order::big) != (std::endian::native == std::endian::big))
            std::reverse(raw, raw + sizeof(T));
        text.append(raw, sizeof(T));
        return *this;
    }
    std::string text;

private:
    Order order_;
};

const std::string kHeader =
    "element vertex 4\nproperty float x\nproperty double y\nproperty short z\nproperty uchar red\n"
    "property list uchar int junk\nelement junk 2\nproperty list ushort double a\nproperty char b\n"
    "element face 2\nproperty int flags\nproperty list uint ushort vertex_indices\nproperty float "
    "quality\nend_header\n";

std::string binary(Order order) {
    Bytes body(order);
    const double points[4][3] = {{0, 0, 0}, {0.1, 0.1, 0}, {1, 500000.123456, -7}, {0, 1, 3}};
    for (int i = 0; i < 4; ++i) {
        body.put(static_cast<float>(points[i][0]))
            .put(points[i][1])
            .put(static_cast<std::int16_t>(points[i][2]))
            .put<std::uint8_t>(200);
        body.put(static_cast<std::uint8_t>(i));
        for (int k = 0; k < i; ++k) body.put<std::int32_t>(-k);
    }
    body.put<std::uint16_t>(2).put(1.5).put(2.5).put<char>('x').put<std::uint16_t>(0).put<char>(
        'y');
    body.put<std::int32_t>(7)
        .put<std::uint32_t>(4)
        .put<std::uint16_t>(0)
        .put<std::uint16_t>(1)
        .put<std::uint16_t>(2)
        .put<std::uint16_t>(3)
        .put(0.5f);
    body.put<std::int32_t>(8)
        .put<std::uint32_t>(3)
        .put<std::uint16_t>(3)
        .put<std::uint16_t>(2)
        .put<std::uint16_t>(0)
        .put(0.5f);
    return std::string("ply\nformat binary_") + (order == Order::little ? "little" : "big") +
           "_endian 1.0\ncomment made here\n" + kHeader + body.text;
}

const std::string kAscii =
    "ply\nformat ascii 1.0\nobj_info x\n" + kHeader +
    "0 0 0 200 0\n0.1 0.1 0 200 1 0\n1 500000.123456 -7 200 2 0 -1\n0 1 3 200 3 0 -1 -2\n"
    "2 1.5 2.5 1\n0 2\n7 4 0 1 2 3 0.5\n8 3 3 2 0 0.5\n";

TEST(Ply, ThreeFormatsSayTheSame) {
    for (const std::string& text : {kAscii, binary(Order::little), binary(Order::big)}) {
        const MeshFile mesh = readPly("a.ply", text);
        EXPECT_THAT(mesh.cornerPosition, ElementsAre(0, 1, 2, 3, 3, 2, 0));
        EXPECT_THAT(mesh.faceStart, ElementsAre(0, 4, 7));
        ASSERT_EQ(mesh.positions.size(), 4u);
        const bool ascii = text[11] == 'a';
        EXPECT_EQ(mesh.positions[1], (Vector3{ascii ? 0.1 : static_cast<double>(0.1f), 0.1, 0}));
        EXPECT_EQ(mesh.positions[2], (Vector3{1, 500000.123456, -7}));
        EXPECT_THAT(mesh.notes, ElementsAre("a.ply: vertex colours are not used",
                                            "a.ply: 2 elements 'junk' are not used"));
    }
}

TEST(Ply, EveryIntegerTypeCountsAndIndexes) {
    const char* const names[] = {"char", "uint8", "int16", "ushort", "int", "uint32"};
    for (const char* const countType : names)
        for (const char* const indexType : names) {
            const std::string header =
                std::string("ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float "
                            "x\nproperty float y\nproperty float z\n"
                            "element face 1\nproperty list ") +
                countType + " " + indexType + " vertex_index\nend_header\n";
            Bytes body(Order::big);
            for (const float f : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) body.put(f);
            const auto put = [&](const char* type, int value) {
                const std::string t = type;
                if (t == "char" || t == "uint8")
                    body.put(static_cast<std::uint8_t>(value));
                else if (t == "int16" || t == "ushort")
                    body.put(static_cast<std::uint16_t>(value));
                else
                    body.put(static_cast<std::uint32_t>(value));
            };
            put(countType, 3);
            for (const int i : {0, 1, 2}) put(indexType, i);
            EXPECT_THAT(readPly("a.ply", header + body.text).cornerPosition, ElementsAre(0, 1, 2))
                << countType << indexType;
        }
}

TEST(Ply, LineEndsOfTheHeader) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string text;
        for (const char c : kAscii) text += c == '\n' ? end : std::string(1, c);
        EXPECT_EQ(readPly("a.ply", text).faceCount(), 2u);
    }
    // Behind a header with CR alone, binary data may begin with a byte that is LF.
    Bytes body(Order::little);
    body.put<std::uint8_t>(10).put<std::uint8_t>(0).put<std::uint8_t>(0).put<std::uint8_t>(0);
    for (int i = 0; i < 8; ++i) body.put<std::uint8_t>(static_cast<std::uint8_t>(i * i));
    body.put<std::uint8_t>(3).put<std::uint8_t>(0).put<std::uint8_t>(1).put<std::uint8_t>(2);
    std::string header = "ply\rformat binary_little_endian 1.0\relement vertex 4\rproperty uchar "
                         "x\rproperty uchar y\rproperty uchar z\r"
                         "element face 1\rproperty list uchar uchar vertex_indices\rend_header\r";
    EXPECT_EQ(readPly("a.ply", header + body.text).positions[0].x, 10);
}

TEST(Ply, NormalsAndTextureCoordinates) {
    const MeshFile mesh =
        readPly("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float s\nproperty "
                         "float t\nproperty float x\nproperty float y\nproperty float z\n"
                         "property float nx\nproperty float ny\nproperty float nz\nelement face "
                         "1\nproperty list uchar int vertex_indices\nend_header\n"
                         "0.25 1 0 0 0 0 0 1\n0 0 1 0 0 0 0 1\n0 0 0 1 0 0 0 2\n3 2 0 1\n");
    EXPECT_THAT(mesh.cornerNormal, ElementsAre(2, 0, 1));
    EXPECT_THAT(mesh.cornerUv, ElementsAre(2, 0, 1));
    EXPECT_EQ(mesh.uvs[0].x, 0.25);
    EXPECT_EQ(mesh.normals[2].z, 2);
    const MeshFile wedges =
        readPly("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty "
                         "float y\nproperty float z\n"
                         "element face 2\nproperty list uchar int vertex_indices\nproperty list "
                         "uchar float texcoord\nend_header\n"
                         "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 0\n3 2 1 0 6 1 2 3 4 5 6\n");
    EXPECT_THAT(wedges.cornerUv, ElementsAre(kNone, kNone, kNone, 0, 1, 2));
    EXPECT_EQ(wedges.uvs[1].y, 4);
}

TEST(Ply, TriangleStrips) {
    const MeshFile mesh =
        readPly("a.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty "
                         "float y\nproperty float z\n"
                         "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                         "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 0 1 2\n");
    EXPECT_THAT(mesh.cornerPosition, ElementsAre(0, 1, 2, 2, 1, 3, 2, 3, 4, 0, 1, 2));
}

std::string refusal(const std::string& text) {
    return messageOf([&] { readPly("a.ply", text); });
}

TEST(Ply, RefusesWithThePlace) {
    const std::string vertices = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float "
                                 "x\nproperty float y\nproperty float z\n";
    const std::string faces =
        vertices +
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
    struct Case {
        std::string text;
        const char* message;
    };
    for (const Case& c : {
             Case{"", "a.ply:1:1: does not begin with 'ply'"},
             Case{"plx\n", "a.ply:1:1: does not begin with 'ply'"},
             Case{"ply\nformat ascii 1.0\n", "a.ply:2:1: the header has no end_header"},
             Case{"ply\nend_header\n", "a.ply:2:1: the header names no format"},
             Case{"ply\nformat text 1.0\n", "a.ply:2:1: unknown format 'text'"},
             Case{"ply\nelement vertex many\n",
                  "a.ply:2:1: the count of element 'vertex' is not a number: 'many'"},
             Case{"ply\nelement vertex -1\n",
                  "a.ply:2:1: the count of element 'vertex' is not a number: '-1'"},
             Case{"ply\nproperty int x\n", "a.ply:2:1: a property belongs to no element"},
             Case{"ply\nelement face 1\nproperty list float int x\n",
                  "a.ply:3:1: the length of a list is an integer"},
             Case{"ply\nelement face 1\nproperty long x\n", "a.ply:3:1: unknown type 'long'"},
             Case{"ply\nfaces 12\n", "a.ply:2:1: unknown header line 'faces'"},
             Case{faces + "3 0 1 3\n",
                  "a.ply:13:7: vertex index 3 is out of range: the file has 3 vertices"},
             Case{faces + "3 0 1 -1\n",
                  "a.ply:13:7: vertex index -1 is out of range: the file has 3 vertices"},
             Case{faces + "3 0 1 1.5\n", "a.ply:13:7: is not an integer: '1.5'"},
             Case{faces + "3 0 1\n",
                  "a.ply:14:1: the file ends before the last element its header announces"},
             Case{faces + "-3 0 1 2\n", "a.ply:13:1: a list has a negative length"},
             Case{faces + "3000 0 1 2\n",
                  "a.ply:13:1: a list has more entries than the file can hold"},
             Case{faces + "3 0 1 x\n", "a.ply:13:7: the value is not a number: 'x'"},
             Case{vertices + "end_header\n0 nan 0\n0 0 0\n0 0 0\n",
                  "a.ply:8:3: a coordinate is not a finite number"},
             Case{vertices + "end_header\n0 0 0\n0 0 0\n0 0 0\n", "a.ply: holds no face"},
             Case{"ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int "
                  "vertex_indices\nend_header\n3 0 1 2\n",
                  "a.ply:6:3: vertex index 0 is out of range: the file has 0 vertices"},
         })
        EXPECT_EQ(refusal(c.text), c.message) << c.text;
}

TEST(Ply, LyingHeadersTakeNoMemory) {
    for (const char* const format : {"ascii", "binary_little_endian"})
        for (const char* const count : {"4294967294", "18446744073709551615", "1000000000"}) {
            const std::string text =
                std::string("ply\nformat ") + format + " 1.0\nelement vertex " + count +
                "\nproperty float x\nproperty float y\nproperty float z\nelement face " + count +
                "\nproperty list uchar int vertex_indices\nend_header\n";
            EXPECT_THAT(refusal(text + "0 0 0\n"), HasSubstr("more than the file can hold"));
        }
    Bytes body(Order::little); // a list that claims 4 GiB
    for (int i = 0; i < 9; ++i) body.put(static_cast<float>(i * i % 5));
    body.put<std::uint32_t>(0xFFFFFFFFu).put<std::int32_t>(0);
    EXPECT_EQ(refusal("ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float "
                      "x\nproperty float y\nproperty float z\n"
                      "element face 1\nproperty list uint int vertex_indices\nend_header\n" +
                      body.text),
              "a.ply: face 0: a list has more entries than the file can hold");
}

TEST(Ply, EveryPrefixIsReadOrRefused) {
    for (const std::string& text : {kAscii, binary(Order::little), binary(Order::big)}) {
        std::size_t read = 0;
        for (std::size_t n = 0; n < text.size(); ++n) read += refusal(text.substr(0, n)).empty();
        EXPECT_LE(read, 3u); // without the last digits or line end of ASCII
        EXPECT_EQ(refusal(text), "");
        EXPECT_EQ(refusal(text + "\n"), "");
    }
    EXPECT_THAT(readPly("a.ply", binary(Order::big) + "more").notes,
                ::testing::Contains("a.ply: 4 bytes behind the last element are not used"));
}

} // namespace
} // namespace rt::loaders
