// Command lines that nobody should have typed: the exit code, the sentence and the suggestion, word for word.
#include <tests/cli/run.hpp>

#include <algorithm>

namespace rt::cli_tests {

namespace {

struct Malformed {
    std::vector<std::string> arguments;
    std::string message; // all of stderr
};

const std::string kSize = "must be WIDTHxHEIGHT in pixels, such as 640x480";
const std::string kCrop =
    "must be X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1, such as 0,0,320,240";

std::vector<Malformed> malformed() {
    const std::string seeRender = "; see rt render --help\n", render = "rt render: error: ";
    const auto size = [&](const std::string& word) {
        return Malformed{{"render", "scene.yaml", "--size", word},
                         render + "--size: " + kSize + " (got '" + word + "')" + seeRender};
    };
    const auto threads = [&](const std::string& word) {
        return Malformed{{"render", "scene.yaml", "-t", word},
                         render + "--threads: must be a whole number from 0 to 1024 (got '" + word +
                             "')" + seeRender};
    };
    const auto crop = [&](const std::string& word) {
        return Malformed{{"render", "scene.yaml", "--crop", word},
                         render + "--crop: " + kCrop + " (got '" + word + "')" + seeRender};
    };
    const auto unknown = [&](const std::string& option, const std::string& hint) {
        return Malformed{{"render", "scene.yaml", option, "3"},
                         render + "there is no option '" + option + "'; " + hint + "\n"};
    };
    return {
        // commands
        {{}, "rt: error: a command is missing; try: rt render scene.yaml\n"},
        {{"-q"}, "rt: error: a command is missing; try: rt render scene.yaml\n"},
        {{"rendr", "scene.yaml"},
         "rt: error: there is no command 'rendr'; did you mean 'render'?\n"},
        {{"Render", "scene.yaml"},
         "rt: error: there is no command 'Render'; did you mean 'render'?\n"},
        {{"chekc"}, "rt: error: there is no command 'chekc'; did you mean 'check'?\n"},
        {{"zzz"}, "rt: error: there is no command 'zzz'; see rt --help\n"},
        {{""}, "rt: error: there is no command ''; see rt --help\n"},
        {{"scene.yaml"},
         "rt: error: there is no command 'scene.yaml'; to draw a scene: rt render scene.yaml\n"},
        {{"old.inf"},
         "rt: error: there is no command 'old.inf'; to convert a scene: rt convert old.inf\n"},
        {{"a\033[31mb"}, "rt: error: there is no command 'a\\x1b[31mb'; see rt --help\n"},
        {{"--versoin"}, "rt: error: there is no option '--versoin'; did you mean '--version'?\n"},
        {{"help", "rendr"},
         "rt help: error: must be render, encode, farm, task, view, bench, check, info, schema, "
         "convert, "
         "mesh, compare, plugins, "
         "new, "
         "explain, "
         "completion, "
         "version or help (got 'rendr'); did you mean 'render'?\n"},
        {{"help", "render", "check"},
         "rt help: error: 'check' is one argument too many; see rt help --help\n"},
        // arguments
        {{"render"}, "rt render: error: SCENE is missing; try: rt render scene.yaml\n"},
        {{"render", "--preview"},
         "rt render: error: SCENE is missing; try: rt render scene.yaml\n"},
        {{"render", "a.yaml", "b.yaml"},
         "rt render: error: 'b.yaml' is one argument too many; see rt render --help\n"},
        {{"render", "a.yaml", "render"},
         "rt render: error: 'render' is one argument too many; see rt render --help\n"},
        {{"check"}, "rt check: error: SCENE is missing; try: rt check scene.yaml\n"},
        {{"info"}, "rt info: error: SCENE is missing; try: rt info scene.yaml\n"},
        {{"convert"}, "rt convert: error: FILE is missing; try: rt convert Scene.inf\n"},
        {{"bunny.ply"},
         "rt: error: there is no command 'bunny.ply'; to look at a mesh: rt info bunny.ply\n"},
        {{"mesh"}, "rt mesh: error: ACTION is missing; try: rt mesh repair in.obj -o out.obj\n"},
        {{"mesh", "repair"},
         "rt mesh: error: MESH is missing; try: rt mesh repair in.obj -o out.obj\n"},
        {{"mesh", "in.obj", "-o", "out.obj"},
         "rt mesh: error: MESH is missing; try: rt mesh repair in.obj -o out.obj\n"},
        {{"mesh", "repiar", "in.obj", "-o", "out.obj"},
         "rt mesh: error: must be repair (got 'repiar'); did you mean 'repair'?\n"},
        {{"mesh", "repair", "in.obj"},
         "rt mesh: error: --output or --report is missing; try: rt mesh repair in.obj -o "
         "repaired.obj\n"},
        {{"mesh", "repair", "in.obj", "-o", "-", "--report", "-"},
         "rt mesh: error: --output and --report both want stdout; see rt mesh --help\n"},
        {{"mesh", "repair", "in.obj", "-o", "a.obj", "--report", "a.obj"},
         "rt mesh: error: --output and --report name the same file; see rt mesh --help\n"},
        {{"info", "in.obj", "--full"},
         "rt info: error: --full is for scenes, and 'in.obj' is a mesh; see rt info --help\n"},
        {{"info", "in.obj", "--set", "a=1"},
         "rt info: error: --set is for scenes, and 'in.obj' is a mesh; see rt info --help\n"},
        {{"compare"}, "rt compare: error: A is missing; try: rt compare a.png b.png\n"},
        {{"compare", "a.png"}, "rt compare: error: B is missing; try: rt compare a.png b.png\n"},
        {{"compare", "a", "b", "c"},
         "rt compare: error: 'c' is one argument too many; see rt compare --help\n"},
        {{"plugins", "a", "b"},
         "rt plugins: error: 'b' is one argument too many; see rt plugins --help\n"},
        {{"completion"},
         "rt completion: error: SHELL is missing; try: rt completion bash > "
         "~/.local/share/bash-completion/completions/rt\n"},
        {{"completion", "bsh"},
         "rt completion: error: must be bash, zsh or fish (got 'bsh'); did you mean 'bash'?\n"},
        {{"completion", "cmd"},
         "rt completion: error: must be bash, zsh or fish (got 'cmd'); see rt completion --help\n"},
        {{"schema", "x"}, "rt schema: error: 'x' is one argument too many; see rt schema --help\n"},
        {{"version", "x"},
         "rt version: error: 'x' is one argument too many; see rt version --help\n"},
        // options
        unknown("--siez", "did you mean '--size'?"),
        unknown("--width", "did you mean '--size'?"),
        unknown("-W", "did you mean '--size'?"),
        unknown("--samples", "did you mean '--antialias'?"),
        unknown("--jobs", "did you mean '--threads'?"),
        unknown("--anti", "did you mean '--antialias'?"),
        unknown("--zap", "see rt render --help"),
        unknown("-x", "see rt render --help"),
        {{"render", "scene.yaml", "--zap=3"},
         "rt render: error: there is no option '--zap'; see rt render --help\n"},
        {{"--size", "3x3", "render", "a.yaml"},
         "rt render: error: --size belongs behind the command; try: rt render --size\n"},
        {{"check", "--size", "3x3"},
         "rt check: error: there is no option '--size'; see rt check --help\n"},
        {{"render", "scene.yaml", "-o"}, render + "--output needs a value" + seeRender},
        {{"render", "scene.yaml", "--size"}, render + "--size needs a value" + seeRender},
        {{"render", "scene.yaml", "--preview=3"}, render + "--preview takes no value" + seeRender},
        {{"render", "scene.yaml", "--json-errors=yes", "-q"},
         render + "--json-errors takes no value" + seeRender},
        {{"render", "scene.yaml", "--stats", "x.json"},
         render + "'x.json' is one argument too many" + seeRender},
        {{"render", "scene.yaml", "--size", "--preview"},
         render + "--size: " + kSize + " (got '--preview')" + seeRender},
        // values
        size("640"),
        size("640x"),
        size("x480"),
        size("0x480"),
        size("640x480x3"),
        size("010x010"),
        size("0x10x10"),
        size("1e3x1e3"),
        size("-1x-1"),
        size("+640x480"),
        size("640X480"),
        size(" 640x480"),
        size("99999999999x1"),
        size("4294967297x1"),
        size("nanxnan"),
        size("6,4x4"),
        threads("-4"),
        threads("four"),
        threads("1.5"),
        threads("1025"),
        threads("08"),
        threads("0x4"),
        threads(""),
        crop("0,0,10"),
        crop("10,10,0,0"),
        crop("0,0,0,10"),
        crop("0;0;10;10"),
        crop("-1,0,10,10"),
        crop("0,0,10,10,"),
        crop("0,0,1e1,10"),
        {{"render", "scene.yaml", "--antialias", "grid=0"},
         render + "--antialias: must be a whole number from 1 to 64 (got '0')" + seeRender},
        {{"render", "scene.yaml", "--antialias", "max_error=nan"},
         render + "--antialias: must be a number from 0 to 1 (got 'nan')" + seeRender},
        {{"render", "scene.yaml", "--antialias", "fsaa"},
         render + "--antialias: must be none, fsaa4, grid=N or max_error=E (got 'fsaa'); did you "
                  "mean 'fsaa4'?\n"},
        {{"render", "scene.yaml", "--shade", "nromals"},
         render + "--shade: must be full, normals, depth, id or cost (got 'nromals'); did you mean "
                  "'normals'?\n"},
        {{"render", "scene.yaml", "--format", "gif"},
         render + "--format: must be png, jpg, jpeg, bmp, exr or pfm (got 'gif')" + seeRender},
        {{"render", "scene.yaml", "--set", "depth"},
         render + "--set: must be PATH=VALUE, such as render.depth=3 (got 'depth')" + seeRender},
        {{"render", "scene.yaml", "--set", "=3"},
         render + "--set: must be PATH=VALUE, such as render.depth=3 (got '=3')" + seeRender},
        {{"render", "scene.yaml", "--pixel", "3,4"},
         render + "--pixel needs --trace; such as --pixel 320,240 --trace\n"},
        {{"render", "scene.yaml", "--trace"},
         render + "--trace needs --pixel X,Y; such as --pixel 320,240 --trace\n"},
        {{"compare", "a", "b", "--tolerance", "nan"},
         "rt compare: error: --tolerance: must be a number from 0 to 1 (got 'nan'); see rt compare "
         "--help\n"},
        {{"compare", "a", "b", "--tolerance", "1e400"},
         "rt compare: error: --tolerance: must be a number from 0 to 1 (got '1e400'); see rt "
         "compare --help\n"},
        {{"compare", "a", "b", "--tolerance", "0,1"},
         "rt compare: error: --tolerance: must be a number from 0 to 1 (got '0,1'); see rt compare "
         "--help\n"},
        {{"convert", "a.inf", "b.inf", "-o", "c.yaml"},
         "rt convert: error: --output is for one FILE only; see rt convert --help\n"},
        {{"convert", "a.inf", "b.inf", "--movie", "m.inf"},
         "rt convert: error: --movie is for one FILE only; see rt convert --help\n"},
        {{"convert", "a.inf", "--window-order", "wh"},
         "rt convert: error: --window-order: must be auto, width_height or height_width (got "
         "'wh'); see rt convert --help\n"},
        {{"convert", "a.inf", "--json-notes", "-o", "-"},
         "rt convert: error: --json-notes and -o - both want stdout; see rt convert --help\n"},
    };
}

} // namespace

using MalformedCommandLine = Cli;

TEST_F(MalformedCommandLine, IsRefusedWithASentenceAndExitCode2) {
    const auto table = malformed();
    EXPECT_GE(table.size(), 40u);
    for (const Malformed& line : table) {
        SCOPED_TRACE(testing::PrintToString(line.arguments));
        const Outcome outcome = run(line.arguments);
        EXPECT_EQ(outcome.exitCode, 2);
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(outcome.err, line.message);
    }
    EXPECT_EQ(files(), std::vector<std::string>());
}

TEST_F(MalformedCommandLine, IsSaidAsJsonWhenAskedFor) {
    const Outcome outcome = rt("render scene.yaml --siez 3x3 --json-errors");
    EXPECT_EQ(outcome.exitCode, 2);
    EXPECT_EQ(
        outcome.err,
        R"({"severity":"error","exit":2,"message":"there is no option '--siez'","suggestion":"did you mean '--size'?"})"
        "\n");
}

TEST_F(MalformedCommandLine, MessagesAreReadable) {
    for (const Malformed& line : malformed()) {
        EXPECT_LE(line.message.size(), 80u * 24u);
        EXPECT_EQ(std::count(line.message.begin(), line.message.end(), '\n'), 1) << line.message;
    }
}

TEST_F(MalformedCommandLine, VeryLongWordsAreCut) {
    const Outcome outcome = run({"render", "scene.yaml", "--size", std::string(100'000, '9')});
    EXPECT_EQ(outcome.exitCode, 2);
    EXPECT_LT(outcome.err.size(), 300u);
}

} // namespace rt::cli_tests
