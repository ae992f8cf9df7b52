// Differential fuzzing: small scenes of everything at random, drawn with and without the octree's cuts, on 1, 8 and 64 threads,
// with every SIMD level of this machine, and with a C library that sees neither FMA nor AVX2. Not one pixel may differ.
#include <tests/faults/faults.hpp>

#include <random>

namespace rt::faults {
namespace {

/// A scene from a seed: shapes, materials, lights, textures, some of them coincident, tiny, huge or inside each other.
class SceneMaker {
public:
    explicit SceneMaker(unsigned seed) : random_(seed) {}

    std::string make() {
        std::string text = "rt: 1\nimage: {width: 40, height: 30}\n";
        text += "camera: {position: " + vector(-2, 2, "-6") + ", look_at: " + vector(-1, 1) +
                ", field_of_view: " + number(20, 100) + "deg}\n";
        text += std::string("render: {depth: ") + std::to_string(random_() % 6) +
                ", antialias: " + pick({"none", "fsaa4", "{grid: 2}"}) + "}\n";
        text += "background: {color: " + color() + "}\n";
        text += "textures:\n  c: {checker: {}}\n  n: {noise: {}}\nlights:\n";
        for (unsigned i = random_() % 3 + 1; i > 0; --i)
            text += "  - point: {position: " + vector(-8, 8) + ", color: " + color() + "}\n";
        text += "materials:\n";
        for (int i = 0; i < 4; ++i)
            text += "  m" + std::to_string(i) + ": {diffuse: " + number(0, 1) +
                    ", specular: " + number(0, 1) + ", shininess: " + number(0, 60) +
                    (i % 2 ? ", transmission: " + number(0, 1) + ", ior: " + number(0.5, 2.5)
                           : ", texture: " + pick({"c", "n"})) +
                    "}\n";
        text += "objects:\n";
        for (unsigned i = random_() % 12 + 1; i > 0; --i) text += "  - " + object() + "\n";
        return text;
    }

private:
    std::string number(double from, double to) {
        return std::to_string(from + (to - from) * static_cast<double>(random_()) /
                                         std::minstd_rand::max());
    }
    std::string coordinate(double from, double to) { // whole numbers make things touch
        return random_() % 3 == 0 ? std::to_string(static_cast<int>(random_() % 5) - 2)
                                  : number(from, to);
    }
    std::string vector(double from, double to, const std::string& y = "") {
        const std::string x = coordinate(from, to), middle = y.empty() ? coordinate(from, to) : y;
        return "[" + x + ", " + middle + ", " + coordinate(from, to) + "]";
    }
    std::string color() {
        return "[" + number(0, 1) + ", " + number(0, 1) + ", " + number(0, 1) + "]";
    }
    std::string pick(const std::vector<std::string>& words) {
        return words[random_() % words.size()];
    }
    std::string object() {
        std::string common = ", material: m" + std::to_string(random_() % 4);
        if (random_() % 3 == 0) common += ", translate: " + vector(-1, 1);
        if (random_() % 3 == 0)
            common += ", rotate: {axis: [1, " + number(-1, 1) + ", " + number(-1, 1) +
                      "], angle: " + number(-180, 180) + "deg}";
        if (random_() % 4 == 0)
            common += ", scale: [" + number(0.2, 2) + ", " + number(0.2, 2) + ", " +
                      number(-2, -0.2) + "]";
        const std::string radius = pick({"1", "0.5", number(0.1, 2), "0.000001", "1000"});
        switch (random_() % 7) {
        case 0:
        case 1:
            return "sphere: {center: " + vector(-2, 2) + ", radius: " + radius + common + "}";
        case 2:
            return "parallelogram: {origin: " + vector(-2, 2) + ", edge_u: [" + number(0.5, 4) +
                   ", 0, 1], edge_v: [0, " + number(0.5, 4) + ", 0]" + common + "}";
        case 3:
            return "box: {min: [-1, -1, -1], max: [" + number(0, 1) + ", 1, " + number(0, 1) + "]" +
                   common + "}";
        case 4:
            return "torus: {" + common.substr(2) + "}";
        case 5:
            return "sphereflake: {levels: 2" + common + "}";
        default: {
            std::string vertices, faces;
            const unsigned count = random_() % 20 + 3;
            for (unsigned i = 0; i < count; ++i) vertices += (i ? ", " : "") + vector(-2, 2);
            for (unsigned i = 0; i + 2 < count; ++i)
                faces += (i ? ", [" : "[") + std::to_string(i) + ", " + std::to_string(i + 1) +
                         ", " + std::to_string(i + 2) + "]";
            return "mesh: {vertices: [" + vertices + "], faces: [" + faces + "]" + common + "}";
        }
        }
    }

    std::minstd_rand random_;
};

} // namespace

using SamePicture = Faults;

/// 2000 with RT_FAULTS_FULL, else 20.
TEST_F(SamePicture, OfRandomScenes) {
    int drawn = 0;
    for (unsigned seed = 1; seed <= (isFull() ? 2000u : 20u); ++seed) {
        const std::string text = SceneMaker(seed).make();
        write("s.yaml", text);
        const auto first = rt("render s.yaml -q -o 1.pfm -t 1");
        if (first.exitCode == 3) continue; // a camera in a corner, a mesh without area
        ASSERT_EQ(first.exitCode, 0) << first.err << text;
        const std::string picture = read("1.pfm");
        const struct {
            std::string options, variable;
        } others[] = {{"-t 8", ""},
                      {"-t 64", ""},
                      {"--set render.octree={max_objects: 1000000}", ""},
                      {"--set render.octree={max_objects: 1}", ""},
                      {"", "RT_SIMD=baseline"},
                      {"", "RT_SIMD=avx2"},
                      {"", "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2"}};
        for (const auto& other : others) {
            cli_tests::RunOptions run;
            if (!other.variable.empty()) run.environment = {other.variable};
            std::vector<std::string> arguments{"render", "s.yaml", "-q", "-o", "n.pfm"};
            const std::size_t blank = other.options.find(' ');
            if (blank != std::string::npos)
                arguments.insert(arguments.end(),
                                 {other.options.substr(0, blank), other.options.substr(blank + 1)});
            const auto outcome = Cli::run(arguments, run);
            ASSERT_EQ(outcome.exitCode, 0) << outcome.err << other.options;
            EXPECT_EQ(read("n.pfm") == picture, true)
                << "seed " << seed << ": " << other.options << other.variable << "\n"
                << text;
        }
        ++drawn;
    }
    std::printf("%d scenes, each in 8 ways\n", drawn);
    EXPECT_GT(drawn, 10);
}

} // namespace rt::faults
