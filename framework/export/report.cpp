// SPDX-License-Identifier: Apache-2.0
#include "framework/export/report.h"

#include <charconv>

#include "framework/core/base64.h"
#include "framework/core/error.h"
#include "framework/core/markup.h"
#include "framework/export/report_assets.h"
#include "framework/export/report_data.h"

namespace lapwing {

const std::vector<std::string>& projection_names() {
  static const std::vector<std::string> names{"above", "from_south", "from_east", "from_north",
                                              "from_west"};
  return names;
}

namespace {

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos;
       at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// Its word, which is also the class that the style sheet knows it by.
const char* mark_word(Mark mark) {
  switch (mark) {
    case Mark::pass:
      return "pass";
    case Mark::fail:
      return "fail";
    case Mark::skipped:
      return "skipped";
    case Mark::none:
      break;
  }
  return "";
}

std::string with_unit(const std::string& name, const std::string& unit) {
  return markup_text(name) +
         (unit.empty() ? "" : " <span class=\"unit\">" + markup_text(unit) + "</span>");
}

std::string column_title(const TableColumn& column) {
  const std::string unit = markup_text(column.unit);
  return markup_text(column.name) +
         (unit.empty() ? "" : " <span class=\"unit\">[" + unit + "]</span>");
}

class Page {
 public:
  explicit Page(const Report& report) : report_(report) {}

  std::string html() {
    head();
    for (std::size_t i = 0; i < report_.sections.size(); ++i) section(i);
    out_ += "</main>\n<script type=\"application/json\" id=\"report-data\">";
    out_ += report_data(report_);
    out_ += "</script>\n";
    if (viewed_) viewer(*report_.viewer);
    out_ += "<script>\n\"use strict\";\n(() => {\n";
    out_ += kReportScript;
    out_ += "})();\n</script>\n</body>\n</html>\n";
    return std::move(out_);
  }

 private:
  void head() {
    const std::string title = markup_text(report_.title);
    out_ += "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>" +
            title +
            "</title>\n"
            "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
            "<meta name=\"color-scheme\" content=\"light dark\">\n"
            "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
            "style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:\">\n<style>\n";
    out_ += kReportStyle;
    out_ +=
        "</style>\n<script>\n"
        "window.onerror = (message, source, line) => {\n"
        "  document.documentElement.dataset.error = message + \" (line \" + line + \")\";\n"
        "};\n</script>\n</head>\n<body>\n<header>\n<div class=\"headline\"><h1>" +
        title + "</h1>";
    if (!report_.status.empty()) {
      out_ += "<span class=\"badge " + std::string(mark_word(report_.status_mark)) + "\">" +
              markup_text(report_.status) + "</span>";
    }
    out_ += "</div>\n";
    if (!report_.subtitle.empty()) {
      out_ += "<p class=\"subtitle\">" + markup_text(report_.subtitle) + "</p>\n";
    }
    out_ += "<nav aria-label=\"Sections\">";
    for (std::size_t i = 0; i < report_.sections.size(); ++i) {
      out_ += "<a href=\"#section-" + std::to_string(i + 1) + "\">" +
              markup_text(report_.sections[i].title) + "</a>";
    }
    out_ +=
        "</nav>\n</header>\n<main>\n<noscript><p class=\"notice\">The drawings of this page are "
        "made by a script inside it; tables and text are complete without.</p></noscript>\n";
  }

  static bool half_width(const Block& block) {
    return std::holds_alternative<Chart>(block) || std::holds_alternative<PathView>(block);
  }

  void section(std::size_t index) {
    const Section& s = report_.sections[index];
    section_ = &s;
    const std::string id = "section-" + std::to_string(index + 1);
    out_ += "<section id=\"" + id + "\" aria-labelledby=\"" + id + "-title\">\n<h2 id=\"" + id +
            "-title\">" + markup_text(s.title) + "</h2>\n<div class=\"blocks\">\n";
    for (std::size_t i = 0, run = 0; i < s.blocks.size(); ++i) {
      // Two drawings share a row; the odd one of a run has a row of its own.
      run = half_width(s.blocks[i]) ? run + 1 : 0;
      const bool last = i + 1 == s.blocks.size() || !half_width(s.blocks[i + 1]);
      wide_ = !half_width(s.blocks[i]) || (last && run % 2 == 1);
      std::visit([this](const auto& b) { block(b); }, s.blocks[i]);
    }
    out_ += "</div>\n</section>\n";
  }

  [[noreturn]] void fail(const std::string& block, const std::string& message) const {
    throw Error("report section '" + section_->title + "', block '" + block + "': " + message);
  }

  void block(const TextBlock& text) {
    if (!text.folded_title.empty()) {
      out_ += "<details class=\"block wide\"><summary>" + markup_text(text.folded_title) +
              "</summary>\n";
    } else {
      out_ += "<div class=\"block text wide\">\n";
    }
    if (text.preformatted) {
      out_ += "<pre tabindex=\"0\">" + markup_text(text.text) + "</pre>\n";
    } else {
      for (std::size_t begin = 0; begin < text.text.size();) {
        const std::size_t end = std::min(text.text.find("\n\n", begin), text.text.size());
        out_ += "<p>" + markup_text(text.text.substr(begin, end - begin)) + "</p>\n";
        begin = end + 2;
      }
    }
    out_ += text.folded_title.empty() ? "</div>\n" : "</details>\n";
  }

  void block(const Facts& facts) {
    out_ += "<dl class=\"block facts wide\">\n";
    for (const Fact& f : facts.facts) {
      out_ += "<div class=\"" + std::string(mark_word(f.mark)) + "\"><dt>" + markup_text(f.label) +
              "</dt><dd>" + with_unit(f.value, f.unit) + "</dd></div>\n";
    }
    out_ += "</dl>\n";
  }

  void block(const Table& table) {
    bool marked = false;
    std::vector<bool> numeric(table.columns.size(), !table.rows.empty());
    for (const TableRow& row : table.rows) {
      if (row.cells.size() != table.columns.size()) {
        fail(table.title, "a row has " + std::to_string(row.cells.size()) + " cells for " +
                              std::to_string(table.columns.size()) + " columns");
      }
      marked = marked || row.mark != Mark::none;
      for (std::size_t i = 0; i < row.cells.size(); ++i) {
        const auto* text = std::get_if<std::string>(&row.cells[i]);
        if (text && !text->empty()) numeric[i] = false;
      }
    }
    out_ += "<div class=\"block table wide\" tabindex=\"0\" role=\"region\" aria-label=\"" +
            markup_text(table.title) + "\"><table>";
    if (!table.title.empty()) out_ += "<caption>" + markup_text(table.title) + "</caption>";
    out_ += "\n<thead><tr>";
    const auto kind = [&](std::size_t i) { return numeric[i] ? " class=\"number\"" : ""; };
    if (marked) out_ += "<th scope=\"col\">result</th>";
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      out_ += std::string("<th scope=\"col\"") + kind(i) + ">" + column_title(table.columns[i]) +
              "</th>";
    }
    out_ += "</tr></thead>\n<tbody>\n";
    for (const TableRow& row : table.rows) {
      out_ += "<tr class=\"" + std::string(mark_word(row.mark)) + "\">";
      if (marked) out_ += "<td class=\"mark\">" + std::string(mark_word(row.mark)) + "</td>";
      for (std::size_t i = 0; i < row.cells.size(); ++i) {
        const auto* value = std::get_if<double>(&row.cells[i]);
        out_ += std::string("<td") + kind(i) + ">" +
                (value ? number_text(*value) : markup_text(std::get<std::string>(row.cells[i]))) +
                "</td>";
      }
      out_ += "</tr>\n";
    }
    out_ += "</tbody></table></div>\n";
  }

  void block(const Chart& chart) { figure("chart", chart.title); }
  void block(const PathView& view) { figure("path", view.title); }
  void block(const Scene3D& scene) { figure("scene", scene.title); }

  void figure(const std::string& kind, const std::string& title) {
    out_ += "<figure class=\"block " + kind + (wide_ ? " wide" : "") + "\" data-block=\"" +
            std::to_string(drawn_++) + "\"><figcaption>" + markup_text(title) +
            "</figcaption></figure>\n";
  }

  void block(const Image& image) {
    require_png(image.png, image.caption);
    out_ += "<figure class=\"block image wide" + viewed(image.viewed) + "\"><img alt=\"" +
            markup_text(image.caption) + "\" src=\"data:image/png;base64," + base64(image.png) +
            "\"><figcaption>" + markup_text(image.caption) + "</figcaption></figure>\n";
  }

  void block(const FilmStrip& strip) {
    out_ += "<figure class=\"block strip wide" + viewed(strip.viewed) + "\"><figcaption>" +
            markup_text(strip.title) + "</figcaption>\n<div class=\"frames\">\n";
    for (const FilmFrame& frame : strip.frames) {
      require_png(frame.png, strip.title);
      out_ += "<div><div class=\"picture\"><img alt=\"" + markup_text(frame.caption) +
              "\" width=\"" + std::to_string(frame.width) + "\" height=\"" +
              std::to_string(frame.height) + "\" src=\"data:image/png;base64," + base64(frame.png) +
              "\">";
      frame_boxes(frame, strip.title);
      out_ += "</div>" + markup_text(frame.caption) + "</div>\n";
    }
    out_ += "</div></figure>\n";
  }

  // The first one that may be; its class says so to the style and to report_viewer.js.
  std::string viewed(bool may) {
    if (!may || viewed_ || !report_.viewer) return "";
    viewed_ = true;
    return " viewed";
  }

  void part(const std::string& id, const std::string& text) {
    out_ += "<script type=\"text/plain\" id=\"viewer-" + id + "\">" + text + "</script>\n";
  }

  void viewer(const Viewer& viewer) {
    // Nothing in them ends the element, or hides what follows.
    part("page", base64(viewer.page));
    part("style", replaced(viewer.style, "<", "\\3c "));
    part("script", replaced(replaced(viewer.script, "</script", "<\\/script"), "<!--", "<\\!--"));
    part("told", replaced(viewer.told, "<", "\\u003c"));
    for (const auto& [name, bytes] : viewer.blobs) part(name, base64(bytes));
  }

  void frame_boxes(const FilmFrame& frame, const std::string& title) {
    if (frame.boxes.empty()) return;
    out_ += "<svg viewBox=\"0 0 1 1\" preserveAspectRatio=\"none\">";
    for (const FrameBox& box : frame.boxes) {
      if (!(box.left <= box.right && box.top <= box.bottom) ||
          !std::isfinite(box.right - box.left) || !std::isfinite(box.bottom - box.top)) {
        fail(title, "a box in a frame is empty or not finite");
      }
      // Far beyond the frame nothing more shows, and figures stay short.
      const auto share = [](double v) { return plain(std::clamp(v, -2.0, 3.0)); };
      const auto size = [](double low, double high) {
        return plain(std::clamp(high, -2.0, 3.0) - std::clamp(low, -2.0, 3.0));
      };
      out_ += "<rect x=\"" + share(box.left) + "\" y=\"" + share(box.top) + "\" width=\"" +
              size(box.left, box.right) + "\" height=\"" + size(box.top, box.bottom) +
              "\"><title>" + markup_text(box.label) + "</title></rect>";
    }
    out_ += "</svg>";
  }

  // For attributes: four digits behind the point.
  static std::string plain(double value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, 4).ptr};
  }

  void require_png(const std::string& bytes, const std::string& where) const {
    if (bytes.compare(0, 8, "\x89PNG\r\n\x1a\n") != 0) fail(where, "the image is not a PNG file");
  }

  const Report& report_;
  const Section* section_ = nullptr;
  bool wide_ = false;
  int drawn_ = 0;
  bool viewed_ = false;
  std::string out_;
};

}  // namespace

std::string render_html(const Report& report) {
  return Page(report).html();
}

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) return "\u2013";
  if (value == 0) return "0";
  char text[64];
  const double size = std::abs(value);
  const auto format =
      size >= 1e6 || size < 1e-4 ? std::chars_format::scientific : std::chars_format::fixed;
  int precision = digits - 1;
  if (format == std::chars_format::fixed) {
    precision = std::clamp(digits - 1 - static_cast<int>(std::floor(std::log10(size))), 0, 9);
  }
  std::string out(text, std::to_chars(text, text + sizeof text, value, format, precision).ptr);
  std::size_t exponent = std::min(out.find('e'), out.size());
  if (out.find('.') < exponent) {
    std::size_t end = exponent;
    while (out[end - 1] == '0') --end;
    if (out[end - 1] == '.') --end;
    out.erase(end, exponent - end);
    exponent = std::min(out.find('e'), out.size());
  }
  std::string readable;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool padding = i > exponent && out[i] == '0' && i + 1 < out.size() && i < exponent + 3;
    if (out[i] == '-')
      readable += "\u2212";
    else if (out[i] != '+' && !padding)
      readable += out[i];
  }
  return readable;
}

}  // namespace lapwing
