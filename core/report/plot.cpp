#include <core/report/plot.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace rt::report {

namespace {

// On paper of kWidth x kHeight; all lengths below are in its units, text has the size 12.
constexpr double kWidth = 760, kHeight = 480, kLeft = 76, kRight = 30, kTop = 36, kBottom = 56;
constexpr double kLegendRow = 20;

struct Style {
    const char *color, *marker; // the marker's outline around 0, 0
};
/// Colours that colour-blind eyes tell apart [Okabe and Ito, Color Universal Design, 2008], without their yellow.
constexpr std::array<Style, 7> kStyles{
    {{"#0072b2", "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0-10 0z"},
     {"#d55e00", "M-4.5-4.5h9v9h-9z"},
     {"#009e73", "M0-6.5L6.5 0 0 6.5-6.5 0z"},
     {"#a0468a", "M0-6L6 5H-6z"},
     {"#c98a00", "M0 6L6-5H-6z"},
     {"#3a9ad9", "M-2-6h4v4h4v4h-4v4h-4v-4h-4v-4h4z"},
     {"#222222", "M0-7L1.8-2.2 7-2.2 2.8 1 4.3 6 0 3-4.3 6-2.8 1-7-2.2-1.8-2.2z"}}};

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
    double left, right, top, bottom;

    void take(const Rectangle& r) { taken.push_back(r); }
    bool takeFree(const Rectangle& r) {
        if (r.x < left || r.x + r.width > right || r.y < top || r.y + r.height > bottom)
            return false;
        for (const Rectangle& t : taken)
            if (r.x < t.x + t.width && t.x < r.x + r.width && r.y < t.y + t.height &&
                t.y < r.y + r.height)
                return false;
        take(r);
        return true;
    }
};

std::string number(double value) { return digits(value, 5); }

std::string text(double x, double y, const char* anchor, const std::string& words,
                 const std::string& more = "") {
    return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" +
           more + ">" + escaped(words) + "</text>\n";
}

std::string line(double x0, double y0, double x1, double y1, const char* kind) {
    return "<line x1=\"" + number(x0) + "\" y1=\"" + number(y0) + "\" x2=\"" + number(x1) +
           "\" y2=\"" + number(y1) + "\" class=\"" + kind + "\"/>\n";
}

std::string marker(const Style& style, double x, double y, bool filled) {
    return std::string("<path d=\"") + style.marker + "\" transform=\"translate(" + number(x) +
           " " + number(y) + ")\" fill=\"" + (filled ? style.color : "#fff") + "\" stroke=\"" +
           (filled ? "#fff\"/>" : style.color + std::string("\" stroke-width=\"1.7\"/>"));
}

double widthOf(const std::string& words) {
    double width = 0;
    for (const char c : words)
        width += std::string_view("fijlrt1.,:()/ -").find(c) != std::string_view::npos ? 4
                 : std::string_view("mwMW_%").find(c) != std::string_view::npos        ? 9
                                                                                       : 6.8;
    return width;
}

class Drawing {
public:
    explicit Drawing(const Plot& plot) : plot_(plot) {
        for (const Dot& d : plot.dots)
            if (std::find(series_.begin(), series_.end(), d.series) == series_.end())
                series_.push_back(d.series);
    }

    std::string svg() {
        svg_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 760 480\" "
               "font-family=\"sans-serif\" font-size=\"12\">\n<style>.grid{stroke:#ddd}"
               ".front{stroke:#444;stroke-dasharray:5 3;fill:none}.leader{stroke:#999}"
               ".arrow{stroke:#666;stroke-width:1.5;fill:none}.halo{paint-order:stroke;"
               "stroke:#fff;stroke-width:3}g:hover path{stroke:#000;stroke-width:2}</style>\n"
               "<rect width=\"760\" height=\"480\" fill=\"#fff\"/>\n";
        svg_ += text(kLeft, 22, "start", plot_.title, " font-size=\"15\"");
        legend();
        axes();
        lines();
        dots();
        labels();
        return svg_ + "</svg>\n";
    }

private:
    const Style& styleOf(const std::string& series) const {
        const auto found = std::find(series_.begin(), series_.end(), series);
        return kStyles[static_cast<std::size_t>(found - series_.begin()) % kStyles.size()];
    }

    /// In rows below the title; sets top_ below them.
    void legend() {
        constexpr double kGap = 22, kAfterMarker = 10;
        double x = kLeft + 6, y = kTop + 6;
        const auto entry = [&](const std::string& words, const std::string& drawn) {
            if (x > kLeft + 6 && x + kAfterMarker + widthOf(words) > kWidth)
                x = kLeft + 6, y += kLegendRow;
            svg_ += "<g transform=\"translate(" + number(x) + " " + number(y) + ")\">" + drawn +
                    "</g>" + text(x + kAfterMarker, y + 4, "start", words);
            x += kAfterMarker + widthOf(words) + kGap;
        };
        const bool anyBound =
            std::any_of(plot_.dots.begin(), plot_.dots.end(), [](const Dot& d) { return d.bound; });
        for (const std::string& name : series_) entry(name, marker(styleOf(name), 0, 0, true));
        if (!plot_.filled.empty() || anyBound) x = kWidth; // a row of its own
        constexpr Style kAny{"#777", kStyles[0].marker};
        if (!plot_.filled.empty()) entry(plot_.filled, marker(kAny, 0, 0, true));
        if (!plot_.hollow.empty()) entry(plot_.hollow, marker(kAny, 0, 0, false));
        if (anyBound) entry("none seen: at most so many, 95 %", arrow(0, -6));
        top_ = y + kLegendRow;
    }

    static std::string arrow(double x, double y) {
        return "<path class=\"arrow\" d=\"M" + number(x) + " " + number(y) + "v14m-4-5l4 5 4-5\"/>";
    }

    void axes() {
        const auto [smallX, largeX] =
            std::minmax_element(plot_.dots.begin(), plot_.dots.end(),
                                [](const Dot& a, const Dot& b) { return a.x < b.x; });
        const auto [smallY, largeY] =
            std::minmax_element(plot_.dots.begin(), plot_.dots.end(),
                                [](const Dot& a, const Dot& b) { return a.y < b.y; });
        x_ = axisOver(smallX->x, largeX->x, kLeft, kWidth - kRight);
        y_ = axisOver(smallY->y, largeY->y, kHeight - kBottom, top_);
        for (const double v : ticks(x_)) {
            svg_ += line(x_.at(v), top_, x_.at(v), kHeight - kBottom, "grid");
            svg_ += text(x_.at(v), kHeight - kBottom + 16, "middle", digits(v));
        }
        for (const double v : ticks(y_)) {
            svg_ += line(kLeft, y_.at(v), kWidth - kRight, y_.at(v), "grid");
            svg_ += text(kLeft - 6, y_.at(v) + 4, "end", digits(v));
        }
        svg_ += text((kLeft + kWidth - kRight) / 2, kHeight - 14, "middle", plot_.xName);
        svg_ += text(0, 0, "middle", plot_.yName,
                     " transform=\"translate(16 " + number((top_ + kHeight - kBottom) / 2) +
                         ") rotate(-90)\"");
    }

    /// Through each series in the order of its dots; and by x through those of the front that are the lowest so far.
    void lines() {
        const auto path = [&](const std::vector<const Dot*>& along, const std::string& look) {
            if (along.size() < 2) return;
            std::string points;
            for (const Dot* d : along)
                points += number(x_.at(d->x)) + "," + number(y_.at(d->y)) + " ";
            svg_ += "<polyline " + look + " points=\"" + points + "\"/>\n";
        };
        for (const std::string& name : series_) {
            std::vector<const Dot*> along;
            for (const Dot& d : plot_.dots)
                if (d.series == name) along.push_back(&d);
            path(along, "fill=\"none\" stroke-opacity=\"0.5\" stroke=\"" +
                            std::string(styleOf(name).color) + "\"");
        }
        std::vector<const Dot*> front;
        for (const std::size_t i : plot_.front) front.push_back(&plot_.dots[i]);
        std::sort(front.begin(), front.end(),
                  [](const Dot* a, const Dot* b) { return a->x < b->x; });
        std::vector<const Dot*> lowest;
        for (const Dot* d : front)
            if (lowest.empty() || d->y < lowest.back()->y) lowest.push_back(d);
        path(lowest, "class=\"front\"");
    }

    void dots() {
        for (const Dot& d : plot_.dots) {
            const double x = x_.at(d.x), y = y_.at(d.y);
            svg_ += "<g><title>" + escaped(d.hover) + "</title>" + (d.bound ? arrow(x, y) : "") +
                    marker(styleOf(d.series), x, y, d.filled) + "</g>\n";
        }
    }

    /// Right or left of the dot, above or below; where that is taken, farther off with a line to it.
    void labels() {
        Places places{{}, kLeft, kWidth, top_, kHeight - kBottom};
        for (const Dot& d : plot_.dots)
            places.take({x_.at(d.x) - 6, y_.at(d.y) - 6, 12, d.bound ? 22.0 : 12.0});
        for (const Dot& d : plot_.dots)
            if (!d.label.empty()) label(d, places);
    }

    void label(const Dot& dot, Places& places) {
        const double x = x_.at(dot.x), y = y_.at(dot.y), width = widthOf(dot.label);
        for (const double away : {0.0, 14.0, 28.0, 42.0, 56.0})
            for (const double baseline : {y - 6 - away, y + 16 + away})
                for (const bool toLeft : {false, true}) {
                    if (!places.takeFree(
                            {toLeft ? x - 8 - width : x + 8, baseline - 10, width, 12}))
                        continue;
                    const double edge = x + (toLeft ? -8 : 8);
                    if (away > 0) svg_ += line(x, y, edge, baseline - 4, "leader");
                    svg_ += text(edge, baseline, toLeft ? "end" : "start", dot.label,
                                 " class=\"halo\"");
                    return;
                }
    }

    const Plot& plot_;
    std::vector<std::string> series_; // in the order of their first dots
    LogAxis x_{}, y_{};
    double top_ = kTop; // of the part inside the axes
    std::string svg_;
};

} // namespace

std::string asSvg(const Plot& plot) { return Drawing(plot).svg(); }

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

std::string digits(double value, int significant) {
    if (const double size = std::fabs(value);
        size >= 1000 && size < 10'000'000) // 1420, not 1.42e+03
        significant = std::max(significant, static_cast<int>(std::log10(size)) + 1);
    std::array<char, 48> text;
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                   std::chars_format::general, significant)
                         .ptr;
    return {text.data(), end};
}

} // namespace rt::report
