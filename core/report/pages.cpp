#include <core/report/pages.hpp>

#include <core/report/plot.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace rt::report {

namespace {

using Json = nlohmann::ordered_json;

std::string padded(std::string text, std::size_t width, bool left = false) {
    if (text.size() < width) text.insert(left ? text.size() : 0, width - text.size(), ' ');
    return text;
}

std::string interval(const Row& row) {
    if (row.isDefault) return "1 (default)";
    return digits(row.ratio.low) + " - " + digits(row.ratio.high);
}

/// x 1e-6
std::string scaleOf(const Row& row) {
    std::array<char, 32> text;
    const auto end = std::to_chars(text.data(), text.data() + text.size(), row.scale,
                                   std::chars_format::scientific)
                         .ptr;
    std::string power(text.data(), end);
    for (const char* const filler : {"e+0", "e-0"})
        if (const auto at = power.find(filler); at != std::string::npos)
            power.replace(at, 3, filler[1] == '+' ? "e" : "e-");
    return "x " + power;
}

std::string labelOf(const Row& row) {
    return row.panel == 'A' && row.scale != 1 ? row.name + ", " + scaleOf(row) : row.name;
}

/// Wrong pixels of a million; none is drawn at the 95 % bound, 3 of all that were looked at.
double wrongPerMillion(const Row& row) {
    const double pixels = std::max<double>(1, static_cast<double>(row.error->pixels));
    return 1e6 * (row.error->over ? static_cast<double>(row.error->over) : 3) / pixels;
}

std::string hoverOf(const Row& row) {
    return labelOf(row) + (row.flags.empty() ? "" : "\n" + row.flags) + "\n" +
           digits(row.wall.median * 1000) + " ms a frame, CPU " + digits(row.cpu.median * 1000) +
           " ms\nwrong pixels " + std::to_string(row.error->over) + ", RMSE " +
           digits(row.error->rmse) + ", largest " + digits(row.error->max);
}

/// grid of grid 4: names that differ in a number alone are one series.
std::string seriesOf(const std::string& name) {
    const auto space = name.rfind(' ');
    if (space == std::string::npos || name.find_first_not_of("0123456789.", space + 1) != name.npos)
        return name;
    return name.substr(0, space);
}

bool suffersFromScale(const SceneReport& report, const Row& row) {
    return std::any_of(report.rows.begin(), report.rows.end(), [&](const Row& at1) {
        return at1.panel == 'A' && at1.name == row.name && at1.scale == 1 &&
               row.error->over > 2 * at1.error->over;
    });
}

std::string plotOf(const SceneReport& report, char panel) {
    Plot plot;
    for (const Row& row : report.rows) {
        if (row.panel != panel) continue;
        Dot dot{row.wall.median, row.error->rmse, seriesOf(row.name),
                row.name,        hoverOf(row),    row.onFront};
        if (panel == 'A') {
            dot.x = row.nanosecondsPerRay(), dot.y = wrongPerMillion(row);
            dot.series = row.name;
            dot.bound = row.error->over == 0;
            if (row.scale != 1) dot.label = suffersFromScale(report, row) ? scaleOf(row) : "";
        } else if (panel == 'C') {
            dot.y =
                static_cast<double>(row.rays) / (static_cast<double>(report.width) * report.height);
            dot.filled = true; // what other features cost is no contest
        }
        if (dot.x <= 0 || dot.y <= 0) continue;
        if (panel == 'B' && dot.filled) plot.front.push_back(plot.dots.size());
        plot.dots.push_back(std::move(dot));
    }
    if (plot.dots.empty()) return "";
    const char* const names[][3] = {
        {"arithmetic", "CPU nanoseconds per ray", "wrong pixels of a million"},
        {"sampling", "seconds per frame", "RMSE, linear light"},
        {"features", "seconds per frame", "rays per pixel"}};
    const auto& [what, xName, yName] = names[panel - 'A'];
    plot.title = report.scene + ": " + what, plot.xName = xName, plot.yName = yName;
    if (panel != 'C') {
        plot.filled = panel == 'A' ? "on the Pareto front of its scale" : "on the Pareto front";
        plot.hollow = "beaten";
    }
    return asSvg(plot);
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
            std::size_t width = std::string_view("configuration").size();
            for (const Row& r : report.rows)
                if (r.panel == panel) width = std::max(width, labelOf(r).size());
            std::string rows;
            for (const Row& r : report.rows) {
                if (r.panel != panel) continue;
                rows +=
                    (r.onFront && panel != 'C' ? "* " : "  ") + padded(labelOf(r), width, true) +
                    padded(digits(r.wall.median * 1000) + " ms", 11) + padded(interval(r), 16) +
                    padded(digits(r.nanosecondsPerRay()), 9) +
                    padded(std::to_string(r.error->over), 8) + padded(digits(r.error->rmse), 11) +
                    padded(std::to_string(r.rays), 11) + (r.noisy ? "  noisy" : "") + "\n";
            }
            if (rows.empty()) continue;
            const char* const names[] = {"arithmetic", "sampling", "features"};
            text += report.scene + " " + std::to_string(report.width) + "x" +
                    std::to_string(report.height) + ", " + names[panel - 'A'] + "\n  " +
                    padded("configuration", width, true) + padded("per frame", 11) +
                    padded("CPU, ratio", 16) + padded("ns/ray", 9) + padded("wrong", 8) +
                    padded("RMSE", 11) + padded("rays", 11) + "\n" + rows;
            if (panel == 'B')
                text += "  the reference itself: +- " + digits(report.referenceSigma) + "\n";
        }
        if (!report.remark.empty()) text += report.scene + ": " + report.remark + "\n";
    }
    return text + "* on the Pareto front: nothing else is clearly faster and no worse in any "
                  "error. Ratio: to the "
                  "default's CPU time,\n  95 %. Wrong: pixels off by more than 1/255.\n";
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
        "error</title>\n<style>body{font:15px/1.45 sans-serif;max-width:70em;margin:2em auto;"
        "padding:0 1em;color:#222}table{border-collapse:collapse;font-size:12px;margin:1em 0}"
        "td,th{padding:2px 8px;border-bottom:1px solid #ddd;text-align:right;white-space:nowrap}"
        "td:first-child,th:first-child,td:nth-child(2),th:nth-child(2){text-align:left}tr.on "
        "td:first-child{font-weight:bold}code{font-size:11px}svg{width:100%;max-width:860px;border:"
        "1px solid #ddd}@media print{body{max-width:none;margin:0;font-size:11px}table{font-size:"
        "8px}code{font-size:7px}td,th{padding:1px 4px}svg,tr,h2,h3{break-inside:avoid}h2,h3{"
        "break-after:avoid}svg,table{print-color-adjust:exact}}</style></head><body>\n<h1>Speed "
        "against error</h1>\n<p>";
    for (const auto& [name, value] : facts) html += escaped(name + ": " + value) + "<br>\n";
    if (const auto price = priceOfRobustness(reports))
        html += "price of being right, f64-robust over f32-naive, median over the scenes: " +
                digits(*price) + "<br>\n";
    html += "</p>\n<p>Filled, and bold in the tables: on the Pareto front, nothing else is clearly "
            "faster and no worse in any error. A ratio is the 95 % interval of the CPU time over "
            "the default's; where it holds 1 there is no winner. Hover over a point for its "
            "flags.</p>\n";
    const char* const about[] = {
        "One sample a pixel, the same in every configuration, on one thread, against binary128; "
        "a line joins one configuration's scales. f64-robust is the product. f32-naive is the "
        "product with an octree whose boxes, primitives and hits are f32 without error bounds: it "
        "shares octree, lanes, tuning and shading. f64-robust over f32-naive is what being right "
        "costs; that counts where f32-naive is fast itself, and single rays of its octree were "
        "measured at 1.3 times the speed of Embree's default mode (AVX-512, "
        "core/octree/README.md). The four scalar ones share one tracer and one tree of their own.",
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
