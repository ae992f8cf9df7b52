#include <tests/stability/table.hpp>

#include <nlohmann/json.hpp>

#include <array>
#include <charconv>
#include <cmath>

namespace rt::stability {

namespace {

constexpr double kConfidence = 0.95;

/// P(at most k of n) where each is wrong with probability p; k is small, n large: Poisson.
double atMost(std::uint64_t k, double mean) {
    double term = std::exp(-mean), sum = term;
    for (std::uint64_t i = 1; i <= k; ++i) sum += term *= mean / static_cast<double>(i);
    return sum;
}

std::string digits(double value) {
    std::array<char, 32> text;
    const auto end =
        std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 3)
            .ptr;
    return {text.data(), end};
}

} // namespace

bool Row::met() const { return of > 0 && wrong == 0 && !(worst && !(*worst <= limit)); }

double Row::bound() const {
    if (of == 0) return 1;
    const auto n = static_cast<double>(of), k = static_cast<double>(wrong);
    constexpr std::uint64_t kFew = 100;
    if (wrong > kFew) { // [Wilson, Hilferty 1931]
        const double root = 1 - 1 / (9 * (k + 1)) + 1.6449 / (3 * std::sqrt(k + 1));
        return std::min(1.0, (k + 1) * root * root * root / n);
    }
    double low = k, high = 3 * k + 10;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (atMost(wrong, middle) > 1 - kConfidence ? low : high) = middle;
    }
    return std::min(1.0, high / n);
}

void Table::count(std::string id, std::string what, std::uint64_t wrong, std::uint64_t of) {
    rows_.push_back({std::move(id), std::move(what), wrong, of, std::nullopt, 0, ""});
}

void Table::measure(std::string id, std::string what, double worst, double limit, std::string unit,
                    std::uint64_t of) {
    rows_.push_back({std::move(id), std::move(what), 0, of, worst, limit, std::move(unit)});
}

std::string asMarkdown(const std::string& title, const std::string& facts, const Table& table) {
    std::string text = "# " + title + "\n\n" + facts + "\n\n";
    text += "| id | case | wrong | of | 95 % bound | worst | target | met |\n"
            "|---|---|---:|---:|---:|---:|---:|---|\n";
    for (const Row& r : table.rows()) {
        text += "| " + r.id + " | " + r.what + " | ";
        if (r.worst)
            text += "| " + std::to_string(r.of) + " | | " + digits(*r.worst) + " " + r.unit +
                    " | <= " + digits(r.limit) + " | ";
        else
            text += std::to_string(r.wrong) + " | " + std::to_string(r.of) + " | " +
                    digits(r.bound()) + " | | 0 | ";
        text += r.met() ? "yes |\n" : "**no** |\n";
    }
    return text;
}

std::string asJson(const std::string& facts, const Table& table) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const Row& r : table.rows()) {
        nlohmann::ordered_json row{{"id", r.id}, {"case", r.what}, {"of", r.of}};
        if (r.worst)
            row["worst"] = *r.worst, row["limit"] = r.limit, row["unit"] = r.unit;
        else
            row["wrong"] = r.wrong, row["bound"] = r.bound();
        row["met"] = r.met();
        rows.push_back(std::move(row));
    }
    return nlohmann::ordered_json{{"facts", facts}, {"rows", std::move(rows)}}.dump(2) + "\n";
}

} // namespace rt::stability
