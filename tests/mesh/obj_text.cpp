// OBJ text: what is understood, what is named as left out, and what is refused at which place.
#include "meshes.hpp"

#include <gmock/gmock.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <random>

namespace rt::loaders {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::parse;
using testing::refusal;
using ::testing::StartsWith;

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
using Indices = std::vector<std::uint32_t>;

TEST(ObjText, IndexForms) {
    const std::string attributes = kTriangle + "vt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n";
    struct Case {
        const char* face;
        Indices uvs, normals;
    };
    const std::uint32_t no = kNone;
    for (const Case& c :
         {Case{"f 1 2 3", {}, {}}, Case{"f 1/3 2/2 3/1", {2, 1, 0}, {}},
          Case{"f 1//1 2//1 3//1", {}, {0, 0, 0}},
          Case{"f 1/1/1 2/2/1 3/3/1", {0, 1, 2}, {0, 0, 0}}, Case{"f 1// 2// 3//", {}, {}},
          Case{"f 1/ 2/ 3/", {}, {}}, Case{"f 1/1/ 2/2/ 3/3/", {0, 1, 2}, {}},
          Case{"f 1/1 2 3/3", {0, no, 2}, {}},
          Case{"f -3/-1/-1 -2/-2/-1 -1/-3/-1", {2, 1, 0}, {0, 0, 0}},
          Case{"f +1 2//1 3", {}, {no, 0, no}}, Case{"fo 1 2 3", {}, {}},
          Case{"f\t1\v2\f3 ", {}, {}}, Case{"  f 1 2 3#4", {}, {}},
          Case{"f 001 2 3 # 4", {}, {}}}) {
        const MeshFile mesh = parse(attributes + c.face);
        EXPECT_THAT(mesh.faceStart, ElementsAre(0, 3)) << c.face;
        EXPECT_THAT(mesh.cornerPosition, ElementsAre(0, 1, 2)) << c.face;
        EXPECT_EQ(mesh.cornerUv, c.uvs) << c.face;
        EXPECT_EQ(mesh.cornerNormal, c.normals) << c.face;
    }
}

TEST(ObjText, NegativeIndicesCountFromWhereTheyStand) {
    const MeshFile mesh = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -3 -1\n");
    EXPECT_THAT(mesh.cornerPosition, ElementsAre(0, 1, 2, 0, 1, 3));
}

TEST(ObjText, FacesMayStandBeforeTheirVertices) {
    const MeshFile mesh = parse("f 1/1 2/1 3/1\n" + kTriangle + "vt 0.5 0.25\n");
    EXPECT_THAT(mesh.cornerPosition, ElementsAre(0, 1, 2));
    EXPECT_THAT(mesh.cornerUv, ElementsAre(0, 0, 0));
    EXPECT_EQ(refusal("f 1 2 4\n" + kTriangle),
              "test.obj:1:7: vertex index 4 is out of range: the file has 3 vertices");
}

TEST(ObjText, LineEnds) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        const MeshFile mesh = parse("v 0 0 0" + end + "v 1 0 0" + end + "v 0 1 0" + end + end +
                                    "f 1 \\" + end + "2 3" + end + "f 3 2 1");
        EXPECT_THAT(mesh.cornerPosition, ElementsAre(0, 1, 2, 2, 1, 0));
        EXPECT_THAT(refusal("v 0 0 0" + end + "v 1 0 0" + end + "v 0 1" + end + "f 1 2 3"),
                    StartsWith("test.obj:3:6: "));
        EXPECT_THAT(refusal(kTriangle + "f 1 \\" + end + "2 \\" + end + " 4" + end),
                    StartsWith("test.obj:6:2: "));
    }
}

TEST(ObjText, BackslashesJoinLinesButNotComments) {
    const MeshFile mesh =
        parse("# C:\\meshes\\\n" + kTriangle + "f 1 2 \\ \n3 # more \\\nf 3 2 1\n");
    EXPECT_THAT(mesh.cornerPosition, ElementsAre(0, 1, 2, 2, 1, 0));
}

TEST(ObjText, ByteOrderMark) {
    EXPECT_EQ(parse("\xef\xbb\xbf" + kTriangle + "f 1 2 3").faceCount(), 1u);
    EXPECT_EQ(refusal("\xef\xbb\xbfv a 0 0\n"),
              "test.obj:1:3: the x coordinate is not a number: 'a'");
    EXPECT_EQ(refusal(std::string("\xfe\xff\0v\0 ", 6)),
              "test.obj:1:1: is UTF-16; only UTF-8 and ASCII are read");
    EXPECT_EQ(refusal(std::string("v 0 0 0\nv \0", 11)),
              "test.obj:2:3: is binary data, not text (a NUL byte)");
}

TEST(ObjText, CoordinatesAreTheNearestDoubles) {
    std::mt19937_64 random(7);
    std::string text;
    std::vector<double> expected;
    const auto add = [&](const std::string& number) {
        double value = 0;
        const char* from = number.data() + (number[0] == '+');
        std::from_chars(from, number.data() + number.size(), value);
        expected.push_back(value);
        text += "v " + number + " 0 0\n";
    };
    for (const char* s :
         {"500000.123456", "4649776.22482", "16777217", "1.0000000001", "0.1", "-0.0", "1e22",
          "1e23", "9007199254740993", "123456789012345678901234567890", ".5", "5.", "+.25e+01",
          "1E-5", "2.2250738585072011e-308", "5e-324", "0.000000000000000000000000000001",
          "00001.50"})
        add(s);
    for (int i = 0; i < 3000;
         ++i) { // every rounding path: short and long decimals, all exponents within range
        const double value = std::bit_cast<double>(random());
        if (!(std::fabs(value) < kLargestCoordinate)) continue;
        char digits[64];
        add({digits, std::to_chars(digits, digits + 64, value).ptr});
        add({digits, std::to_chars(digits, digits + 64,
                                   static_cast<double>(static_cast<float>(random() % 100000) / 7),
                                   std::chars_format::fixed, 6)
                         .ptr});
    }
    const MeshFile mesh = parse(text + "f 1 2 3\n");
    ASSERT_EQ(mesh.positions.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        ASSERT_EQ(std::bit_cast<std::uint64_t>(mesh.positions[i].x),
                  std::bit_cast<std::uint64_t>(expected[i]))
            << i;
}

TEST(ObjText, NumbersTooSmallForADoubleAreZero) {
    const MeshFile mesh =
        parse("v 1e-400 -1e-999 0." + std::string(400, '0') + "1\nv 1 0 0\nv 0 1 0\nf 1 2 3");
    EXPECT_EQ(mesh.positions[0], (Vector3{0, 0, 0}));
}

TEST(ObjText, RefusesWithThePlace) {
    struct Case {
        std::string text;
        const char* message;
    };
    for (const Case& c : {
             Case{kTriangle + "f 1 2 0", "test.obj:4:7: vertex index 0: OBJ counts from 1"},
             Case{kTriangle + "f 1 2 4",
                  "test.obj:4:7: vertex index 4 is out of range: the file has 3 vertices"},
             Case{kTriangle + "f 1 2 -4", "test.obj:4:7: vertex index -4 is out of range: the file "
                                          "has 3 vertices before it"},
             Case{kTriangle + "f 1 2 4294967297",
                  "test.obj:4:7: vertex index 4294967297 is out of range: the file has 3 vertices"},
             Case{kTriangle + "f 1 2 99999999999999999999999",
                  "test.obj:4:7: vertex index 99999999999999999999999 is out of range: the file "
                  "has 3 vertices"},
             Case{kTriangle + "vn 0 0 1\nf 1//1 2//1 3//2",
                  "test.obj:5:16: normal index 2 is out of range: the file has 1 normal"},
             Case{kTriangle + "vt 0 0\nf 1/-2 2/1 3/1",
                  "test.obj:5:5: texture coordinate index -2 is out of range: the file has 1 "
                  "texture coordinate before it"},
             Case{kTriangle + "f /1 2 3", "test.obj:4:3: the vertex index is not an integer: '/1'"},
             Case{kTriangle + "f 1 2 3x", "test.obj:4:7: the vertex index is not an integer: '3x'"},
             Case{kTriangle + "f 1 2 1.5",
                  "test.obj:4:7: the vertex index is not an integer: '1.5'"},
             Case{kTriangle + "f 1/1/1/1 2 3",
                  "test.obj:4:8: a corner is v, v/t, v//n or v/t/n, not '/1'"},
             Case{
                 "v 0,5 0 0\n",
                 "test.obj:1:3: the x coordinate is not a number: '0,5'; the decimal point is '.'"},
             Case{"v 0 nan 0\n", "test.obj:1:5: the y coordinate is not a finite number: 'nan'"},
             Case{"v 0 0 -inf\n", "test.obj:1:7: the z coordinate is not a finite number: '-inf'"},
             Case{"v 0 0 1e400\n",
                  "test.obj:1:7: the z coordinate is not a finite number: '1e400'"},
             Case{"v 0 0 1e101\n", "test.obj:1:12: the z coordinate is larger than 1e100"},
             Case{"v 0 0\n", "test.obj:1:6: the z coordinate is missing"},
             Case{"v 0 0 # 0\n", "test.obj:1:7: the z coordinate is missing"},
             Case{"v 0 0 +-1\n", "test.obj:1:7: the z coordinate is not a number: '+-1'"},
             Case{"v 0 0 0x10\n", "test.obj:1:7: the z coordinate is not a number: '0x10'"},
             Case{"v 0 0 3.1-e2\n", "test.obj:1:7: the z coordinate is not a number: '3.1-e2'"},
             Case{"v 0 0 1e\n", "test.obj:1:7: the z coordinate is not a number: '1e'"},
             Case{"v 0 0 0 red\n", "test.obj:1:9: the weight or colour is not a number: 'red'"},
             Case{"vn 0 0 nan\n", "test.obj:1:8: the normal's z is not a finite number: 'nan'"},
             Case{"vt inf\n", "test.obj:1:4: u is not a finite number: 'inf'"},
             Case{"vt 0 0 0 0\n", "test.obj:1:10: unexpected '0' at the end of 'vt'"},
             Case{kTriangle + "s one\n",
                  "test.obj:4:3: a smoothing group is a number or off, not 'one'"},
             Case{"\x01\x02\xff 1 2\n", "test.obj:1:1: '\\x01\\x02\\xff' is no OBJ statement"},
             Case{kTriangle, "test.obj: holds no face"},
             Case{"", "test.obj: holds no face"},
             Case{kTriangle + "l 1 2 3\np 1", "test.obj: holds no face"},
             Case{kTriangle + "f 1 2\nf 1\nf\n",
                  "test.obj:4:2: no face of the file has three corners"},
         })
        EXPECT_EQ(refusal(c.text), c.message) << c.text;
}

TEST(ObjText, EveryPrefixIsReadOrRefused) {
    const std::string text = "mtllib a.mtl\no x\ng y\nv 0.5 1e3 -2 1 0 0\nv 1 0 0\nv 0 1 0\nvt 0 "
                             "0\nvn 0 0 1\ns 1\nusemtl m\n"
                             "f 1/1/1 2/1/1 \\\n3/1/1\nf -3//-1 -2//-1 -1//-1\n";
    std::size_t read = 0;
    for (std::size_t n = 0; n <= text.size(); ++n) read += refusal(text.substr(0, n)).empty();
    EXPECT_GT(read, 20u); // from the end of the first face on, except in the middle of the second
    EXPECT_EQ(refusal(text), "");
}

TEST(ObjText, MissingAttributeListsAreForgiven) { // trimesh's cubevt.obj, tinyobjloader's issue 29
    const MeshFile mesh = parse(kTriangle + "f 1/1/-1 2/2/2 3/3/3");
    EXPECT_TRUE(mesh.cornerUv.empty());
    EXPECT_TRUE(mesh.cornerNormal.empty());
    EXPECT_THAT(mesh.notes,
                ElementsAre("test.obj:4: 3 corners name texture coordinates, and the file has none",
                            "test.obj:4: 3 corners name normals, and the file has none"));
}

TEST(ObjText, NamesWhatIsNotUsed) {
    const MeshFile mesh =
        parse(kTriangle +
              "v 0 0 1 0.5\nv 0 0 2 1 nan 0\nl 1 2\nl 2 3\np 1\nvp 0 0\nt 1/1\nF 1 2 3\nf 1 2 3\n");
    EXPECT_THAT(mesh.notes, ElementsAre("test.obj:5: 1 vertex colours are not used",
                                        "test.obj:4: 1 vertex weights are not used",
                                        "test.obj:11: 1 statements 'F' are not used",
                                        "test.obj:6: 2 lines (l) are not drawn",
                                        "test.obj:8: 1 points (p) are not drawn",
                                        "test.obj:10: 1 statements 't' are not used",
                                        "test.obj:9: 1 free-form statements (vp) are not drawn"));
}

TEST(ObjText, RunsOfFaces) {
    const MeshFile mesh = parse(
        kTriangle +
        "f 1 2 3\no first object\ng  a b \ns 3\nusemtl steel blue  # not this\nf 1 2 3\nf 1 2 3\n"
        "s off\nf 1 2 3\ns 0\ns 4\nusemtl foo#1\nf 1 2 3\ng end");
    ASSERT_EQ(mesh.runs.size(), 4u);
    EXPECT_EQ(mesh.runs[0].smoothing, kSmoothingUnstated);
    EXPECT_EQ(mesh.runs[1].firstFace, 1u);
    EXPECT_EQ(mesh.runs[1].smoothing, 3u);
    EXPECT_EQ(mesh.names[mesh.runs[1].object], "first object");
    EXPECT_EQ(mesh.names[mesh.runs[1].group], "a b");
    EXPECT_EQ(mesh.runs[2].firstFace, 3u);
    EXPECT_EQ(mesh.runs[2].smoothing, kSmoothingOff);
    EXPECT_EQ(mesh.runs[3].smoothing, 4u);
    EXPECT_THAT(mesh.materialNames, ElementsAre("steel blue", "foo#1"));
    EXPECT_THAT(mesh.materialIndex, ElementsAre(kNone, kNone));
    EXPECT_THAT(mesh.notes, ElementsAre("test.obj:8: 2 material names are defined by no library; "
                                        "the object's material is used"));
}

TEST(ObjText, LongFacesAndLongLines) {
    std::string face = "f";
    for (int i = 0; i < 5000; ++i) face += i % 50 == 49 ? " \\\n1 2 3" : " 1 2 3";
    EXPECT_EQ(parse(kTriangle + face).cornerPosition.size(), 15000u);
}

} // namespace
} // namespace rt::loaders
