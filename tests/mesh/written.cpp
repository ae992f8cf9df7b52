// What `rt mesh repair` writes: the mesh, which reads back as it was, and the report.
#include "meshes.hpp"

#include <plugins/loaders/report.hpp>
#include <plugins/loaders/write_obj.hpp>

#include <gmock/gmock.h>

namespace rt::loaders {
namespace {

using ::testing::HasSubstr;
using testing::parse;
using testing::shuffled;
using testing::torus;

std::string written(const MeshFile& file, const RepairedMesh& mesh) {
    std::string out;
    writeObj(file, mesh, [&](std::string_view text) { out += text; });
    return out;
}

std::string report(const MeshFile& file, const RepairedMesh& mesh, bool everyFace) {
    std::string out;
    writeReport(file, mesh, everyFace, [&](std::string_view text) { out += text; });
    return out;
}

TEST(WrittenObj, NeedsNoFurtherRepair) {
    testing::Polygons dirty = shuffled(torus(20, 14), 0.3, 3);
    dirty.faces.push_back(dirty.faces[4]);
    dirty.faces.push_back({1, 1, 2});
    const MeshFile file = parse(dirty.obj());
    const RepairedMesh mesh = repair(file, Repair::full);
    const std::string text = written(file, mesh);
    const RepairedMesh again = repair(parse(text), Repair::full);
    EXPECT_EQ(again.faceCount(), 280u);
    EXPECT_EQ(again.summary.count(FaceReason::none), 280u);
    EXPECT_EQ(written(parse(text), again), text);
}

TEST(WrittenObj, KeepsEverythingElse) {
    const MeshFile file =
        parse("mtllib none.mtl\nv 500000.123456 0 0.1\nv 1 0 0\nv 9 9 9\nv 0 1 0\nv 1 0 0\nvt 0.25 "
              "1\nvn 0 0 1\nvn 0 0 3\no a b\ng c\ns 2\nusemtl red\n"
              "f 1/1/1 2/1/2 4\ns off\nusemtl blue\nf 4//1 2//1 1//1 5//1\nf 1 2 4\n");
    const std::string text = written(file, repair(file, Repair::none));
    EXPECT_EQ(text, "mtllib none.mtl\nv 500000.123456 0 0.1\nv 1 0 0\nv 0 1 0\nvt 0.25 1\nvn 0 0 "
                    "1\nvn 0 0 3\no a b\ng c\nusemtl red\ns 2\n"
                    "f 1/1/1 2/1/2 3\nusemtl blue\ns off\nf 3//1 2//1 1//1 2//1\nf 1 2 3\n");
}

TEST(WrittenObj, NameThatEndsInABackslashEndsItsLine) {
    const std::string obj = "mtllib a\\\t# b\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl c\\ #\nf 1 2 3\n";
    const MeshFile file = parse(obj);
    ASSERT_EQ(file.materialNames, std::vector<std::string>{"c\\"});
    EXPECT_EQ(written(file, repair(file, Repair::none)),
              "mtllib a\\ #\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl c\\ #\nf 1 2 3\n");
}

TEST(WrittenObj, NormalsTurnWithTheirFaces) {
    const MeshFile file = parse(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nv 3 0 0\nv 3 1 0\nvn 0 0 1\nvn 0 0 "
        "-1\nf 1//1 2//1 3//1 4//1\nf 2//1 5//1 6//1 3//1\nf 5//2 6//2 8//2 7//2\n");
    const std::string text = written(file, repair(file, Repair::full));
    EXPECT_THAT(text, HasSubstr("vn 0 0 -1\nvn 0 0 1\nf 1//1"));
    EXPECT_THAT(text, HasSubstr("\nf 5//3 7//3 8//3 6//3\n"));
}

TEST(Report, SaysWhatBecameOfEveryFace) {
    const MeshFile file = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 3 4\nf "
                                "2 3 4\nf 2 1 3\nf 1 2\nl 1 2\n");
    const std::string text = report(file, repair(file, Repair::full), true);
    EXPECT_THAT(text, HasSubstr("\"file\": \"test.obj\""));
    EXPECT_THAT(text, HasSubstr("\"faces\": 6,"));
    EXPECT_THAT(text, HasSubstr("\"open_edges\": 0,"));
    EXPECT_THAT(text, HasSubstr("\"closed\": true,"));
    EXPECT_THAT(text, HasSubstr("\"test.obj:11: 1 lines (l) are not drawn\""));
    EXPECT_THAT(
        text,
        HasSubstr(
            "\"faces\": [\n"
            "    {\"action\": \"kept\", \"reason\": \"\"},\n"
            "    {\"action\": \"kept\", \"reason\": \"\"},\n"
            "    {\"action\": \"flipped\", \"reason\": \"wound against its neighbours\"},\n"
            "    {\"action\": \"kept\", \"reason\": \"\"},\n"
            "    {\"action\": \"dropped\", \"reason\": \"duplicate of an earlier face\"},\n"
            "    {\"action\": \"dropped\", \"reason\": \"fewer than three corners\"}\n  ]\n}\n"));
    EXPECT_THAT(report(file, repair(file, Repair::full), false),
                ::testing::Not(HasSubstr("\"action\"")));
}

TEST(Report, QuotesWhatFilesSay) {
    MeshFile file = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    file.notes = {"a \"b\" \\ \n \xc3\xa4"};
    EXPECT_THAT(report(file, repair(file, Repair::full), false),
                HasSubstr("\"a \\\"b\\\" \\\\ \\u000a \\u00c3\\u00a4\""));
}

} // namespace
} // namespace rt::loaders
