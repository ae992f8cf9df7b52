// The whole program on files that are not shipped: the original author's scenes, damaged meshes and their clean twins. They lie
// beside the source tree, or where RT_SHARED says; without them these tests skip.
#include <tests/cli/run.hpp>

#include <algorithm>
#include <cstdlib>

namespace rt::cli_tests {

namespace {

namespace fs = std::filesystem;

fs::path shared() {
    const char* const elsewhere = std::getenv("RT_SHARED");
    return elsewhere ? fs::path(elsewhere) : fs::path(RT_SOURCE_DIR) / "../shared";
}

} // namespace

class LegacyFiles : public Cli {
protected:
    void SetUp() override {
        if (!fs::exists(shared() / "legacy")) GTEST_SKIP() << "the legacy files are not here";
    }
};

TEST_F(LegacyFiles, EachSceneConvertsChecksAndRenders) {
    std::size_t scenes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(shared() / "legacy")) {
        if (entry.path().extension() != ".inf") continue;
        const std::string path = fs::canonical(entry.path()).string(),
                          stem = entry.path().stem().string();
        SCOPED_TRACE(path);
        if (stem.ends_with("Movie")) {
            const Outcome alone = run({"convert", path});
            EXPECT_EQ(alone.exitCode, 2);
            EXPECT_NE(alone.err.find("this is a movie file: it is converted with the scene that "
                                     "names it, or with --movie"),
                      std::string::npos)
                << alone.err;
            continue;
        }
        ++scenes;
        std::vector<std::string> convert{"convert", path, "-o", "s.yaml"};
        if (stem == "s5_defaults") { // it holds an unknown word
            EXPECT_EQ(run(convert).exitCode, 3);
            convert.push_back("--lenient");
        }
        const Outcome converted = run(convert);
        EXPECT_EQ(converted.exitCode, 0) << converted.err;
        EXPECT_EQ(converted.out, "s.yaml\n");
        const bool lacksItsMesh = path.find("author_a") != std::string::npos;
        const std::string may = lacksItsMesh ? " --allow-missing" : "";
        if (lacksItsMesh) {
            EXPECT_EQ(rt("check s.yaml").exitCode, 4);
            EXPECT_EQ(rt("render s.yaml --size 32x24 -o s.pfm").exitCode, 4);
        }
        const Outcome checked = rt("check s.yaml" + may);
        EXPECT_EQ(checked.exitCode, 0) << checked.err;
        EXPECT_EQ(checked.out, "s.yaml: no errors\n");
        const Outcome rendered = rt("render s.yaml --size 32x24 -o s.pfm" + may);
        EXPECT_EQ(rendered.exitCode, 0) << rendered.err;
        EXPECT_EQ(rendered.out, "s.pfm\n");
        fs::remove(folder_ / "s.yaml");
    }
    EXPECT_GE(scenes, 9u);
}

/// Small, on one thread, on seven, and some images alone.
TEST_F(LegacyFiles, BothFilmsRenderToTheLastImage) {
    struct Author {
        std::string name, options;
        std::size_t images;
    };
    for (const Author& author :
         {Author{"author_a", " --allow-missing", 289}, {"author_b", "", 97}}) {
        SCOPED_TRACE(author.name);
        const fs::path scene = fs::canonical(shared() / "legacy" / author.name / "Scene.inf");
        ASSERT_EQ(run({"convert", scene.string(), "-o", author.name + ".yaml"}).exitCode, 0);
        const std::string render =
            "render " + author.name + ".yaml --size 64x36" + author.options + " -o ";
        EXPECT_EQ(linesOf(rt(render + "one_%d.pfm -t 1 --overwrite").out).size(), author.images);
        EXPECT_EQ(linesOf(rt(render + "seven_%d.pfm -t 7 --overwrite").out).size(), author.images);
        for (std::size_t k = 0; k < author.images; ++k) {
            const std::string number = std::to_string(k), image = read("one_" + number + ".pfm");
            EXPECT_TRUE(read("seven_" + number + ".pfm") == image) << number;
            if (k % 24) continue;
            EXPECT_EQ(rt(render + "alone.pfm --frames " + number).exitCode, 0);
            EXPECT_TRUE(read("alone.pfm") == image) << number;
        }
    }
}

class SharedMeshes : public Cli {
protected:
    void SetUp() override {
        if (!fs::exists(shared() / "data")) GTEST_SKIP() << "the meshes are not here";
    }
    /// The picture of a mesh as glass over a checkered floor.
    std::string glass(const fs::path& mesh, const std::string& normals) {
        write("glass.yaml",
              "rt: 1\nimage: {width: 160, height: 120}\n"
              "camera: {position: [1.5, 1.2, -3], look_at: [0, 0, 0], up: [0, 1, 0], "
              "field_of_view: 40deg}\n"
              "render: {depth: 8}\n"
              "textures:\n  squares: {checker: {}}\n"
              "materials:\n  glass: {color: [1, 1, 1], diffuse: 0, specular: 0.1, transmission: "
              "0.9, ior: 1.5}\n"
              "  floor: {texture: squares, diffuse: 1}\n"
              "lights:\n  - point: {position: [4, 6, -5], color: [1, 1, 1]}\n"
              "objects:\n  - parallelogram: {origin: [-9, -1, -9], edge_u: [0, 0, 18], edge_v: "
              "[18, 0, 0], material: floor}\n"
              "  - mesh: {file: " +
                  fs::canonical(mesh).string() + ", kind: solid, normals: " + normals +
                  ", material: glass}\n");
        const Outcome rendered = rt("render glass.yaml -o glass.pfm");
        EXPECT_EQ(rendered.exitCode, 0) << rendered.err;
        EXPECT_EQ(rendered.err.find("not closed"), std::string::npos) << rendered.err;
        return read("glass.pfm");
    }
};

TEST_F(SharedMeshes, RepairedGlassIsThatOfTheCleanMeshByteForByte) {
    const fs::path data = shared() / "data";
    for (const char* const normals : {"flat", "smooth"}) {
        const std::string clean = glass(data / "dirty-gen/base_spot_quads.obj", normals);
        EXPECT_GT(clean.size(), 160u * 120 * 12);
        EXPECT_TRUE(glass(data / "dirty-gen/spot_quads_flip30.obj", normals) == clean) << normals;
        const std::string without = glass(data / "dirty/cgal_blobby.obj", normals);
        EXPECT_FALSE(without == clean);
    }
}

TEST_F(SharedMeshes, ShuffledBlobbyLooksLikeItsTwinWhateverItIsMadeOf) {
    const fs::path data = shared() / "data/dirty";
    write("clean.obj", "");
    // The files list their faces in different orders: repaired, each face has the same corners in the same sense.
    for (const char* const name : {"cgal_blobby", "cgal_blobby-shuffled"}) {
        const Outcome repaired =
            run({"mesh", "repair", (data / (std::string(name) + ".obj")).string(), "-o",
                 std::string(name) + ".obj", "--report", std::string(name) + ".json"});
        EXPECT_EQ(repaired.exitCode, 0) << repaired.err;
    }
    const auto faces = [&](const std::string& file) {
        std::vector<std::vector<double>> corners;
        std::vector<std::vector<std::vector<double>>> all;
        for (const std::string& line : linesOf(read(file))) {
            const auto fields = words(line);
            if (fields.empty()) continue;
            if (fields[0] == "v")
                corners.push_back(
                    {std::stod(fields[1]), std::stod(fields[2]), std::stod(fields[3])});
            if (fields[0] != "f") continue;
            auto& face = all.emplace_back();
            for (std::size_t i = 1; i < fields.size(); ++i)
                face.push_back(corners[std::stoul(fields[i]) - 1]);
            std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
        }
        std::sort(all.begin(), all.end());
        return all;
    };
    const auto clean = faces("cgal_blobby.obj");
    EXPECT_GT(clean.size(), 4000u);
    EXPECT_EQ(faces("cgal_blobby-shuffled.obj"), clean);
}

TEST_F(SharedMeshes, PackedOnesAreRead) {
    EXPECT_EQ(
        rt("info " + fs::canonical(shared() / "data/meshes/happy_buddha_100k.obj.gz").string())
            .exitCode,
        0);
}

} // namespace rt::cli_tests
