// How legacy text is read: encodings, line ends, scanf numbers, names, comments, and the lenient rules.
#include <converters/statements.hpp>
#include <converters/text.hpp>
#include <tests/converters/converting.hpp>

namespace rt::converters {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(InfReading, CarriageReturnsTabsAndNoFinalNewline) {
    const Converted converted = convertText("window\t64 48\r\nscene 0 0 0\t100 100 100\r\ncamera 8 "
                                            "6 6 50 10 50 0 1 0 0 0 1\r\ndepth 7");
    EXPECT_EQ(converted.at("image.width").text, "64");
    EXPECT_EQ(converted.at("render.depth").text, "7");
}

TEST(InfReading, LineEndsMeanNothing) {
    EXPECT_EQ(convertText(kHead + "depth\n\n\n9\n").at("render.depth").text, "9");
    EXPECT_EQ(convertText(kHead + "depth 3 smooth 1 antiAliase 1").at("render.antialias").text,
              "fsaa4");
}

TEST(InfReading, AByteOrderMarkIsNoKeyword) {
    EXPECT_THAT(convertText("\xEF\xBB\xBF" + kHead).errors(), testing::IsEmpty());
}

TEST(InfReading, ChineseCommentsAreKept) {
    // GB18030 for 球, as a Chinese Windows writes it.
    const Converted converted = convertText(kHead + "#\xC7\xF2\n" + kSphere);
    EXPECT_THAT(converted.at("objects.0").comments->before, ElementsAre("球"));
    EXPECT_THAT(converted.notes(),
                Contains("- the file is not UTF-8; it is read as GB18030 (Chinese)"));
}

TEST(InfReading, BytesOfNoEncodingAreKeptAsLatin) {
    const Converted converted = convertText(kHead + "#caf\xE9 \xFF\n" + kSphere);
    EXPECT_THAT(converted.at("objects.0").comments->before, ElementsAre("café ÿ"));
}

TEST(InfReading, ControlCharactersInCommentsAreEscaped) {
    EXPECT_THAT(convertText(kHead +
                            "#a\x01"
                            "b\n" +
                            kSphere)
                    .at("objects.0")
                    .comments->before,
                ElementsAre("a\\x01b"));
}

TEST(InfReading, NumbersAsScanfReadsThem) {
    const Converted converted = convertText(kHead + "rs +1 -.5 5. 1e-1 1E+1 0.1\n");
    const scene::Node& light = converted.at("lights.0.point");
    EXPECT_EQ(light.find("position")->items[0].text, "1");
    EXPECT_EQ(light.find("position")->items[1].text, "-0.5");
    EXPECT_EQ(light.find("position")->items[2].text, "5");
    EXPECT_EQ(light.find("color")->items[0].text, "0.1");
    EXPECT_EQ(light.find("color")->items[1].text, "10");
}

TEST(InfReading, NumbersAreWrittenShortestRoundTrip) {
    for (const double value :
         {0.1, 1.0 / 3, 5e-324, 1.7976931348623157e308, 123456789.123456789, -0.0, 2.5e-7}) {
        const std::string text = shortest(value);
        Cursor cursor(std::make_shared<scene::Source>(scene::Source{"", text}));
        Number read;
        ASSERT_EQ(cursor.number(false, read), Cursor::Reading::number) << text;
        EXPECT_EQ(read.value, value) << text;
        EXPECT_EQ(std::signbit(read.value), std::signbit(value)) << text;
        EXPECT_TRUE(cursor.atEnd()) << text;
    }
}

TEST(InfReading, CommentsMayTouchTheWordBefore) {
    EXPECT_EQ(convertText(kHead + "depth 3#three\n").at("render.depth").comments->after, "three");
    EXPECT_EQ(convertText(kHead + "depth 3 #three\n").at("render.depth").comments->after, "three");
}

TEST(InfReading, TrailingNames) {
    // On the line: a name. On a line of its own: a name unless numbers follow or a keyword is near.
    const Converted converted =
        convertText(kHead + "sphere 1 2 3 4" + kMatte + " moon\nsphere 1 2 3 4" + kMatte +
                    "\nsun\nsphere 1 2 3 4" + kMatte + "\ndepth 3\n");
    EXPECT_EQ(converted.at("objects.0.sphere.name").text, "moon");
    EXPECT_EQ(converted.at("objects.1.sphere.name").text, "sun");
    EXPECT_EQ(converted.at("objects.2.sphere.name").text, "sphere_0");
    EXPECT_THAT(convertText(kHead + kSphere + "deph 3\n").errors(),
                ElementsAre("5:1 E0380 unknown keyword 'deph'; did you mean 'depth'?"));
    EXPECT_THAT(convertText(kHead + kSphere + "bounces 3\n").errors(),
                ElementsAre("5:1 E0380 unknown keyword 'bounces'"));
}

TEST(InfReading, NamesAreMadeFitAndUnique) {
    const Converted converted =
        convertText(kHead + "sphere 1 2 3 4" + kMatte + " a.b\nsphere 1 2 3 4" + kMatte +
                    " a_b\nsphere 1 2 3 4" + kMatte + " bounds\nsphere 1 2 3 4" + kMatte +
                    " sphere_0\n" + kSphere);
    std::vector<std::string> names;
    for (const scene::Node& object : converted.at("objects").items)
        names.push_back(object.members[0].value.find("name")->text);
    EXPECT_THAT(names, ElementsAre("a_b", "a_b_2", "bounds_2", "sphere_0", "sphere_1"));
    EXPECT_THAT(
        converted.notes(),
        Contains("4:68 'a.b' becomes 'a_b': names are letters, digits, - and _, each used once"));
}

TEST(InfReading, TheLastOfASettingWins) {
    const Converted converted = convertText(kHead + "depth 3\ndepth 4\n");
    EXPECT_EQ(converted.at("render.depth").text, "4");
    EXPECT_THAT(converted.at("render.depth").comments->before, ElementsAre("depth 3"));
    EXPECT_THAT(converted.notes(), Contains("4:1 line 5 replaces this 'depth'; kept as a comment"));
}

// ---- lenient ---------------------------------------------------------------------------------------------------

Converted lenient(const std::string& text) {
    InfOptions options;
    options.lenient = true;
    return convertText(text, options);
}

TEST(InfLenient, UnknownWordsAreSkippedWithANote) {
    const Converted converted = lenient(kHead + "nonsense 1 2 3\nlight 4 depth 5\n");
    EXPECT_EQ(converted.at("render.depth").text, "5");
    EXPECT_THAT(converted.notes(), Contains("4:1 skipped, as the original did: 'nonsense 1 2 3'"));
    EXPECT_THAT(converted.notes(), Contains("5:1 skipped, as the original did: 'light 4'"));
}

TEST(InfLenient, MissingMaterialNumbersAreThoseOfTheObjectBefore) {
    const Converted converted = lenient(
        kHead + kSphere + "sphere 1 2 3 4 0.25 0.5 # the rest as before\nsphere 5 6 7 8 1\n");
    EXPECT_EQ(converted.at("objects").items.size(), 3u);
    EXPECT_THAT(converted.notes(),
                Contains("5:1 'sphere': 'color b' and 14 more numbers are missing; kept from "
                         "before: 0.5 0.6 0.6 0.6 0 0 0 0 0 0 0.1 0.1 0.1 "
                         "-1 20"));
    const std::string second = converted.at("objects.1.sphere.material").text,
                      third = converted.at("objects.2.sphere.material").text;
    EXPECT_EQ(converted.at("materials." + second + ".color").items[0].text, "0.25");
    EXPECT_EQ(converted.at("materials." + third + ".color").items[0].text, "1");
    EXPECT_EQ(converted.at("materials." + third + ".color").items[1].text, "0.5");
}

TEST(InfLenient, NothingBeforeIsAnError) {
    EXPECT_THAT(lenient(kHead + "sphere 1 2 3 4 0.5\n").errors(),
                ElementsAre("4:1 E0383 'sphere': 'color g' and 15 more numbers are missing, and no "
                            "earlier statement has set them"));
}

TEST(InfLenient, NumbersThatEndInsideAWord) {
    // scanf's %d stops at the point; the rest is skipped as an unknown word.
    const Converted converted = lenient(kHead + "depth 3.5\nsmooth 1\n");
    EXPECT_EQ(converted.at("render.depth").text, "3");
    EXPECT_EQ(converted.at("render.smooth").text, "true");
    EXPECT_THAT(converted.notes(), Contains("4:8 skipped, as the original did: '.5'"));
}

TEST(InfLenient, UnknownModesMakeNoObject) {
    const Converted converted =
        lenient(kHead + "obj a.obj box smooth 1 2 3 4" + kMatte + "\n" + kSphere);
    EXPECT_EQ(converted.at("objects").items.size(), 1u);
    EXPECT_THAT(
        converted.notes(),
        Contains(
            "4:15 no object is made: the mode 'smooth' is none of 'normal', 'obj' and 'object'"));
}

TEST(InfLenient, AMissingMovieIsAStillPicture) {
    const Converted converted = lenient(kHead + "movie gone.inf\ndepth 3\n");
    ASSERT_TRUE(converted.document);
    EXPECT_EQ(converted.document->find("animation"), nullptr);
    EXPECT_THAT(converted.at("render.depth").comments->before, ElementsAre("movie gone.inf"));
}

TEST(InfLenient, MovieLinesThatMeanNothingAreLeftOut) {
    const ScratchFolder folder;
    InfOptions options;
    options.lenient = true;
    options.moviePath = folder.write(
        "Movie.inf", "movie 4 24\n0 spin 3 0 4\n0-7 move 1 2 3 0 4\n5 move 1 2 3 0 4\nfoo 3\n");
    const Converted converted = convertText(kHead + kSphere + kSphere, options);
    EXPECT_EQ(converted.at("animation.tracks").items.size(), 1u);
    EXPECT_EQ(converted.at("animation.tracks.0.target").items.size(), 2u);
    EXPECT_THAT(converted.notes(), Contains("2:3 unknown motion 'spin'; the line is left out"));
    EXPECT_THAT(converted.notes(), Contains(HasSubstr("3:1 there is no object 2")));
    EXPECT_THAT(converted.at("animation.tracks").comments->atEnd, ElementsAre("5 move 1 2 3 0 4"));
}

TEST(InfReading, MovieFilesAreToldFromScenes) {
    const ScratchFolder folder;
    EXPECT_TRUE(isMovieFile(
        folder.write("a.inf", "#Movie\nmovie\t288\t24\n0\trotate 1 2 3 0 0 1 6 0 9\n")));
    EXPECT_TRUE(isMovieFile(folder.write("b.inf", "3-6 rotate 1 2 3 0 0 1 6 0 9\n")));
    EXPECT_TRUE(isMovieFile(folder.write("c.inf", "camera v move 1 2 3 0 9\n")));
    EXPECT_FALSE(isMovieFile(folder.write("d.inf", kHead + "movie Movie.inf\n")));
    EXPECT_FALSE(isMovieFile(folder.write("e.inf", "movie Movie.inf\n" + kHead)));
    EXPECT_FALSE(isMovieFile(folder.write("f.inf", "")));
    EXPECT_FALSE(isMovieFile(folder.path("none.inf")));
}

} // namespace
} // namespace rt::converters
