#include <tests/faults/hostile_files.hpp>

#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace rt::faults {
namespace {

using namespace std::string_literals;
namespace fs = std::filesystem;

std::string repeated(const std::string& piece, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += piece;
    return text;
}

std::string fileBytes(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string be32(std::uint32_t n) { return {char(n >> 24), char(n >> 16), char(n >> 8), char(n)}; }
std::string le32(std::uint32_t n) { return {char(n), char(n >> 8), char(n >> 16), char(n >> 24)}; }

class Maker {
public:
    std::vector<HostileFile> files;

    void add(Format format, const std::string& suffix, int exitCode, const std::string& bytes) {
        files.push_back({format, "f" + std::to_string(files.size()) + suffix, bytes, exitCode});
    }
    void scenes(), infs(), movies(), meshes(), libraries(), scripts();
    void pictures(const std::string& corpus);
    void modules(const std::string& module);
};

const std::string kHead =
    "rt: 1\nimage: {width: 8, height: 8}\ncamera: {position: [0, -5, 0], look_at: [0, 0, "
    "0], field_of_view: 50deg}\n";

void Maker::scenes() {
    const auto scene = [&](int exitCode, const std::string& bytes) {
        add(Format::scene, ".yaml", exitCode, bytes);
    };
    for (const std::string& bytes : {""s,
                                     "\n\n# nothing\n"s,
                                     "\0\0\0"s,
                                     "\xff\xfer\0t\0"s,
                                     "\xfe\xff\0r\0t"s,
                                     "rt: 1\x1b[31m\n"s,
                                     "rt: 1\rimage: 1\n"s,
                                     "rt: \x80\n"s,
                                     "\xef\xbb\xbf"s,
                                     "%YAML 3.0\n---\nrt: 1\n"s,
                                     "--- !!python/object:os.system x\n"s,
                                     "rt: 1\n...\nrt: 1\n"s,
                                     "[1, 2"s,
                                     "{a: 1"s,
                                     "]"s,
                                     "a: 'b\n"s,
                                     "a: \"b\\q\"\n"s,
                                     "a: |\n b\n\tc\n"s,
                                     "- - - \n"s,
                                     "? [1]\n: 2\n"s,
                                     "&a\n"s,
                                     "*a\n"s,
                                     "a: *b\n"s,
                                     "a: &a *a\n"s,
                                     "a: &a [*a]\n"s,
                                     "<<: 1\nrt: 1\n"s,
                                     "<<: *x\n"s,
                                     "rt: 1\n<<: [1]\n"s,
                                     "rt: 1\nrt: 1\n"s,
                                     "RT: 1\n"s,
                                     "rt: 1.0\n"s,
                                     "rt: 99999999999999999999\n"s,
                                     "rt: [1]\n"s,
                                     "rt: 1\nimage: {width: 8, width: 8}\n"s,
                                     "@\n"s,
                                     "`\n"s,
                                     "a: %\n"s,
                                     "a\n b\n  c: d\n"s,
                                     "\t\n\t\n"s})
        scene(3, bytes);
    for (
        const std::string& rest :
        {"objects: [sphere: {radius: .nan}]"s,
         "objects: [sphere: {radius: 1e-400}]"s,
         "objects: [sphere: {radius: -0.0}]"s,
         "objects: [sphere: {center: [1e308, 1e308, 1e308]}]"s,
         "objects: [sphere: {scale: [1, 0, 1]}]"s,
         "objects: [sphere: {rotate: {axis: [0, 0, 0], angle: 1deg}}]"s,
         "objects: [sphere: {material: none}]"s,
         "objects: [mesh: {vertices: [[0, 0, 0]], faces: [[0, 1, 2]]}]"s,
         "objects: [mesh: {vertices: [[0, 0]], faces: [[0, 0, 0]]}]"s,
         "objects: [mesh: {vertices: [[0, 0, 0]], faces: [[4294967296, 0, 1]]}]"s,
         "objects: {sphere: {}}"s,
         "objects: [[]]"s,
         "objects: [sphere: sphere]"s,
         "textures: {a: {checker: {first: a}}}"s,
         "materials: {m: {color: '#gggggg'}}"s,
         "materials: {m: {ior: 0}}"s,
         "render: {depth: 99999999999}"s,
         "render: {antialias: {grid: 0}}"s,
         "render: {antialias: {grid: 1000000}}"s,
         "render: {antialias: {max_error: 0}}"s,
         "lights: [point: {}]"s,
         "lights: [sun: {position: [0, 0, 0]}]"s,
         "bounds: {min: [1, 1, 1], max: [0, 0, 0]}"s,
         "animation: {frames: 0}"s,
         "animation: {frames: 9999999999}"s,
         "animation: {frames: 9, fps: .inf}"s,
         "animation: {frames: 9, tracks: [{target: nobody, frames: [0, 8], move: {position: [0, 0, 0]}}]}"s,
         "image: {file: ../../etc/passwd.png}"s,
         "background: {texture: nowhere}"s,
         "background: {color: [1, 2]}"s})
        scene(3, rest.starts_with("image") ? "rt: 1\n" + rest + "\n" : kHead + rest + "\n");
    scene(7, repeated("[", 100'000) + repeated("]", 100'000));
    scene(7, repeated("{a: ", 20'000));
    scene(7, repeated("- ", 2000) + "x\n");
    scene(7, "k: [1" + repeated(",1", 1'200'000) + "]\n");
    scene(7, "k: " + std::string(17 << 20, 'x') + "\n");
    scene(3, "k: " + std::string(7 << 20, 'x') + "\n");
    scene(3, repeated("a", 1 << 20) + ": 1\n");
    std::string keys = kHead, anchors = kHead + "x:\n";
    for (int i = 0; i < 50'000; ++i) keys += "k" + std::to_string(i) + ": 1\n";
    for (int i = 0; i < 50'000; ++i) anchors += "  - &a" + std::to_string(i) + " 1\n";
    scene(3, keys);
    scene(3, anchors);
    std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
    for (int i = 1; i < 10; ++i)
        bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" +
                repeated("*a" + std::to_string(i - 1) + ", ", 9) + "x]\n";
    scene(7, bomb);
    scene(7, "rt: 1\nimage: {width: 65536, height: 65536}\n" + kHead.substr(kHead.find("camera")));
    for (const std::string& name :
         {"../../evil"s, "a/b"s, "evil.so"s, "EVIL"s, std::string(1'000, 'e')})
        scene(5, kHead + "objects: [" + name + ": {}]\n");
    for (const std::string& file : {"/dev/zero"s, "/dev/stdin"s, "/proc/self/mem"s, "."s,
                                    "nosuch.obj"s, std::string(300, 'a') + ".obj"})
        scene(4, kHead + "objects: [mesh: {file: '" + file + "', loader: openmesh}]\n");
    scene(3, kHead + "objects: [sphereflake: {levels: 12}]\n");
}

void Maker::infs() {
    const std::string good =
        "window 48 64\nscene 0 0 0 100 100 100\ncamera 16 12 12 50 5 30 0 1 0 0 0 1\ndepth 2\n"
        "sphere 60 62 24 12 1 1 1 0.5 0.5 0.5 0.4 0.4 0.4 0 0 0 0 0 0 1 30\nrs 50 0.5 99 1 1 1\n";
    const auto inf = [&](int exitCode, const std::string& bytes) {
        add(Format::inf, ".inf", exitCode, bytes);
    };
    for (const std::string& line :
         {"sphere\n"s,
          "sphere 1 2 3\n"s,
          "sphere nan 0 0 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\n"s,
          "sphere 1e999 0 0 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\n"s,
          "sphere 0 0 0 -1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\n"s,
          "sphere 0 0 0 0x10 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\n"s,
          "shpere 1\n"s,
          "depth -1\n"s,
          "depth 1e9\n"s,
          "depth 1.5\n"s,
          "rs 1\n"s,
          "rs inf 0 0 1 1 1\n"s,
          "back 7\n"s,
          "texture\n"s,
          "camera 0 0 0 0 0 0 0 0 0 0 0 0\n"s,
          "camera 1 1 1 0 0 0 1 0 0 1 0 0\n"s,
          "obj a.obj a nonsense 0 0 0 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\n"s,
          "triangle 1 2 3 4 5 6 7 8\n"s,
          "rect 1\n"s,
          std::string(100'000, 'w') + "\n",
          "\x1b]0;title\x07 1\n"s})
        inf(3, good + line);
    inf(4, "\0\1\2\3"s);
    inf(3, "");
    inf(3, "window 48 64\n");
    inf(3, "window 1e9 1e9\n" + good.substr(good.find("scene")));
    inf(3, "window 0 0\n" + good.substr(good.find("scene")));
    inf(3, "window -5 5\n" + good.substr(good.find("scene")));
    inf(3, std::string(200'000, '\n'));
    inf(3, repeated("sphere 1 ", 50'000));
    inf(3, std::string(1 << 20, '('));
    for (const std::string& movie :
         {"/dev/zero"s, "../../../../dev/zero"s, "."s, "nosuch.inf"s, ""s})
        inf(4, good + "movie " + movie + "\n");
}

void Maker::movies() {
    const auto movie = [&](int exitCode, const std::string& bytes) {
        add(Format::movie, ".inf", exitCode, bytes);
    };
    for (const std::string& text :
         {""s, "movie\n"s, "movie -1 24\n"s, "movie 10 0\n"s, "movie 1e99 24\n"s,
          "movie 10 24\n0 mvoe 1 2 3 0 10\n"s, "movie 10 24\n99 move 1 2 3 0 10\n"s,
          "movie 10 24\n-1 move 1 2 3 0 10\n"s, "movie 10 24\n0 move 1 2\n"s,
          "movie 10 24\n0 move nan 2 3 0 10\n"s, "movie 10 24\n0 rotate 0 0 0 0 0 0 90 0 10\n"s,
          "movie 10 24\ncamera x 0 0 0 0 10\n"s, "movie 10 24\n0-99 move 1 2 3 0 10\n"s})
        movie(3, text);
    movie(4, "movie 10 24\n\0\0\0"s);
}

void Maker::meshes() {
    const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const auto obj = [&](int exitCode, const std::string& bytes) {
        add(Format::mesh, ".obj", exitCode, bytes);
    };
    const auto ply = [&](int exitCode, const std::string& bytes) {
        add(Format::mesh, ".ply", exitCode, bytes);
    };
    for (const std::string& text : {"f /1\n"s,
                                    "f 1 2 99999999\n"s,
                                    "f 0 1 2\n"s,
                                    "f 4294967297 2 3\n"s,
                                    "f 18446744073709551617 2 3\n"s,
                                    "f 1 2\n"s,
                                    "f -9 1 2\n"s,
                                    "f 1 2 x\n"s,
                                    "v nan 0 0\nf 1 2 3\n"s,
                                    "v inf 0 0\nf 1 2 3\n"s,
                                    "v 0,5 0 0\nf 1 2 3\n"s,
                                    "v 1e400 0 0\nf 1 2 3\n"s,
                                    "v 1\nf 1 2 3\n"s,
                                    "v a b c\nf 1 2 3\n"s,
                                    "vn nan 0 0\nf 1//1 2//1 3//1\n"s,
                                    "vt nan 0\nf 1/1 2/1 3/1\n"s,
                                    "f 1 1 1\n"s,
                                    "# no face\n"s,
                                    ""s,
                                    "f 1 2 \\\n"s,
                                    "f 1.5 2 3\n"s,
                                    "f 1 2 3\\"s})
        obj(4, v + text);
    obj(4, "");
    obj(4, std::string(1 << 20, '\xff'));
    obj(4, std::string("\0\0\0\0v 1 2 3", 11));
    obj(4, std::string(4 << 20, 'v'));
    obj(4, "\x1f\x8b\x08\0\0\0\0\0\0\3garbage"s);
    std::string packed(4096, '\0'); // 64 MiB of blanks
    {
        z_stream stream{};
        deflateInit2(&stream, 9, Z_DEFLATED, MAX_WBITS + 16, 9, Z_DEFAULT_STRATEGY);
        const std::string blanks(1 << 20, ' ');
        packed.resize(1 << 20);
        stream.next_out = reinterpret_cast<Bytef*>(packed.data());
        stream.avail_out = static_cast<uInt>(packed.size());
        for (int i = 0; i < 64; ++i) {
            stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(blanks.data()));
            stream.avail_in = static_cast<uInt>(blanks.size());
            deflate(&stream, i == 63 ? Z_FINISH : Z_NO_FLUSH);
        }
        packed.resize(stream.total_out);
        deflateEnd(&stream);
    }
    obj(4, packed);
    obj(0, v + "v 0 -1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n"); // an edge of three faces
    obj(0, v + "f 1 2 3\nf 1 2 3\nf 3 2 1\n");
    for (const std::string& text : {"f 1/9 2/9 3/9\n"s, "f 1//9 2//9 3//9\n"s, "f 1 2 3/\n"s})
        obj(0, v + text); // what is missing is noted, the face is there
    obj(0, v + "mtllib ../../../../dev/zero /etc/passwd nosuch.mtl\nusemtl x\nf 1 2 3\n");
    const std::string
        head = "ply\nformat ascii 1.0\n",
        vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n",
        faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n",
        points = "0 0 0\n1 0 0\n0 1 0\n";
    for (
        const std::string& text :
        {"ply\n"s, head, head + vertices, head + vertices + faces, head + vertices + faces + points,
         head + vertices + faces + points + "3 0 1 9\n",
         head + vertices + faces + points + "3 0 1 -1\n",
         head + vertices + faces + points + "200 0 1 2\n",
         head + vertices + faces + "nan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         head + "element vertex 4294967295\nproperty float x\n" + faces,
         head + "element vertex 99999999999999999999\n" + faces,
         head + "element vertex -1\n" + faces, head + "property float x\n" + faces,
         "ply\nformat binary_little_endian 1.0\n" + vertices + faces + "abc",
         "ply\nformat binary_big_endian 1.0\nelement vertex 4000000000\nproperty double x\n" +
             faces,
         "ply\nformat binary_little_endian 1.0\nelement face 2000000000\nproperty list uint int vertex_indices\nend_header\n"s})
        ply(4, text);
}

void Maker::libraries() {
    for (const std::string& text : {"newmtl a\nKd nan 0 0\n"s, "newmtl a\nKd 1e999 0 0\n"s,
                                    "newmtl a\nKd\n"s, "newmtl a\nNs x\n"s, "newmtl a\nNi inf\n"s})
        add(Format::library, ".mtl", 4, text);
    for (const std::string& text :
         {"Kd 1 1 1\n"s, "newmtl\n"s, "newmtl a\nmap_Kd ../../../../dev/zero\n"s,
          "newmtl a\nmap_Kd /etc/passwd\n"s, "newmtl b\n"s, std::string(1 << 20, '\n'), ""s})
        add(Format::library, ".mtl", 0, text);
}

void Maker::pictures(const std::string& corpus) {
    const auto picture = [&](int exitCode, const std::string& suffix, const std::string& bytes) {
        add(Format::picture, suffix, exitCode, bytes);
    };
    std::vector<fs::path> good;
    for (const auto& entry : fs::directory_iterator(fs::path(corpus) / "picture"))
        if (entry.path().stem().string().starts_with("small")) good.push_back(entry.path());
    std::sort(good.begin(), good.end());
    for (const fs::path& path : good) {
        const std::string bytes = fileBytes(path), suffix = path.extension().string();
        for (const std::size_t part : {1u, 3u, 5u, 7u})
            picture(4, suffix, bytes.substr(0, bytes.size() * part / 8));
        picture(4, suffix, bytes.substr(0, 3) + std::string(bytes.size() - 3, '\xff'));
    }
    const std::string png = "\x89PNG\r\n\x1a\n";
    const auto ihdr = [&](std::uint32_t width, std::uint32_t height, const std::string& kind) {
        const std::string chunk = "IHDR" + be32(width) + be32(height) + kind;
        return png + be32(13) + chunk +
               be32(
                   static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(chunk.data()),
                                                    static_cast<uInt>(chunk.size()))));
    };
    const std::string rgb("\x08\x02\0\0\0", 5);
    for (const std::uint32_t side : {20000u, 65536u, 2147483647u})
        picture(7, ".png", ihdr(side, side, rgb) + be32(0) + "IDAT");
    for (const auto& [w, h] : {std::pair(0u, 5u), std::pair(5u, 0u)})
        picture(4, ".png", ihdr(w, h, rgb));
    picture(4, ".png", ihdr(4, 4, std::string("\x07\x09\1\1\1", 5)));
    picture(4, ".png", png);
    for (const std::string& sides : {"-Y 1000000 +X 1000000"s, "-Y 65536 +X 65536"s})
        picture(7, ".hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + sides + "\n");
    for (const std::string& sides :
         {"-Y -1 +X 5"s, "-Y 0 +X 5"s, "+Y"s, "-Y 99999999999999999999 +X 1"s})
        picture(4, ".hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + sides + "\n");
    for (const std::string& head :
         {"PF\n100000 100000\n-1\n"s, "P6 100000 100000 255\n"s, "P5 4294967295 4294967295 255\n"s})
        picture(7, head[1] == 'F' ? ".pfm" : ".ppm", head);
    for (const std::string& head :
         {"PF\n-1 4\n-1\n"s, "PF\n4 4\n0\n"s, "PF\n4 4\nnan\n"s, "PF\n4 4\n-1\n"s, "P6 0 0 255\n"s,
          "P6 4 4 7\n"s, "P6 4 4 99999\n"s, "P6 x y z\n"s, "P6"s, "P7\n"s})
        picture(4, head[1] == 'F' ? ".pfm" : ".ppm", head);
    for (const auto& [w, h] :
         {std::pair(0x7fffffffu, 0x80000000u), std::pair(0x7fffffffu, 0x7fffffffu),
          std::pair(0u, 0u), std::pair(0x80000000u, 1u)})
        picture(4, ".bmp",
                "BM"s + le32(100) + le32(0) + le32(54) + le32(40) + le32(w) + le32(h) +
                    "\1\0\x18\0"s + std::string(24, '\0'));
    for (const std::string& bytes : {""s, "GIF89a\1\0\1\0\0\0\0;"s, "II*\0\x08\0\0\0"s,
                                     "RIFF\x10\0\0\0WEBPVP8 "s, "NITF02.10"s, "<svg/>"s, "text"s,
                                     "\x76\x2f\x31\x01"s, "\xff\xd8\xff"s, "BM"s, "%PDF-1.4"s})
        picture(4, ".png", bytes);
}

void Maker::scripts() {
    for (const std::string& text : {"nonsense\n"s, "key\n"s, "key w -1\n"s, "key w 99999999999\n"s,
                                    "click 1\n"s, "click nan 0\n"s, "drag 1 2 3\n"s, "pause -1\n"s,
                                    "\x1b[31m\n"s, std::string(1000, 'k') + "\n"})
        add(Format::script, ".txt", 4, text);
}

void Maker::modules(const std::string& module) {
    for (int i = 0; i < 12; ++i)
        add(Format::module, ".so", 5,
            module.substr(0, module.size() * static_cast<std::size_t>(i) / 12));
    for (const std::size_t at :
         {4u, 5u, 16u, 18u, 32u, 40u, 54u, 56u, 60u}) { // fields of the ELF header
        std::string damaged = module;
        damaged[at] = '\x7f', damaged[at + 1] = '\x7f';
        if (at != 40u && at != 60u) add(Format::module, ".so", 5, damaged);
    }
}

} // namespace

std::vector<HostileFile> hostileFiles(const std::string& corpus, const std::string& module) {
    Maker maker;
    maker.scenes(), maker.infs(), maker.movies(), maker.meshes(), maker.libraries(),
        maker.scripts();
    maker.pictures(corpus);
    maker.modules(fileBytes(module));
    return std::move(maker.files);
}

} // namespace rt::faults
