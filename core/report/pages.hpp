// The report in forms that people, spreadsheets and scripts read.
#pragma once
#include <core/report/bench.hpp>

namespace rt::report {

/// What was measured where: name and value, such as "commit", "CPU", "load".
using Facts = std::vector<std::pair<std::string, std::string>>;

std::string asTable(const std::vector<SceneReport>& reports);
std::string asCsv(const std::vector<SceneReport>& reports);
std::string asJson(const std::vector<SceneReport>& reports, const Facts& facts);
/// One file that needs no other: plots (SVG) and tables.
std::string asHtml(const std::vector<SceneReport>& reports, const Facts& facts);
/// The plot of one panel, 'A' or 'B', of one scene; a whole SVG document.
std::string asSvg(const SceneReport& report, char panel);

} // namespace rt::report
