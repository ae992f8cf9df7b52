#include <core/report/pages.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace rt::report {

namespace {

using Json = nlohmann::ordered_json;

std::string digits(double value, int significant = 3) {
    if (const double size = std::fabs(value);
        size >= 1000 && size < 10'000'000) // 1420, not 1.42e+03
        significant = std::max(significant, static_cast<int>(std::log10(size)) + 1);
    std::array<char, 48> text;
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                   std::chars_format::general, significant)
                         .ptr;
    return {text.data(), end};
}

std::string padded(std::string text, std::size_t width, bool left = false) {
    if (text.size() < width) text.insert(left ? text.size() : 0, width - text.size(), ' ');
    return text;
}

std::string interval(const Row& row) {
    if (row.isDefault) return "1 (default)";
    return digits(row.ratio.low) + " - " + digits(row.ratio.high);
}

std::string labelOf(const Row& row) {
    return row.panel == 'A' && row.scale != 1 ? row.name + ", scale " + digits(row.scale)
                                              : row.name;
}

/// Wrong pixels of a million; none is drawn at the 95 % bound, 3 of all that were looked at.
double wrongPerMillion(const Row& row) {
    const double pixels = std::max<double>(1, static_cast<double>(row.error->pixels));
    return 1e6 * (row.error->over ? static_cast<double>(row.error->over) : 3) / pixels;
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

// ---- plots ------------------------------------------------------------------------------------

struct Dot {
    double x, y;
    std::string label, hover, line; // dots of one line are joined
    bool onFront, none;             // none: nothing was wrong, y is a bound
};

struct LogAxis {
    double low, high; // decades
    double from, to;  // on the paper

    double at(double value) const {
        return from + (std::log10(value) - low) / (high - low) * (to - from);
    }
};

LogAxis axisOver(double smallest, double greatest, double from, double to) {
    LogAxis axis{std::floor(std::log10(smallest) * 4 - 0.2) / 4,
                 std::ceil(std::log10(greatest) * 4 + 0.2) / 4, from, to};
    if (axis.high - axis.low < 0.5) axis.high = axis.low + 0.5;
    return axis;
}

/// 1, 2 and 5 of each decade while that is few.
std::vector<double> ticks(const LogAxis& axis) {
    std::vector<double> all;
    for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high; ++decade)
        for (const double step : {1.0, 2.0, 5.0}) {
            if (step != 1 && axis.high - axis.low > 2.5) continue;
            const double value = step * std::pow(10.0, decade);
            if (std::log10(value) >= axis.low && std::log10(value) <= axis.high)
                all.push_back(value);
        }
    return all;
}

/// What is taken on the paper, so that no two labels are on one another.
struct Places {
    struct Rectangle {
        double x, y, width, height;
    };
    std::vector<Rectangle> taken;
    double left, right;

    void take(const Rectangle& r) { taken.push_back(r); }
    bool takeFree(const Rectangle& r) {
        if (r.x < left || r.x + r.width > right) return false;
        for (const Rectangle& t : taken)
            if (r.x < t.x + t.width && t.x < r.x + r.width && r.y < t.y + t.height &&
                t.y < r.y + r.height)
                return false;
        take(r);
        return true;
    }
};

std::string scatter(const std::string& title, const std::string& xName, const std::string& yName,
                    const std::vector<Dot>& dots) {
    constexpr double kWidth = 760, kHeight = 420, kLeft = 76, kRight = 30, kTop = 40, kBottom = 56;
    const auto [smallX, largeX] = std::minmax_element(
        dots.begin(), dots.end(), [](const Dot& a, const Dot& b) { return a.x < b.x; });
    const auto [smallY, largeY] = std::minmax_element(
        dots.begin(), dots.end(), [](const Dot& a, const Dot& b) { return a.y < b.y; });
    const LogAxis x = axisOver(smallX->x, largeX->x, kLeft, kWidth - kRight),
                  y = axisOver(smallY->y, largeY->y, kHeight - kBottom, kTop);
    const auto text = [](double px, double py, const char* anchor, const std::string& words,
                         const std::string& more = "") {
        return "<text x=\"" + digits(px, 6) + "\" y=\"" + digits(py, 6) + "\" text-anchor=\"" +
               anchor + "\"" + more + ">" + escaped(words) + "</text>\n";
    };
    const auto line = [](double x0, double y0, double x1, double y1, const char* kind) {
        return "<line x1=\"" + digits(x0, 6) + "\" y1=\"" + digits(y0, 6) + "\" x2=\"" +
               digits(x1, 6) + "\" y2=\"" + digits(y1, 6) + "\" class=\"" + kind + "\"/>\n";
    };
    std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 760 420\" "
                      "font-family=\"sans-serif\" font-size=\"12\">\n<style>.grid{stroke:#ddd}"
                      ".front{stroke:#c33;stroke-width:1.5;fill:none;stroke-dasharray:5 3}"
                      ".sweep{stroke:#9ab;fill:none}circle{fill:#567;stroke:#fff}"
                      "circle.on{fill:#c33}g:hover circle{stroke:#000;stroke-width:2}</style>\n"
                      "<rect width=\"760\" height=\"420\" fill=\"#fff\"/>\n";
    svg += text(kLeft, 22, "start", title, " font-size=\"15\"");
    for (const double v : ticks(x)) {
        svg += line(x.at(v), kTop, x.at(v), kHeight - kBottom, "grid");
        svg += text(x.at(v), kHeight - kBottom + 16, "middle", digits(v));
    }
    for (const double v : ticks(y)) {
        svg += line(kLeft, y.at(v), kWidth - kRight, y.at(v), "grid");
        svg += text(kLeft - 6, y.at(v) + 4, "end", digits(v));
    }
    svg += text((kLeft + kWidth - kRight) / 2, kHeight - 14, "middle", xName);
    svg += text(0, 0, "middle", yName,
                " transform=\"translate(16 " + digits((kTop + kHeight - kBottom) / 2, 6) +
                    ") rotate(-90)\"");
    const auto path = [&](const std::vector<const Dot*>& along, const char* kind) {
        std::string points;
        for (const Dot* d : along)
            points += digits(x.at(d->x), 6) + "," + digits(y.at(d->y), 6) + " ";
        return "<polyline class=\"" + std::string(kind) + "\" points=\"" + points + "\"/>\n";
    };
    std::vector<const Dot*> front;
    for (std::size_t i = 0; i < dots.size(); ++i) {
        if (dots[i].onFront) front.push_back(&dots[i]);
        if (dots[i].line.empty()) continue;
        std::vector<const Dot*> sweep;
        for (const Dot& d : dots)
            if (d.line == dots[i].line) sweep.push_back(&d);
        if (sweep[0] == &dots[i] && sweep.size() > 1) svg += path(sweep, "sweep");
    }
    std::sort(front.begin(), front.end(), [](const Dot* a, const Dot* b) { return a->x < b->x; });
    if (front.size() > 1) svg += path(front, "front");
    Places places{{}, kLeft, kWidth};
    for (const Dot& d : dots) places.take({x.at(d.x) - 5, y.at(d.y) - 5, 10, 10});
    // Right or left of the dot, above or below; nowhere where all of that is taken.
    const auto label = [&](const std::string& words, double px, double py) -> std::string {
        if (words.empty()) return "";
        constexpr double kLetter = 6.7; // width, on average
        const double width = kLetter * static_cast<double>(words.size());
        for (const double baseline : {py - 6, py + 16})
            for (const bool toLeft : {false, true})
                if (places.takeFree({toLeft ? px - 8 - width : px + 8, baseline - 10, width, 12}))
                    return text(px + (toLeft ? -8 : 8), baseline, toLeft ? "end" : "start", words);
        return "";
    };
    for (const Dot& d : dots) {
        const double px = x.at(d.x), py = y.at(d.y);
        svg += "<g><title>" + escaped(d.hover) + "</title>";
        if (d.none) {
            svg += line(px, py, px, py + 14, "front");
            if (places.takeFree({px - 14, py + 14, 28, 12}))
                svg += text(px, py + 24, "middle", "none");
        }
        svg += "<circle cx=\"" + digits(px, 6) + "\" cy=\"" + digits(py, 6) + "\" r=\"5\"" +
               (d.onFront ? " class=\"on\"" : "") + "/></g>\n";
        svg += label(d.label, px, py);
    }
    return svg + "</svg>\n";
}

std::string hoverOf(const Row& row) {
    return labelOf(row) + (row.flags.empty() ? "" : "\n" + row.flags) + "\n" +
           digits(row.wall.median * 1000) + " ms a frame, CPU " + digits(row.cpu.median * 1000) +
           " ms\nwrong pixels " + std::to_string(row.error->over) + ", RMSE " +
           digits(row.error->rmse) + ", largest " + digits(row.error->max);
}

std::string plotOf(const SceneReport& report, char panel) {
    std::vector<Dot> dots;
    for (const Row& row : report.rows) {
        if (row.panel != panel) continue;
        if (panel == 'A')
            dots.push_back({row.nanosecondsPerRay(), wrongPerMillion(row),
                            row.scale == 1 ? row.name : "", hoverOf(row), row.name, row.onFront,
                            row.error->over == 0});
        else if (panel == 'B' && row.error->rmse > 0)
            dots.push_back(
                {row.wall.median, row.error->rmse, row.name, hoverOf(row), "", row.onFront, false});
        else if (panel == 'C' && row.rays)
            dots.push_back({row.wall.median,
                            static_cast<double>(row.rays) /
                                (static_cast<double>(report.width) * report.height),
                            row.name, hoverOf(row), "", false, false});
    }
    if (dots.empty()) return "";
    if (panel == 'A')
        return scatter(report.scene + ": arithmetic", "CPU nanoseconds per ray",
                       "wrong pixels of a million", dots);
    if (panel == 'B')
        return scatter(report.scene + ": sampling", "seconds per frame", "RMSE, linear light",
                       dots);
    return scatter(report.scene + ": features", "seconds per frame", "rays per pixel", dots);
}

const std::vector<std::string> kColumns{"scene",
                                        "panel",
                                        "configuration",
                                        "flags",
                                        "scale",
                                        "wall_median_s",
                                        "wall_mad_s",
                                        "wall_min_s",
                                        "cpu_median_s",
                                        "cpu_mad_s",
                                        "cpu_min_s",
                                        "rounds",
                                        "ratio_low",
                                        "ratio_high",
                                        "noisy",
                                        "on_front",
                                        "rays",
                                        "octree_nodes",
                                        "primitive_tests",
                                        "octree_bytes",
                                        "wrong_pixels",
                                        "max",
                                        "rmse",
                                        "rmse_of_rest",
                                        "psnr_db",
                                        "mean_relative_square",
                                        "energy_error"};

Json valuesOf(const Row& r) {
    const image::Difference& e = *r.error;
    return {r.scene,
            std::string(1, r.panel),
            r.name,
            r.flags,
            r.scale,
            r.wall.median,
            r.wall.mad,
            r.wall.min,
            r.cpu.median,
            r.cpu.mad,
            r.cpu.min,
            r.wallSeconds.size(),
            r.ratio.low,
            r.ratio.high,
            r.noisy,
            r.onFront,
            r.rays,
            r.visits.nodes,
            r.tests(),
            r.bytes,
            e.over,
            e.max,
            e.rmse,
            e.rmseOfRest,
            std::isfinite(e.psnr()) ? Json(e.psnr()) : Json(),
            e.meanRelativeSquare,
            std::isfinite(e.energyError) ? Json(e.energyError) : Json()};
}

} // namespace

std::string asTable(const std::vector<SceneReport>& reports) {
    std::string text;
    for (const SceneReport& report : reports) {
        for (const char panel : {'A', 'B', 'C'}) {
            std::string rows;
            for (const Row& r : report.rows) {
                if (r.panel != panel) continue;
                rows += (r.onFront && panel != 'C' ? "* " : "  ") + padded(labelOf(r), 30, true) +
                        padded(digits(r.wall.median * 1000) + " ms", 11) + padded(interval(r), 16) +
                        padded(digits(r.nanosecondsPerRay()), 9) +
                        padded(std::to_string(r.error->over), 8) +
                        padded(digits(r.error->rmse), 11) + padded(std::to_string(r.rays), 11) +
                        (r.noisy ? "  noisy" : "") + "\n";
            }
            if (rows.empty()) continue;
            const char* const names[] = {"arithmetic", "sampling", "features"};
            text += report.scene + " " + std::to_string(report.width) + "x" +
                    std::to_string(report.height) + ", " + names[panel - 'A'] + "\n  " +
                    padded("configuration", 30, true) + padded("median", 11) +
                    padded("ratio, 95 %", 16) + padded("ns/ray", 9) + padded("wrong", 8) +
                    padded("RMSE", 11) + padded("rays", 11) + "\n" + rows;
            if (panel == 'B')
                text += "  the reference itself: +- " + digits(report.referenceSigma) + "\n";
        }
        if (!report.remark.empty()) text += report.scene + ": " + report.remark + "\n";
    }
    return text;
}

std::string asCsv(const std::vector<SceneReport>& reports) {
    std::string text;
    for (const std::string& name : kColumns) text += (text.empty() ? "" : ",") + name;
    text += "\n";
    for (const SceneReport& report : reports)
        for (const Row& row : report.rows) {
            std::string line;
            for (const Json& value : valuesOf(row)) {
                std::string cell = value.is_null()     ? ""
                                   : value.is_string() ? value.get<std::string>()
                                                       : value.dump();
                if (cell.find_first_of(",\"") != std::string::npos) {
                    for (std::size_t at = 0; (at = cell.find('"', at)) != std::string::npos;
                         at += 2)
                        cell.insert(at, 1, '"');
                    cell = '"' + cell + '"';
                }
                line += (line.empty() ? "" : ",") + cell;
            }
            text += line + "\n";
        }
    return text;
}

std::string asJson(const std::vector<SceneReport>& reports, const Facts& facts) {
    Json json;
    for (const auto& [name, value] : facts) json["facts"][name] = value;
    json["scenes"] = Json::array();
    for (const SceneReport& report : reports) {
        Json scene{{"scene", report.scene},
                   {"width", report.width},
                   {"height", report.height},
                   {"primitives", report.primitives},
                   {"reference_sigma", report.referenceSigma},
                   {"remark", report.remark},
                   {"rows", Json::array()}};
        for (const Row& row : report.rows) {
            Json entry;
            const Json values = valuesOf(row);
            for (std::size_t i = 1; i < kColumns.size(); ++i) entry[kColumns[i]] = values[i];
            entry["wall_s"] = row.wallSeconds;
            entry["cpu_s"] = row.cpuSeconds;
            scene["rows"].push_back(std::move(entry));
        }
        json["scenes"].push_back(std::move(scene));
    }
    return json.dump(2) + "\n";
}

std::string asSvg(const SceneReport& report, char panel) { return plotOf(report, panel); }

std::string asHtml(const std::vector<SceneReport>& reports, const Facts& facts) {
    std::string html =
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Speed against "
        "error</title>\n<style>body{font:15px/1.45 sans-serif;max-width:60em;margin:2em auto;"
        "padding:0 1em;color:#222}table{border-collapse:collapse;font-size:13px;margin:1em 0}"
        "td,th{padding:2px 9px;border-bottom:1px solid #ddd;text-align:right}td:first-child,"
        "th:first-child,td:nth-child(2),th:nth-child(2){text-align:left}tr.on td:first-child{"
        "color:#c33;font-weight:bold}code{font-size:12px}svg{width:100%;max-width:760px;border:"
        "1px solid #ddd}</style></head><body>\n<h1>Speed against error</h1>\n<p>";
    for (const auto& [name, value] : facts) html += escaped(name + ": " + value) + "<br>\n";
    html += "</p>\n<p>Red: on the Pareto front, nothing else is clearly as fast and in no error "
            "worse. A ratio is the 95 % interval of the CPU time over the default's; where it "
            "holds 1 there is no winner. Hover over a point for its flags.</p>\n";
    const char* const about[] = {
        "One sample a pixel, the same in every configuration, on one thread, against binary128; "
        "a line joins one configuration's scales. f64-robust is the product; the others share "
        "one scalar tracer and one tree, so f64-robust (scalar) over f32-naive is what being right "
        "costs there. The product over f32-naive is void as such a price: that one has neither the "
        "octree's lanes nor its tuning, and was not measured against Embree.",
        "Against the mean of two fine grids. max_error stops where its own estimate says so.",
        "What each feature of the scene costs; wrong pixels are those that it changes."};
    for (const SceneReport& report : reports) {
        html += "<h2>" + escaped(report.scene) + "</h2>\n<p>" + std::to_string(report.width) +
                " x " + std::to_string(report.height) + ", " + std::to_string(report.primitives) +
                " primitives. " + escaped(report.remark) + "</p>\n";
        for (const char panel : {'A', 'B', 'C'}) {
            const std::string plot = plotOf(report, panel);
            if (plot.empty()) continue;
            html += "<h3>Panel " + std::string(1, panel) + "</h3>\n<p>" + about[panel - 'A'];
            if (panel == 'B')
                html += " The reference itself is known to &plusmn; " +
                        digits(report.referenceSigma) + ".";
            html +=
                "</p>\n" + plot +
                "<table><tr><th>configuration</th><th>flags</th><th>ms</th><th>MAD</th><th>ratio, "
                "95 %</th><th>ns/ray</th><th>wrong</th><th>max</th><th>RMSE</th><th>rays</th><th>"
                "nodes</th><th>tests</th><th>bytes</th></tr>\n";
            for (const Row& r : report.rows) {
                if (r.panel != panel) continue;
                html +=
                    std::string("<tr") + (r.onFront && panel != 'C' ? " class=\"on\"" : "") + ">";
                html += "<td>" + escaped(labelOf(r)) + (r.noisy ? " (noisy)" : "") +
                        "</td><td><code>" + escaped(r.flags) + "</code></td>";
                for (const std::string& cell :
                     {digits(r.wall.median * 1000), digits(r.wall.mad * 1000), interval(r),
                      digits(r.nanosecondsPerRay()), std::to_string(r.error->over),
                      digits(r.error->max), digits(r.error->rmse), std::to_string(r.rays),
                      std::to_string(r.visits.nodes), std::to_string(r.tests()),
                      std::to_string(r.bytes)})
                    html += "<td>" + cell + "</td>";
                html += "</tr>\n";
            }
            html += "</table>\n";
        }
    }
    return html + "</body></html>\n";
}

} // namespace rt::report
