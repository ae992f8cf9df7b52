// What the suite measured: one row per case, held against its target.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rt::stability {

struct Row {
    std::string id;   // of the case's family: S1, T8
    std::string what; // shape, size, aim
    std::uint64_t wrong = 0, of = 0;
    std::optional<double> worst; // where an error is measured
    double limit = 0;            // of `worst`
    std::string unit;            // of both

    /// Something was looked at, nothing was wrong, and no error is over its limit.
    bool met() const;
    /// Upper end of the 95 % confidence interval of the share of wrong ones [Clopper, Pearson 1934].
    double bound() const;
};

class Table {
public:
    void count(std::string id, std::string what, std::uint64_t wrong, std::uint64_t of);
    void measure(std::string id, std::string what, double worst, double limit, std::string unit,
                 std::uint64_t of);
    const std::vector<Row>& rows() const { return rows_; }

private:
    std::vector<Row> rows_;
};

/// `title` as the heading, a line of `facts`, one table.
std::string asMarkdown(const std::string& title, const std::string& facts, const Table& table);
std::string asJson(const std::string& facts, const Table& table);

} // namespace rt::stability
