// SPDX-License-Identifier: MIT
#include "charts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numeric>

#include "page_style.hpp"

namespace gnomon::bench {

namespace {

constexpr double width = 760, left = 58, right = 16, top = 14;

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.1f", value);
    return text;
}

/// A logarithmic axis that starts and ends at a 1, 2 or 5.
class LogAxis {
public:
    LogAxis(double low, double high, double at_low, double at_high) : at_low_(at_low), at_high_(at_high) {
        std::vector<double> steps;
        for (int e = static_cast<int>(std::floor(std::log10(low)));
             e <= static_cast<int>(std::ceil(std::log10(high))) + 1; ++e)
            for (const double digit : {1.0, 2.0, 5.0}) steps.push_back(digit * std::pow(10.0, e));
        // Roundings of pow must not put a value outside its axis.
        low_ = steps.front();
        for (const double step : steps)
            if (step <= low * 1.0001) low_ = step;
        for (const double step : steps)
            if (high_ == 0 && step > low_ * 1.5 && step >= high * 0.9999) high_ = step;
        const bool decades = std::log10(high_ / low_) > 2.5;
        for (const double step : steps)
            if (step >= low_ && step <= high_ && (!decades || is_decade(step))) ticks_.push_back(step);
    }
    double operator()(double value) const {
        return at_low_ + (at_high_ - at_low_) * std::log(value / low_) / std::log(high_ / low_);
    }
    const std::vector<double>& ticks() const { return ticks_; }

private:
    static bool is_decade(double step) { return std::abs(std::log10(step) - std::round(std::log10(step))) < 1e-6; }

    double at_low_, at_high_, low_ = 0, high_ = 0;
    std::vector<double> ticks_;
};

std::string text_at(double x, double y, const char* anchor, const std::string& text, const char* css = "tick") {
    return "<text class=\"" + std::string(css) + "\" x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" +
           anchor + "\">" + escaped(text) + "</text>\n";
}

std::string line_between(double x0, double y0, double x1, double y1, const char* css) {
    return "<line class=\"" + std::string(css) + "\" x1=\"" + number(x0) + "\" y1=\"" + number(y0) + "\" x2=\"" +
           number(x1) + "\" y2=\"" + number(y1) + "\"/>\n";
}

std::string opened_svg(double height, const std::string& title, const std::string& more = "") {
    return "<svg " + more + "viewBox=\"0 0 " + number(width) + " " + number(height) + "\" role=\"img\" aria-label=\"" +
           escaped(title) + "\">\n";
}
std::string opened(double height, const std::string& title) {
    return "<div class=\"chart\">" + opened_svg(height, title);
}
constexpr const char* closed = "</svg></div>\n";

// "0.05", "200", "50k", "2M"
std::string tick_text(double value) {
    char text[32];
    if (value >= 1e6)
        std::snprintf(text, sizeof(text), "%gM", value / 1e6);
    else if (value >= 1e4)
        std::snprintf(text, sizeof(text), "%gk", value / 1e3);
    else
        std::snprintf(text, sizeof(text), "%g", value);
    return text;
}

// Grid lines and labels of a time axis, bottom to top.
std::string time_grid(const LogAxis& axis, double from_x, double to_x) {
    std::string svg;
    for (const double tick : axis.ticks())
        svg += line_between(from_x, axis(tick), to_x, axis(tick), "grid") +
               text_at(from_x - 6, axis(tick) + 4, "end", tick_text(tick) + " ms");
    return svg;
}

// The same for the other axis, left to right, of a chart between `low_y` and `high_y`.
std::string x_grid(const LogAxis& axis, double low_y, double high_y) {
    std::string svg;
    for (const double tick : axis.ticks())
        svg += line_between(axis(tick), high_y, axis(tick), low_y, "grid") +
               text_at(axis(tick), low_y + 16, "middle", tick_text(tick));
    return svg;
}

template <typename Values, typename ValueOf>
std::pair<double, double> range_of(const Values& values, ValueOf value_of) {
    double low = std::numeric_limits<double>::infinity(), high = 0;
    for (const auto& v : values) {
        const double x = value_of(v);
        if (x <= 0) continue;
        low = std::min(low, x);
        high = std::max(high, x);
    }
    return high > 0 ? std::pair{low, high} : std::pair{1.0, 10.0};
}

constexpr double scatter_height = 420;

// What is inside the picture of `scatter`.
std::string scatter_marks(const std::vector<Mark>& marks, const std::vector<std::size_t>& front) {
    constexpr double bottom = scatter_height - 46, exact_x = left + 26, error_left = left + 70;
    const auto [least, most] = range_of(marks, [](const Mark& m) { return m.ms; });
    const auto [smallest, largest] = range_of(marks, [](const Mark& m) { return m.error_share; });
    const LogAxis y(least, most, bottom, top), x(smallest, largest, error_left, width - right);
    const auto x_of = [&](const Mark& mark) { return mark.error_share > 0 ? x(mark.error_share) : exact_x; };

    std::string svg = time_grid(y, left, width - right) + x_grid(x, bottom, top);
    svg += text_at(exact_x, bottom + 16, "middle", "0");
    svg += text_at((error_left + width - right) / 2, bottom + 36, "middle", "share of wrong points (left: none at all)",
                   "axis");

    std::string path;
    for (const std::size_t i : front)
        path += (path.empty() ? "M" : " L") + number(x_of(marks[i])) + " " + number(y(marks[i].ms));
    svg += "<path class=\"front\" d=\"" + path + "\"/>\n";
    for (const Mark& mark : marks)
        svg += std::string("<circle class=\"mark ") + (mark.is_aside ? "hollow " : "") + class_of(mark.series) +
               "\" cx=\"" + number(x_of(mark)) + "\" cy=\"" + number(y(mark.ms)) + "\" r=\"5\"><title>" +
               escaped(mark.tip) + "</title></circle>\n";
    for (std::size_t k = 0; k < front.size(); ++k) {
        const Mark& mark = marks[front[k]];
        svg += text_at(x_of(mark) + 8, y(mark.ms) - 7, "start", std::to_string(k + 1), "label");
    }
    return svg;
}

}  // namespace

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '&')
            result += "&amp;";
        else if (c == '<')
            result += "&lt;";
        else if (c == '>')
            result += "&gt;";
        else if (c == '"')
            result += "&quot;";
        else
            result += c;
    }
    return result;
}

std::string three_digits(double value) {
    if (value == 0) return "0";
    const int before_point = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
    char text[64];
    if (before_point < -4)
        std::snprintf(text, sizeof(text), "%.2e", value);
    else
        std::snprintf(text, sizeof(text), "%.*f", std::max(0, 3 - before_point), value);
    return text;
}

std::string with_spaces(double count) {
    std::string digits = std::to_string(static_cast<std::uint64_t>(count));
    for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, "\u00a0");
    return digits;
}

std::vector<std::size_t> pareto_front(const std::vector<Mark>& marks) {
    std::vector<std::size_t> order(marks.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::sort(order, {}, [&](std::size_t i) { return std::pair(marks[i].ms, marks[i].error_share); });
    std::vector<std::size_t> front;
    for (const std::size_t i : order)
        if (!marks[i].is_aside && (front.empty() || marks[i].error_share < marks[front.back()].error_share))
            front.push_back(i);
    return front;
}

std::string class_of(std::size_t series) { return std::string("s").append(std::to_string(series % colours)); }

std::string scatter(const std::vector<Mark>& marks) {
    return opened(scatter_height, "run time against error") + scatter_marks(marks, pareto_front(marks)) + closed;
}

std::string scatter_file(const std::string& title, const std::vector<Mark>& marks,
                         const std::vector<std::pair<std::size_t, std::string>>& legend) {
    constexpr double line = 17, chart_top = 26 + 2 * line;
    constexpr std::size_t per_row = 4;
    const std::vector<std::size_t> front = pareto_front(marks);
    const double height = chart_top + scatter_height + line * (double(front.size()) + 2);
    std::string svg =
        "<!-- SPDX-License-Identifier: MIT -->\n" +
        opened_svg(height, title, "xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(width) + "\" ") + "<style>" +
        page_style + "</style>\n<rect width=\"100%\" height=\"100%\" style=\"fill: var(--paper)\"/>\n" +
        text_at(left, 18, "start", title, "label");
    for (std::size_t i = 0; i < legend.size(); ++i) {
        const auto& [series, name] = legend[i];
        const double x = left + (width - left - right) / per_row * double(i % per_row),
                     y = 26 + line * (double(i / per_row) + 0.5);
        svg += "<circle class=\"" + class_of(series) + "\" cx=\"" + number(x + 5) + "\" cy=\"" + number(y) +
               "\" r=\"5\"/>\n" + text_at(x + 15, y + 4, "start", name);
    }
    svg += "<g transform=\"translate(0 " + number(chart_top) + ")\">\n" + scatter_marks(marks, front) + "</g>\n";
    double y = chart_top + scatter_height + line;
    svg += text_at(left, y, "start", "On the front, from the fastest to the least wrong:");
    for (std::size_t k = 0; k < front.size(); ++k)
        svg += text_at(left, y += line, "start", std::to_string(k + 1) + "  " + marks[front[k]].tip);
    return svg + "</svg>\n";
}

std::string bars(const std::vector<Bar>& bars) {
    constexpr double row = 58, bar_top = 31, total_width = 70;
    const double height = top + row * double(bars.size()) + 10;
    double longest = 0;
    for (const Bar& bar : bars) {
        double sum = 0;
        for (const auto& part : bar.parts) sum += part.second;
        longest = std::max(longest, sum);
    }
    const double scale = longest > 0 ? (width - total_width) / longest : 0;
    std::string svg = opened(height, "time per stage");
    for (std::size_t i = 0; i < bars.size(); ++i) {
        const Bar& bar = bars[i];
        const double y = top + row * double(i);
        svg += text_at(0, y + 10, "start", bar.label, "label");
        svg += text_at(0, y + 25, "start", bar.second_label);
        double x = 0, sum = 0;
        for (std::size_t k = 0; k < bar.parts.size(); ++k) {
            const auto& [series, ms] = bar.parts[k];
            svg += "<rect class=\"" + class_of(series) + "\" x=\"" + number(x) + "\" y=\"" + number(y + bar_top) +
                   "\" width=\"" + number(ms * scale) + "\" height=\"18\"><title>" +
                   escaped(bar.part_names[k] + ": " + three_digits(ms) + " ms") + "</title></rect>\n";
            x += ms * scale;
            sum += ms;
        }
        svg += text_at(x + 6, y + bar_top + 14, "start", three_digits(sum) + " ms");
    }
    return svg + closed;
}

std::string lines(const std::vector<Line>& lines, const std::string& x_title) {
    constexpr double height = 340, bottom = height - 46;
    std::vector<std::pair<double, double>> all;
    for (const Line& line : lines) all.insert(all.end(), line.points.begin(), line.points.end());
    const auto [least, most] = range_of(all, [](const auto& p) { return p.second; });
    const auto [fewest, largest] = range_of(all, [](const auto& p) { return p.first; });
    const LogAxis y(least, most, bottom, top), x(fewest, largest, left, width - right - 20);
    std::string svg =
        opened(height, "time against " + x_title) + time_grid(y, left, width - right) + x_grid(x, bottom, top);
    svg += text_at((left + width - right) / 2, bottom + 36, "middle", x_title, "axis");
    for (const Line& line : lines) {
        std::string path, marks;
        for (const auto& [at, ms] : line.points) {
            path += (path.empty() ? "M" : " L") + number(x(at)) + " " + number(y(ms));
            marks += "<circle class=\"mark " + class_of(line.series) + "\" cx=\"" + number(x(at)) + "\" cy=\"" +
                     number(y(ms)) + "\" r=\"4\"><title>" +
                     escaped(line.label + ": " + with_spaces(at) + ", " + three_digits(ms) + " ms") +
                     "</title></circle>\n";
        }
        svg += "<path class=\"line " + class_of(line.series) + "\" d=\"" + path + "\"/>\n" + marks;
    }
    return svg + closed;
}

}  // namespace gnomon::bench
