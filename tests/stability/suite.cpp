// The short form of the suite: every family, as many trials as a continuous build can afford. `./dev stability` runs it in full.
#include <tests/stability/cases.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rt::stability {
namespace {

class Stability : public testing::TestWithParam<Case> {};

TEST_P(Stability, MeetsItsTargets) {
    Table table;
    GetParam().run(Load{}, table);
    EXPECT_FALSE(table.rows().empty());
    for (const Row& row : table.rows()) {
        if (row.worst)
            EXPECT_TRUE(row.met())
                << row.id << " " << row.what << ": " << *row.worst << " " << row.unit << " of "
                << row.limit << ", " << row.of << " looked at";
        else
            EXPECT_TRUE(row.met())
                << row.id << " " << row.what << ": " << row.wrong << " of " << row.of;
    }
}

INSTANTIATE_TEST_SUITE_P(Families, Stability, testing::ValuesIn(allCases()),
                         [](const auto& family) { return std::string(family.param.id); });

TEST(Table, KnowsWhatIsMet) {
    Table table;
    table.count("X", "nothing looked at", 0, 0);
    table.count("X", "one wrong", 1, 10);
    table.measure("X", "not a number", NAN, 1, "", 10);
    table.measure("X", "over", 2, 1, "", 10);
    for (const Row& row : table.rows()) EXPECT_FALSE(row.met()) << row.what;
    Table good;
    good.count("X", "none wrong", 0, 10);
    good.measure("X", "at the limit", 1, 1, "", 10);
    for (const Row& row : good.rows()) EXPECT_TRUE(row.met()) << row.what;
}

TEST(Table, BoundsAreThoseOfTheTextbook) {
    const auto bound = [](std::uint64_t wrong, std::uint64_t of) {
        Table table;
        table.count("X", "", wrong, of);
        return table.rows()[0].bound();
    };
    EXPECT_NEAR(bound(0, 1000), 0.003, 0.00001); // the rule of three: -ln 0.05
    EXPECT_NEAR(bound(1, 1000), 0.00474, 0.00001);
    EXPECT_NEAR(bound(10, 1000), 0.01696, 0.00001);
    EXPECT_NEAR(bound(400, 1'000'000), 0.0004345, 0.0000001);
    EXPECT_EQ(bound(0, 0), 1);
}

} // namespace
} // namespace rt::stability
