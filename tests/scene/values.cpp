// What texts mean, and that the table of the language is sound.
#include <core/numeric/colour.hpp>
#include <core/scene/language.hpp>
#include <core/scene/map_reader.hpp>
#include <core/scene/values.hpp>
#include <tests/scene/scene_text.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>

namespace rt::scene::test {
namespace {

TEST(Values, AnglesCarryTheirUnit) {
    const auto angle = [](const std::string& text) {
        return described(kHead + "objects: [sphere: {radius: 1, rotate: {angle: " + text + "}}]\n")
            .objects[0]
            .placement.rotations[0]
            .angle.value;
    };
    EXPECT_EQ(angle("90deg"), std::numbers::pi / 2);
    EXPECT_EQ(angle("-0.5 rad"), -0.5);
    EXPECT_EQ(angle("+1e1deg"), 10 * numeric::kRadiansPerDegree);
    EXPECT_EQ(angle(".5rad"), 0.5);
}

TEST(Values, ColorsAreLinear) {
    const auto color = [](const std::string& text) {
        return described(kHead + "background: {color: " + text + "}\n").background.color;
    };
    EXPECT_EQ(color("0.25"), (LinearRgb{0.25, 0.25, 0.25}));
    EXPECT_EQ(color("[0.1, 2, 0]"), (LinearRgb{0.1, 2, 0}));
    EXPECT_EQ(color("\"#ff8000\""), (LinearRgb{1, numeric::linearFromSrgb(128 / 255.0), 0}));
    EXPECT_EQ(color("\"#FFFFFF\""), (LinearRgb{1, 1, 1}));
}

TEST(Values, NumbersAreDecimal) {
    const auto radius = [](const std::string& text) {
        return std::get<double>(described(kHead + "objects: [sphere: {radius: " + text + "}]\n")
                                    .objects[0]
                                    .shape.values[1]
                                    .data);
    };
    EXPECT_EQ(radius("0.1"), 0.1);
    EXPECT_EQ(radius("+2."), 2);
    EXPECT_EQ(radius(".5"), 0.5);
    EXPECT_EQ(radius("1E-3"), 1.0 / 1000);
    EXPECT_EQ(radius("4.35"), 4.35);
}

TEST(Values, FilesStartAtTheFolderOfTheScene) {
    const Description description =
        described(kHead + "objects: [mesh: {file: model/a.OBJ.gz}, mesh: {file: /data/b.obj}, "
                          "mesh: {file: c.x, loader: openmesh}]\n");
    const auto file = [&](std::size_t i) {
        return std::get<std::string>(description.objects[i].shape.values[0].data);
    };
    EXPECT_EQ(file(0), "/scenes/model/a.OBJ.gz");
    EXPECT_EQ(file(1), "/data/b.obj");
    EXPECT_EQ(description.objects[0].loader->type, "openmesh");
    EXPECT_EQ(description.objects[2].loader->type, "openmesh");
    EXPECT_EQ(std::get<std::int64_t>(description.objects[0].loader->values[0].data), 0);
}

TEST(Values, TransformsScaleThenTurnThenMove) {
    const Description description =
        described(kHead + "objects: [sphere: {radius: 1, scale: [2, 1, 1], rotate: [{axis: [0, 0, "
                          "1], angle: 90deg}, {axis: [1, 0, 0], angle: 90deg}], "
                          "translate: [5, 6, 7]}]\n");
    // (1, 0, 0) -> (2, 0, 0) -> (0, 2, 0) -> (0, 0, 2) -> (5, 6, 9)
    const Vec3 point = description.objects[0].worldFromObject.point({1, 0, 0});
    const double error =
        8 * 2 *
        std::numeric_limits<
            double>::epsilon(); // two rotations of a vector of length 2, then a sum below 16
    EXPECT_NEAR(point.x, 5, error);
    EXPECT_NEAR(point.y, 6, error);
    EXPECT_NEAR(point.z, 9, error);
}

TEST(Values, TheFieldOfViewIsVertical) {
    const Description description =
        described("rt: 1\nimage: {width: 300, height: 100}\n"
                  "camera: {position: [1, 0, 0], look_at: [1, 5, 0], field_of_view: 90deg}\n");
    EXPECT_DOUBLE_EQ(description.camera.screenHeight, 2);
    EXPECT_DOUBLE_EQ(description.camera.screenWidth, 6);
    EXPECT_EQ(description.camera.screenDistance, 1);
    EXPECT_EQ(description.camera.forward, Vec3(0, 5, 0));
}

TEST(Values, AMaterialWithoutSharesIsDiffuse) {
    const Description description = described(
        kHead + "materials: {red: {color: [1, 0, 0]}, glass: {transmission: 0.9, ior: 1.5}}\n");
    EXPECT_EQ(description.materials[0].diffuse, LinearRgb::grey(1));
    EXPECT_EQ(description.materials[1].diffuse, LinearRgb::grey(0));
}

TEST(Values, NamesAreInventedWhereTheyAreMissing) {
    const Description description =
        described(kHead + "objects: [sphere: {radius: 1}, mesh: {}, sphere: {name: sphere_2, "
                          "radius: 1}, sphere: {radius: 1}, "
                          "sphere: {radius: 1, material: {ior: 2}}]\n");
    std::vector<std::string> names;
    for (const Object& object : description.objects) names.push_back(object.name);
    EXPECT_EQ(names,
              (std::vector<std::string>{"sphere_0", "mesh_0", "sphere_2", "sphere_3", "sphere_4"}));
    EXPECT_EQ(description.materials[*description.objects[4].material].name, "sphere_4.material");
}

TEST(Values, MergedAndRepeatedNodesCount) {
    const Description description =
        described(kHead + "objects:\n  - sphere: &ball {radius: 3, center: [1, 2, 3]}\n  - sphere: "
                          "{<<: *ball, radius: 4}\n");
    EXPECT_EQ(std::get<Vec3>(description.objects[1].shape.values[0].data), Vec3(1, 2, 3));
    EXPECT_EQ(std::get<double>(description.objects[1].shape.values[1].data), 4);
}

/// Every field, those of maps inside too. sameStruct: only those that fill the same struct.
void forEach(std::span<const Field> list, bool sameStruct,
             const std::function<void(const Field&)>& visit) {
    for (const Field& field : list) {
        visit(field);
        const bool isSame = field.form == Form::section || field.form == Form::choiceOrOne;
        if (isSame || !sameStruct) forEach(field.fields, sameStruct, visit);
    }
}

TEST(Language, EveryRowIsASentenceWithSoundLimitsAndDefault) {
    std::size_t rows = 0;
    for (const Section& section : sections())
        forEach(section.fields, false, [&](const Field& field) {
            const std::string_view doc = field.row.doc;
            EXPECT_TRUE(doc.ends_with('.')) << field.row.name << ": " << doc;
            EXPECT_LE(field.row.min, field.row.max) << field.row.name;
            if (field.row.fallback && *field.row.fallback && field.row.type < kTypeMap) {
                EXPECT_TRUE(std::holds_alternative<Value>(parseFallback(field.row)))
                    << field.row.name;
            }
            ++rows;
        });
    EXPECT_GT(rows, 60u);
}

template <class T>
void expectDefaultsOf(std::span<const Field> fields, const std::set<std::string>& withoutDefault) {
    const T fresh{};
    T defaulted{};
    applyDefaults(fields, &defaulted);
    forEach(fields, true, [&](const Field& field) {
        if (!field.fetch || withoutDefault.count(field.row.name)) return;
        const Node a = nodeOf(field.fetch(&fresh), field.row),
                   b = nodeOf(field.fetch(&defaulted), field.row);
        EXPECT_EQ(a.text, b.text) << field.row.name;
        EXPECT_EQ(a.items.size(), b.items.size()) << field.row.name;
        for (std::size_t i = 0; i < a.items.size() && i < b.items.size(); ++i)
            EXPECT_EQ(a.items[i].text, b.items[i].text) << field.row.name;
    });
}

TEST(Language, RowsAndStructsHaveTheSameDefaults) {
    expectDefaultsOf<Image>(imageFields(), {});
    expectDefaultsOf<Camera>(cameraFields(),
                             {"field_of_view"}); // only when the scene states no screen
    expectDefaultsOf<Render>(renderFields(), {});
    expectDefaultsOf<Background>(backgroundFields(), {});
    expectDefaultsOf<PointLight>(pointLightFields(), {});
    expectDefaultsOf<Material>(materialFields(), {});
    expectDefaultsOf<Animation>(animationFields(), {});
}

} // namespace
} // namespace rt::scene::test
