// Files on disk: gzip, what is no regular file, material libraries and what they may reach.
#include "meshes.hpp"

#include <plugins/loaders/file_bytes.hpp>

#include <gmock/gmock.h>

#include <sys/stat.h>

namespace rt::loaders {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using testing::gzip;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::messageOf;
using testing::TemporaryFolder;

const std::string kMesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST(Files, GzipIsUnpackedWhateverItsName) {
    const TemporaryFolder folder;
    for (const char* name : {"a.obj.gz", "a.obj", "A.OBJ.GZ"})
        EXPECT_EQ(readMesh(folder.write(name, gzip(kMesh))).faceCount(), 1u) << name;
    EXPECT_EQ(readFile(folder.write("two.gz", gzip("ab") + gzip("cd")), kLargestMesh), "abcd");
    const std::string large(3'000'000, 'x');
    EXPECT_EQ(readFile(folder.write("large.gz", gzip(large)), kLargestMesh), large);
}

TEST(Files, DamagedGzipIsRefused) {
    const TemporaryFolder folder;
    std::string text;
    for (int i = 0; i < 500; ++i) text += "v " + std::to_string(i * i) + " 0 0\n";
    const std::string packed = gzip(text);
    for (std::size_t n = 3; n < packed.size(); n += 11)
        EXPECT_THAT(
            messageOf([&] { readFile(folder.write("cut.gz", packed.substr(0, n)), kLargestMesh); }),
            HasSubstr("cut.gz: is cut short"))
            << n;
    std::string damaged = packed;
    damaged[packed.size() / 2] = static_cast<char>(damaged[packed.size() / 2] ^ 0x55);
    EXPECT_THAT(messageOf([&] { readFile(folder.write("bad.gz", damaged), kLargestMesh); }),
                HasSubstr("bad.gz: is "));
}

TEST(Files, LimitsHoldForBothSizes) {
    const TemporaryFolder folder;
    const std::string bomb = gzip(std::string(8 << 20, '\n'));
    ASSERT_LT(bomb.size(), 100'000u);
    EXPECT_EQ(messageOf([&] { readFile(folder.write("bomb.gz", bomb), 1 << 20); }),
              "bomb.gz: unpacks to more than 1 MiB");
    EXPECT_EQ(
        messageOf([&] { readFile(folder.write("big", std::string((1 << 20) + 1, ' ')), 1 << 20); }),
        "big: has more than 1 MiB");
    EXPECT_EQ(readFile(folder.write("fits.gz", gzip(std::string(1 << 20, 'y'))), 1 << 20).size(),
              1u << 20);
}

TEST(Files, OnlyRegularFilesAreRead) {
    const TemporaryFolder folder;
    const std::string pipe = (folder.path() / "pipe.obj").string();
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_EQ(messageOf([&] { readMesh(pipe); }), "pipe.obj: is not a regular file");
    EXPECT_EQ(messageOf([&] { readMesh("/dev/zero"); }), "zero: is not a regular file");
    EXPECT_EQ(messageOf([&] { readMesh(folder.path().string()); }),
              folder.path().filename().string() + ": is not a regular file");
    EXPECT_EQ(messageOf([&] { readMesh((folder.path() / "none.obj").string()); }),
              "none.obj: cannot be opened: No such file or directory");
}

MeshFile withLibrary(const TemporaryFolder& folder, const std::string& statement) {
    return readMesh(folder.write("m.obj", statement + "\nusemtl red\n" + kMesh));
}

TEST(Mtl, Materials) {
    const TemporaryFolder folder;
    folder.write("pic ture.png", "");
    folder.write(
        "red.mtl",
        "# c\nKd 9 9 9\nnewmtl red # comment\n Kd 0.5 0.25 0 # inline\n Ks 0.5\n Ke 1 2 3\n Ns "
        "30\n Ni 1.5\n"
        " d 0.75\n Tf 0.5 1 1\n map_Kd -s 2 2 -clamp on pic ture.png\nnewmtl red\nKd 0 0 0\n");
    const MeshFile mesh = withLibrary(folder, "mtllib red.mtl");
    ASSERT_EQ(mesh.materials.size(), 1u);
    const Material& m = mesh.materials[0];
    EXPECT_EQ(m.name, "red");
    EXPECT_EQ(m.color, (Color{1, 1, 1}));
    EXPECT_EQ(m.diffuse, (Color{0.375, 0.1875, 0}));
    EXPECT_EQ(m.specular, (Color{0.5, 0.5, 0.5}));
    EXPECT_EQ(m.environment, (Color{1, 2, 3}));
    EXPECT_EQ(m.transmission, (Color{0.125, 0.25, 0.25}));
    EXPECT_EQ(m.shininess, 30);
    EXPECT_EQ(m.ior, 1.5);
    EXPECT_EQ(m.colorFile.path,
              (std::filesystem::canonical(folder.path()) / "pic ture.png").string());
    EXPECT_THAT(mesh.notes,
                ElementsAre("red.mtl:11: the option '-s' of map_Kd is not used",
                            "red.mtl:11: the option '-clamp' of map_Kd is not used",
                            "red.mtl:12: material 'red' is defined twice; the first is used"));
}

TEST(Mtl, TransparencyInAllItsSpellings) {
    struct Case {
        const char* statements;
        Color transmission, diffuse;
    };
    const Color no{}, white{1, 1, 1};
    for (const Case& c :
         {Case{"Tr 0.25", white * 0.25, white * 0.75}, Case{"d 0.75", white * 0.25, white * 0.75},
          Case{"d 0.75\nTr 0.5", white * 0.25, white * 0.75},
          Case{"Tr 0.5\nd 0.75", white * 0.25, white * 0.75},
          Case{"d -halo 0.75", white * 0.25, white * 0.75}, Case{"Tf 1 1 1", no, white},
          Case{"d 1\nTf 1 1 1", no, white}, Case{"d 1\nTf 0.5 0.5 0.5", no, white},
          Case{"Tf 0.125 0.25 0.5", {0.125, 0.25, 0.5}, white},
          Case{"Kt 0.125 0.25 0.5", {0.125, 0.25, 0.5}, white}, Case{"illum 1", no, white}}) {
        const TemporaryFolder folder;
        folder.write("a.mtl", std::string("newmtl red\n") + c.statements);
        const MeshFile mesh = withLibrary(folder, "mtllib a.mtl");
        ASSERT_EQ(mesh.materials.size(), 1u);
        EXPECT_EQ(mesh.materials[0].transmission, c.transmission) << c.statements;
        EXPECT_EQ(mesh.materials[0].diffuse, c.diffuse) << c.statements;
    }
}

TEST(Mtl, LibrariesAreFoundBesideTheMesh) {
    const TemporaryFolder folder;
    folder.write("a b.mtl", "newmtl red\nKd 1 0 0\n");
    folder.write("sub/c.mtl", "newmtl red\nKd 0 1 0\nmap_Kd .\\d.png");
    folder.write("sub/d.png", "");
    EXPECT_EQ(withLibrary(folder, "mtllib a b.mtl").materials.size(), 1u); // blanks in a name
    EXPECT_EQ(withLibrary(folder, "mtllib none.mtl sub/c.mtl").materials.size(),
              1u); // several names
    const MeshFile mesh = withLibrary(folder, "mtllib sub\\c.mtl");
    ASSERT_EQ(mesh.materials.size(), 1u);
    EXPECT_EQ(mesh.materials[0].colorFile.path,
              (std::filesystem::canonical(folder.path()) / "sub/d.png").string());
    // mtllib may follow its first use
    EXPECT_EQ(readMesh(folder.write("late.obj", "usemtl red\n" + kMesh + "mtllib a b.mtl"))
                  .materials.size(),
              1u);
}

TEST(Mtl, NothingAboveTheMeshIsRead) {
    const TemporaryFolder folder;
    folder.write("secret.mtl", "newmtl red\nKd 1 0 0\n");
    folder.write("in/ok.mtl", "newmtl red\nmap_Kd ../secret.mtl\n");
    std::filesystem::create_symlink("../secret.mtl", folder.path() / "in/link.mtl");
    const auto notes = [&](const std::string& statement) {
        const MeshFile mesh =
            readMesh(folder.write("in/m.obj", statement + "\nusemtl red\n" + kMesh));
        for (const Material& m : mesh.materials) EXPECT_EQ(m.colorFile.path, "");
        return mesh.notes;
    };
    EXPECT_THAT(notes("mtllib ../secret.mtl"),
                Contains("m.obj:1: material library '../secret.mtl' lies above the mesh's folder, "
                         "where nothing is read"));
    EXPECT_THAT(notes("mtllib link.mtl"), Contains(HasSubstr("lies above the mesh's folder")));
    EXPECT_THAT(notes("mtllib ../../../../../../../../dev/zero"),
                Contains(HasSubstr("lies above the mesh's folder")));
    EXPECT_THAT(notes("mtllib " + (folder.path() / "secret.mtl").string()),
                Contains(HasSubstr("absolute path")));
    EXPECT_THAT(notes("mtllib C:\\secret.mtl"), Contains(HasSubstr("absolute path")));
    EXPECT_THAT(notes("mtllib ok.mtl"),
                Contains(HasSubstr("ok.mtl:2: image '../secret.mtl' lies above")));
    EXPECT_THAT(notes("mtllib none.mtl"),
                Contains("m.obj:1: material library 'none.mtl' is not there"));
    EXPECT_THAT(notes("mtllib"), Contains("m.obj:1: material library '' is not named"));
}

TEST(Mtl, RefusesWithThePlace) {
    const TemporaryFolder folder;
    const auto message = [&](const std::string& statement) {
        folder.write("a.mtl", "newmtl red\n" + statement);
        return messageOf([&] { withLibrary(folder, "mtllib a.mtl"); });
    };
    EXPECT_EQ(message("Kd 1 nan 0"), "a.mtl:2:6: the colour's green is not a finite number: 'nan'");
    EXPECT_EQ(message("Kd 1 0"), "a.mtl:2:7: the colour's blue is missing");
    EXPECT_EQ(message("Kd -1 0 0"), "a.mtl:2:4: the colour's red must be in [0, 1e6]");
    EXPECT_EQ(message("Ns x"), "a.mtl:2:4: Ns is not a number: 'x'");
    EXPECT_EQ(message("d 2"), "a.mtl:2:3: d must be in [0, 1]");
    ASSERT_EQ(std::filesystem::remove(folder.path() / "a.mtl"), true);
    ASSERT_EQ(mkfifo((folder.path() / "a.mtl").c_str(), 0600), 0);
    EXPECT_EQ(messageOf([&] { withLibrary(folder, "mtllib a.mtl"); }),
              "a.mtl: is not a regular file");
}

TEST(Mtl, MaterialsReachTheTriangles) {
    const TemporaryFolder folder;
    folder.write("a.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nnewmtl unused\n");
    const Import import = importMesh(
        folder.write("m.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nusemtl "
                              "blue\nf 1 3 4\nusemtl red\nf 1 2 3 4\nusemtl gone\nf 4 3 2 1\n"),
        {.repair = Repair::none});
    ASSERT_EQ(import.materials.size(), 2u);
    EXPECT_EQ(import.materials[0].name, "blue");
    EXPECT_THAT(import.mesh.materials, ElementsAre(kNone, 0, 1, 1, kNone, kNone));
    EXPECT_THAT(import.mesh.sourceFaces, ElementsAre(0, 1, 2, 2, 3, 3));
}

} // namespace
} // namespace rt::loaders
